// How bright how much of the sphere is.
#pragma once

#include <vector>

#include "envmap/map/environment_map.h"

namespace tools {

// Luminance (Rec. 709) by sixteenths of a stop. Shares are of all directions, by solid angle, and of all light.
class Luminances {
 public:
  static constexpr int per_stop = 16, lowest = -64, highest = 64;  // Stops; what lies beyond counts as the last.

  explicit Luminances(const envmap::Level& level);

  // Of the bin from 2^(lowest + k / per_stop): shares of the sphere and of the light.
  struct Bin {
    double sphere = 0, light = 0;
  };
  [[nodiscard]] const std::vector<Bin>& bins() const { return bins_; }

  // No more than this part of the sphere is darker, to a sixteenth of a stop; 0 where it is all black.
  [[nodiscard]] double percentile(double part) const;

 private:
  std::vector<Bin> bins_;
  double black_ = 0;  // Share of the sphere.
};

}  // namespace tools

/// @file
/// The texels round a place of a map, across faces, seams and poles.
#pragma once

#include <span>
#include <unordered_map>
#include <vector>

#include "envmap/operate/measure.h"

namespace envmap {

/// Directions and solid angles of single texels, in the frame of the image.
class TexelGeometry {
 public:
  explicit TexelGeometry(const Level& level) : level_(level) {}

  [[nodiscard]] const Level& level() const { return level_; }
  [[nodiscard]] Direction centre(const Texel& texel) const;
  /// Rows are computed once. Not for several threads.
  [[nodiscard]] double solid_angle(const Texel& texel);

  /// Chords across a texel along u and v, and from its centre to its corners.
  struct Extent {
    double u, v, reach;
    [[nodiscard]] double longest() const { return u > v ? u : v; }
  };
  [[nodiscard]] Extent extent(const Texel& texel) const;

 private:
  const Level& level_;
  std::unordered_map<int, std::vector<double>> rows_;
};

/// Those within a chord of a direction that can be reached from the seeds.
std::vector<Texel> texels_within(const TexelGeometry& geometry, std::span<const Texel> seeds, const Direction& middle,
                                 double chord);

}  // namespace envmap

/// @file
/// A tabulated lobe as its sums want it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "envmap/prefilter/lobe.h"

namespace envmap::prefiltering {

/// A line v + slope (u - at) beside a lobe over an interval of cosines u.
struct LobeLine {
  double value = 0, slope = 0;
  double error = 0;  ///< No value of the lobe in the interval is farther from the line.
};

/// Piecewise linear in the cosine u, 0 below the first sample. Its integral over the sphere is 1.
class TableLobe {
 public:
  /// @param samples of Lobe::table().
  explicit TableLobe(std::span<const LobeSample> samples);

  [[nodiscard]] double value(double cosine) const;
  [[nodiscard]] std::span<const LobeSample> samples() const { return samples_; }

  /// The line through the ends of the lobe over [low, high], moved to the middle of what the lobe leaves of it.
  /// @param at where the line's value is wanted. @param high above low.
  [[nodiscard]] LobeLine line(double low, double high, double at) const;

 private:
  /// The first sample above a cosine.
  [[nodiscard]] std::size_t after(double cosine) const;
  [[nodiscard]] double slope(std::size_t k) const;  ///< Between samples k and k + 1.

  std::vector<LobeSample> samples_;
  std::vector<std::uint32_t> after_;  ///< The first sample above each of even cosines: where a search begins.
};

}  // namespace envmap::prefiltering

/// @file
/// Values that a file cannot hold.
#pragma once

#include <cstdint>
#include <vector>

#include "envmap/io/images/depth.h"
#include "envmap/map/rows.h"

namespace envmap {

/// What a depth can hold. Values between `fine` and `largest` are rounded by half of `precision` of themselves at most;
/// those below `fine` to multiples of `step`, and what is less than half of that becomes 0.
struct Range {
  double largest;
  double fine = 0, step = 0;
  double precision = 0;
  bool has_sign = true;  ///< Integers have none either, but a picture shows negative values as 0.
};

/// @param largest of the format's floats.
Range range_of(Depth depth, double largest);

/// What did not fit: texels beyond the largest value, those below the fine ones, and those below 0 where there is no
/// sign, unless they round to 0. Of their radiance x solid angle, and that of all. The brightest value of any channel
/// that did not fit.
struct ClampStatistics {
  std::int64_t over = 0, dark = 0, nan = 0, negative = 0;
  float brightest = 0;
  double cut = 0, rounded = 0, flux = 0;
};

/// Rows cut at the largest value the file holds, and at 0 where it has no sign. What is cut is noted per row, so that
/// the sums do not depend on the order in which rows are made.
class ClampedRows {
 public:
  /// @param rows must outlive this. @param weigh whether flux is summed though nothing may be lost to darkness.
  ClampedRows(const Rows& rows, const Range& range, bool weigh);
  ClampedRows(const ClampedRows&) = delete;

  [[nodiscard]] const Rows& rows() const { return limited_; }
  [[nodiscard]] ClampStatistics total() const;

 private:
  [[nodiscard]] ClampStatistics cut(int row, std::span<Colour> out) const;

  Range range_;
  bool weigh_;
  Rows limited_;
  std::vector<ClampStatistics> misfits_;
};

}  // namespace envmap

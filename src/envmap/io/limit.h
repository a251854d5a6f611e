/// @file
/// Values that a file cannot hold.
#pragma once

#include <cstdint>
#include <vector>

#include "envmap/map/rows.h"

namespace envmap {

/// What was beyond the limit: texels, and of their radiance x solid angle.
struct Excess {
  std::int64_t count = 0;
  double lost = 0, flux = 0;
};

/// Rows cut at the largest value the file holds. What is cut is noted per row, so that the sums do not depend on the
/// order in which rows are made.
class Limited {
 public:
  /// @param rows must outlive this. @param weigh whether flux is summed, too.
  Limited(const Rows& rows, double limit, bool weigh);
  Limited(const Limited&) = delete;

  [[nodiscard]] const Rows& rows() const { return limited_; }
  [[nodiscard]] Excess total() const;

 private:
  [[nodiscard]] Excess cut(int row, std::span<Colour> out) const;

  double limit_;
  bool weigh_;
  Rows limited_;
  std::vector<Excess> excess_;
};

}  // namespace envmap

/// @file
/// What a caller asks the maker of rows for.
#pragma once

#include <cstddef>

#include "envmap/base/bounds.h"
#include "envmap/base/check_length.h"

namespace envmap {

/// @throws UsageError where a map with so many faces of that size has no such row, or `length` is not its width.
inline void check_row(int faces, int height, int width, int face, int row, std::size_t length) {
  check_range({"face", 0, faces - 1.0}, face);
  check_range({"row", 0, height - 1.0}, row);
  check_length("out", length, std::size_t(width));
}

}  // namespace envmap

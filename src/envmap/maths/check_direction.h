/// @file
/// Directions of callers: the one way in which public functions take them.
#pragma once

#include <string_view>

#include "envmap/maths/vector.h"

namespace envmap {

/// Whether the length is 1 as near as 1e-9 matters to any result.
inline bool is_unit(const Direction& d) {
  const double beyond = glm::dot(d, d) - 1;
  return beyond > -1e-9 && beyond < 1e-9;
}

/// Brings a direction to length 1. One that is_unit() stays as it is, to the last bit.
/// @throws UsageError with the field where the vector has no direction: 0, NaN or infinite.
Direction checked_direction(std::string_view field, const Direction& direction);

}  // namespace envmap

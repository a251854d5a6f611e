/// @file
/// Checks of options that are more than a range.
#pragma once

#include <string_view>

#include "envmap/maths/vector.h"

namespace envmap {

/// @throws UsageError where the matrix is no rotation, to 1e-6 of its elements.
void check_rotation(std::string_view field, const Rotation& rotation);

/// @throws UsageError where a component is not finite.
void check_finite(std::string_view field, const Flux& value);

/// @throws UsageError where a component is not finite, or below 0.
void check_not_negative(std::string_view field, const Flux& value);

}  // namespace envmap

/// @file
/// Spans that a caller gives to be filled.
#pragma once

#include <cstddef>
#include <string_view>

namespace envmap {

/// @throws UsageError "out must hold 4 elements, not 3" where the two differ.
void check_length(std::string_view field, std::size_t length, std::size_t wanted);

}  // namespace envmap

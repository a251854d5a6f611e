/// @file
/// Offsets, lengths and indices in JSON of strangers.
#pragma once

#include <cmath>
#include <cstdint>

#include "envmap/base/error.h"

namespace envmap {

/// From 0 to 2^53, also where it is written as 12.0. What the library makes of -1 or 1e80 is another number, or none.
/// @param json of nlohmann's. @throws InputError without the file's name.
template <class Json>
std::uint64_t whole_number(const Json& json) {
  const double number = json.is_number() ? json.template get<double>() : -1;
  if (!(number >= 0 && number <= 0x1p53 && number == std::floor(number)))
    throw InputError("damaged: its JSON has no whole number where one must be");
  return std::uint64_t(number);
}

}  // namespace envmap

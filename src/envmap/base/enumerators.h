/// @file
/// Values that are no enumerators of their type, as casts from numbers of a config file make them. Public functions
/// refuse them.
#pragma once

#include <cstddef>
#include <string_view>

#include "envmap/base/export.h"

namespace ENVMAP_EXPORT envmap {

/// How many enumerators a type has, numbered from 0. The header of each type says how many.
template <class Enum>
inline constexpr std::size_t enumerators = 0;

/// @throws UsageError "filter must be an enumerator, 0 to 6, not 99".
[[noreturn]] void refuse_enumerator(std::string_view field, long long value, std::size_t count);

/// The number of an enumerator, its place in a table. @throws UsageError with the field where it is none.
template <class Enum>
constexpr std::size_t number_of(std::string_view field, Enum value) {
  static_assert(enumerators<Enum> > 0, "the header of the type says how many enumerators it has");
  const auto number = static_cast<long long>(value);
  if (number < 0 || number >= static_cast<long long>(enumerators<Enum>))
    refuse_enumerator(field, number, enumerators<Enum>);
  return static_cast<std::size_t>(number);
}

/// @throws UsageError with the field where the value is no enumerator.
template <class Enum>
constexpr void check_enumerator(std::string_view field, Enum value) {
  (void)number_of(field, value);
}

}  // namespace envmap

/// @file
/// The progress of a part of an operation.
#pragma once

#include "envmap/base/run.h"

namespace envmap {

/// Reports to the whole, which must outlive this. Empty where that is.
/// @param first where the part begins in the whole, @param size its share of it; 0 to 1, both.
inline Progress part_progress(const Progress& whole, double first, double size) {
  if (!whole) return {};
  return [&whole, first, size](double part) { whole(first + part * size); };
}

}  // namespace envmap

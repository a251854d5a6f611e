/// @file
/// A filter at work: the one dispatch.
#pragma once

#include <functional>
#include <span>

#include "envmap/maths/vector.h"
#include "envmap/sample/filter.h"

namespace envmap {

class PaddedLevel;
struct Target;

/// Fills texels [first, first + out.size()) of a row of a face of the result. Safe to call from many threads at once;
/// always gives the same.
using Sampler = std::function<void(int face, int row, int first, std::span<Colour> out)>;

/// @param levels the source; must outlive the sampler. Those beyond the first are read where reads_levels().
Sampler make_sampler(std::span<const PaddedLevel> levels, const Target& target, const FilterOptions& options);

}  // namespace envmap

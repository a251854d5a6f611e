/// @file
/// Maps of tabulated lobes, each texel with a proved bound.
#pragma once

#include "envmap/prefilter/tabulated/table_lobe.h"
#include "envmap/prefilter/target_texels.h"
#include "envmap/prefilter/treecode/tree.h"

namespace envmap::prefiltering {

/// The least error of a texel: floats of moments round by 2e-7 of it.
inline constexpr double least_table_error = 1e-6;

/// Sets the texels of a map and their bounds. A bound over the error stays where 260,000 nodes do not reach it.
void tabulated_map(const Tree& tree, const TableLobe& lobe, double max_error, const TargetTexels& map);

}  // namespace envmap::prefiltering

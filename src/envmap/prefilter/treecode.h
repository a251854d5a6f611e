/// @file
/// Prefiltering by a treecode: the source as a quad-tree of nodes with moments to the second order, coarse in the tail
/// of the lobe, fine in its core and round bright texels (Barnes and Hut 1986; moments: Greengard and Rokhlin 1987, "A
/// fast algorithm for particle simulations"; the sum opened where it is worst: Walter et al. 2005, "Lightcuts").
///
/// Steps, a file each: build.cpp makes the nodes, traverse.cpp goes down to those that are good enough for a target
/// tile, the texels of an 8 x 8 block of the result that lie near each other, subdivide.h below the stored ones, and
/// evaluate.cpp sums them in the directions of the tile.
///
/// What a texel is off: each node's bound is a theorem (traverse.h). Their plain sum is a bound, too, but it comes out
/// 50 to 100 times too large, since nodes are off either way. So the figure of a tile takes the largest for certain and
/// the rest as errors of either sign: that is measured, by tests/bench/hostile.cpp, over thousands of hostile maps and
/// in every texel.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "envmap/prefilter/evaluate.h"
#include "envmap/prefilter/making.h"
#include "envmap/prefilter/tree.h"

namespace envmap::prefiltering {

/// What nodes together are off, by their bounds: the sum of them or, where that is less, those that a step of the lobe
/// cuts, the largest of the others for certain, all of those as errors of either sign (EitherWay), and a share of those
/// that the horizon crosses as errors of one sign (`together`), for the direction of the tile where that is most. A
/// step that runs along texels is off the same way in all of them.
double error_figure(const Traversal& found, const Tile& tile);

/// Texels that a tree can be made of without much memory: it takes 30 bytes for each.
inline constexpr double most_tree_texels = 1 << 24;

/// About how long a map takes, in nanoseconds of two cores (measured), with what the source takes.
/// @param texels of the map. @param width of the lobe, in radians.
double treecode_cost(const Level& source, double texels, double max_error, double width);

/// Sets texels whose bound is not below max_error yet, each with its figure: a tile's nodes are opened until its own
/// figure is. Texels that would take so many nodes that the exact sum is quicker are left as they are. Rows that are
/// not wanted may be set, too.
void treecode_prefilter(const Tree& tree, const Lobe& lobe, double max_error, const Making& map);

}  // namespace envmap::prefiltering

/// @file
/// Prefiltering by a treecode: the source as a quad-tree of nodes with moments, coarse in the tail of the lobe, fine in
/// its middle and round bright texels (Barnes and Hut 1986, "A hierarchical O(N log N) force-calculation algorithm";
/// Appel 1985; moments: Greengard and Rokhlin 1987, "A fast algorithm for particle simulations").
///
/// Files: treecode_tree makes the tree, treecode_moments its nodes, treecode_lobe takes off what bends at the horizon,
/// treecode_kernels bounds and sums nodes, treecode goes down the tree and certifies what comes out.
///
/// The bound is proved (treecode_kernels.h) for every texel: the sum of the bounds of its nodes and of the sums at the
/// horizon. No errors are taken to cancel. A tile of directions takes the same nodes. All nodes are allowed the same
/// error, which takes the fewest; how much that may be is guessed from the tile before, and a bad guess costs a second
/// try, never the bound.
#pragma once

#include "envmap/prefilter/prefix_sums/prefix_sums.h"
#include "envmap/prefilter/target_texels.h"
#include "envmap/prefilter/treecode/lobe_bounds.h"
#include "envmap/prefilter/treecode/tree.h"

namespace envmap::prefiltering {

/// Texels that a tree can be made of without much memory: it takes 30 bytes for each.
inline constexpr double most_tree_texels = 1 << 24;

/// How far from their middle the directions of a tile may be: the sine of the angle. Wider tiles take more nodes,
/// narrower ones go down the tree more often (measured).
double tile_sine(const Lobe& lobe, double max_error);

/// About how many nodes a direction takes (measured).
double nodes_of_output(const Lobe& lobe, double max_error);

/// Sets the texels of a map, each with the bound of its error. Texels that would take so many nodes that the exact sum
/// is quicker are left with an infinite one. Rows that are not wanted may be set, too.
/// @param hinges of the same source, where the lobe has some; else null.
void treecode_map(const Tree& tree, const Hinges* hinges, const TreecodeLobe& lobe, double max_error,
                  const Making& map);

}  // namespace envmap::prefiltering

/// @file
/// Prefiltering by a treecode: the source as a quadtree of nodes with moments, coarse in the tail of the lobe, fine in
/// its middle and round bright texels (Barnes and Hut 1986, "A hierarchical O(N log N) force-calculation algorithm";
/// Appel 1985; moments: Greengard and Rokhlin 1987, "A fast algorithm for particle simulations").
///
/// Files: tree.h builds the tree, moments.h its nodes, lobe_bounds.h splits the lobe at the horizon, treecode_kernels.h
/// bounds and sums nodes (with the theorem), treecode.cpp goes down the tree and certifies each result.
///
/// The bound of every texel is proved: the sum of the bounds of its nodes and of its prefix sums. No step assumes that
/// errors cancel. A tile of directions shares its nodes, and all nodes are allowed the same error, which takes the
/// fewest nodes. That error is guessed from the tile before. A bad guess costs a second try, never the bound.
#pragma once

#include "envmap/prefilter/prefix_sums/prefix_sums.h"
#include "envmap/prefilter/target_texels.h"
#include "envmap/prefilter/treecode/lobe_bounds.h"
#include "envmap/prefilter/treecode/tree.h"

namespace envmap::prefiltering {

/// The largest source that `auto` builds a tree of: a tree takes 30 bytes for each texel.
inline constexpr double most_tree_texels = 1 << 24;

/// The largest sine of the angle between the middle of a tile and its directions. Wider tiles take more nodes, narrower
/// ones go down the tree more often (measured).
double tile_sine(const LobeFormula& lobe, double max_error);

/// About how many nodes a direction takes (measured).
double nodes_of_output(const LobeFormula& lobe, double max_error);

/// Sets the texels of a map and their bounds. A texel keeps an infinite bound where the exact sum is quicker than its
/// nodes. Rows that are not wanted may be set, too.
/// @param prefix_sums of the same source, where the lobe has horizon terms; else null.
void treecode_map(const Tree& tree, const PrefixSums* prefix_sums, const TreecodeLobe& lobe, double max_error,
                  const TargetTexels& map);

}  // namespace envmap::prefiltering

/// @file
/// Prefiltering by a quad-tree of the source: coarse in the tail of the lobe, fine in its core, exact round bright texels.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "envmap/base/progress.h"
#include "envmap/prefilter/gather.h"
#include "envmap/prefilter/light_tree.h"
#include "envmap/sample/target.h"

namespace envmap {

/// How a light is judged good enough for a direction: by the remainder of Taylor's series of the lobe about its mean
/// cosine, bounded by the lobe's derivatives and the light's moments, over what the direction gets at least.
struct Accuracy {
  double light;  ///< The largest remainder of a light, relative to the result (or to 0.001 x the mean, if larger).
};

/// How far from their middle directions may be that share lights: these are as many as the worst of the directions needs.
/// The figures are those that were fastest.
double tile_radius(const Lobe& lobe);

/// Results in directions, unit vectors near each other, in units of radiance, lobes normalised. @return the remainders of all
/// lights, relative to the result, as if they were independent; nothing where the exact sum is quicker, which is quicker
/// still of many directions at once.
std::optional<double> gather_directions(const LightTree& tree, const Lobe& lobe, const Accuracy& accuracy,
                                        std::span<const Direction> directions, std::span<Flux> out);

/// Fills a whole map. @param out of the projection and size of the target.
/// @return the same of the tile of every texel, by face, row and column; 0 of those that took the exact sum.
std::vector<float> hierarchical_prefilter(const LightTree& tree, const Lobe& lobe, const Target& target,
                                          const Accuracy& accuracy, Level& out, const Progress& progress = {});

}  // namespace envmap

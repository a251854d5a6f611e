/// @file
/// Sheen: sums of light x t+ (1 - t)^p with t = n.d (Estevez and Kulla 2017), a lobe that is largest next to the jump
/// of its slope at the horizon.
///
/// Blocks wholly above the horizon are sums over their Chebyshev points (sheen_blocks.h). Cut blocks are divided, down
/// to texels. A texel above the horizon takes Gauss points, a cut texel is divided into equal cells. Over a cell t is
/// taken as a plane, and the means of the powers of t+ have closed forms at its corners (sheen_cell-inl.h). Where the
/// errors of all cut cells together are too large, their texels are divided further, in double.
///
/// Bound: `SheenPlan::error` is measured, not proved, with lone lights in any texel (tests/numeric/sheen_test.cpp). As
/// radiance is not negative, it then holds for every map, as in multilevel.h.
#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "envmap/prefilter/lobe_formulas.h"
#include "envmap/prefilter/sheen/sheen_blocks.h"
#include "envmap/prefilter/target_texels.h"

namespace envmap::prefiltering {

struct SheenPlan {
  double power, scale;
  double end;  ///< t from which the lobe is negligible.
  int layers;  ///< The first layers, whose blocks are small enough for their points.
  int cells;   ///< Each way, of a texel that the horizon cuts.
  int points;  ///< Each way, of other texels, where one cell is not enough.
  double points_error;
  double cut;    ///< The error that cells at the horizon may have, relative to the sum or the floor.
  double error;  ///< The error of everything else, at most.

  /// The largest texel, an angle. The lobe falls by e^4 over it: larger texels take more time in cells (measured).
  [[nodiscard]] double texel() const { return std::min(pi / 128, 4 / power); }
};

/// The most Gauss points each way.
inline constexpr int most_points = 12;
/// The number of Gauss points that a side of a texel needs. @param steep the power of e by which the lobe falls over
/// it.
int points_for(double steep, double error);

/// The least power of 1 - t: roughness 0.35. Below it the lobe is not smooth enough in its middle for blocks: at
/// roughness 0.42 lone lights of a cube of 32 were off by 24 times an error of 1e-4.
inline constexpr double least_sheen_power = 4;

/// @return nothing for other lobes, for wider sheen, and for errors below 1e-4.
std::optional<SheenPlan> sheen_plan(const LobeFormula& lobe, double error);
/// Completes a plan for a source.
SheenPlan fitted(SheenPlan plan, const SheenBlocks& blocks);

struct SheenSum {
  Flux value{0};     ///< Counted in the unit of the blocks.
  double error = 0;  ///< Error of the cells at the horizon, relative to the sum or the floor.
};

/// The integrals of radiance x lobe over the sphere in some directions.
void sheen_sums(const SheenPlan& plan, const SheenBlocks& blocks, std::span<const Direction> directions,
                std::span<SheenSum> out);

/// Sets the texels of a map and their bounds. @param unit of the blocks: the mean of the source.
void sheen_map(const SheenPlan& plan, const SheenBlocks& blocks, double unit, const TargetTexels& map);

}  // namespace envmap::prefiltering

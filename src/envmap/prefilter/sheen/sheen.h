/// @file
/// Sheen: sums of light x t+ (1 - t)^p, t = n.d, whose bend at the horizon is where it is largest.
///
/// Blocks that the horizon does not cut are sums over their points (sheen_blocks.h). The others are divided, down to
/// texels, and those into equal cells over which t is taken as a plane. A cell that the horizon cuts is off by more:
/// where all of those together may be off by too much, their texels are cut further, in double.
///
/// Measured, not proved (tests/numeric/sheen_test.cpp): `SheenPlan::error`, of lone lights in any texel. As radiance is
/// not negative, it then holds for every map, as in multilevel.h.
#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "envmap/prefilter/lobe.h"
#include "envmap/prefilter/sheen/sheen_blocks.h"
#include "envmap/prefilter/target_texels.h"

namespace envmap::prefiltering {

struct SheenPlan {
  double power, scale;
  double end;  ///< t beyond which the lobe is nothing.
  int layers;  ///< Of blocks whose points are good enough: the first ones.
  int cells;   ///< Of a texel that the horizon cuts, each way.
  int points;  ///< Of other texels, each way, where one cell is not enough.
  double points_error;
  double cut;    ///< What the cells at the horizon may be off by, of a sum or of 0.001 x the mean.
  double error;  ///< What all else is off by, at most.

  /// How large texels may be, an angle. The lobe falls by e^4 over it: larger ones take more time in cells (measured).
  [[nodiscard]] double texel() const { return std::min(pi / 128, 4 / power); }
};

/// Gauss points each way, at most.
inline constexpr int most_points = 12;
/// How many a side of a texel needs. @param steep the power of e by which the lobe falls over it.
int points_for(double steep, double error);

/// The least power of 1 - t: roughness 0.35.
inline constexpr double least_sheen_power = 4;

/// Nothing for other lobes, for wider ones, and for errors below 1e-4.
std::optional<SheenPlan> sheen_plan(const Lobe& lobe, double error);
/// What depends on the source.
SheenPlan fitted(SheenPlan plan, const SheenBlocks& blocks);

struct SheenSum {
  Flux value{0};   ///< In the unit of the blocks.
  double off = 0;  ///< Of a sum, or of 0.001: what the cells at the horizon may be off by.
};

/// The integrals of radiance x lobe over the sphere in some directions.
void sheen_sums(const SheenPlan& plan, const SheenBlocks& blocks, std::span<const Direction> directions,
                std::span<SheenSum> out);

/// Sets the texels of a map, each with the bound of its error. @param unit of the blocks: the mean of the source.
void sheen_map(const SheenPlan& plan, const SheenBlocks& blocks, double unit, const Making& map);

}  // namespace envmap::prefiltering

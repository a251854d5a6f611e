/// @file
/// Prefilter by multilevel summation: a lobe split into parts, each summed over a grid as coarse as the part is smooth.
///
/// The bend at the horizon is taken off as t+, t+^2 and t+^3, which prefix sums add (prefix_sums.h). Radiance is not
/// negative, so the error of every texel of every map is at most the largest relative error of one light at any angle:
/// see docs/explanation/prefilter-multilevel.md.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "envmap/prefilter/lobe.h"
#include "envmap/prefilter/multilevel/multilevel_kernels.h"
#include "envmap/prefilter/multilevel/multilevel_source.h"
#include "envmap/prefilter/prefix_sums/prefix_sums.h"
#include "envmap/prefilter/target_texels.h"

namespace envmap::prefiltering {

/// How a lobe is summed within an error.
struct MultilevelPlan {
  struct Step {
    int rows;  ///< Of the grid.
    LevelKernel kernel;

    [[nodiscard]] double nodes() const { return nodes_of(rows); }
    /// Nodes that the kernel reaches.
    [[nodiscard]] double window() const { return 0.5 * double(kernel.end) * nodes(); }
  };
  std::optional<LevelKernel> core;  ///< What the first grid is too coarse for, summed over texels.
  std::vector<Step> steps;
  HingePolynomial hinges;  ///< What is summed at the horizon.
  double width = 1;        ///< The angle at which the lobe has fallen to about half, in radians.
  double constant = 0;     ///< Integral of what the steps add up to: less than 1 by the integrals of the hinges.
  double error = 0, floor_error = 0;  ///< Of the steps, at most: of a texel, and in addition of 0.001 x the mean.
  double hinge_error = 0;             ///< What the steps leave to the sums of hinges.

  static constexpr double rounding = 0x1p-23;  ///< Of a sum, to float and back.

  [[nodiscard]] int finest() const;  ///< Rows of the finest grid.
  /// Rows of the finest grid that is summed at its own nodes for a result of so many texels (measured). 0: none.
  [[nodiscard]] int field_rows(double texels) const;
  [[nodiscard]] bool has_hinges() const { return hinges.factors[0] > 0; }
};

/// Nothing where the method has no bound, or none below `error`: for errors below 1e-4, Phong lobes of exponent below
/// 4, and sheen.
/// @param max_rows of a grid: what is too narrow for it is the core. A power of two from 256.
/// @param source latlong or cube.
std::optional<MultilevelPlan> multilevel_plan(const Lobe& lobe, double error, int max_rows = 2048,
                                              Projection source = Projection::latlong);

/// What a map is made of.
struct MultilevelSource {
  const Level& texels;  ///< Of 1.5 degrees or less, for the core.
  const SourceGrids& grids;
  const Hinges* hinges;  ///< Where the plan has some.
  double mean;           ///< Of the radiance, the unit of the grids.
  Colour darkest;        ///< That was taken off the grids, and is taken off the texels.
};

struct MultilevelSum {
  Flux value{0};
  double bound = 0;  ///< Relative to the value, or to 0.001 x the mean of the source.
};

/// The steps whose grids have up to so many rows, summed at the nodes of these grids. Each step is as smooth over
/// outputs as over the source, so sums at coarse nodes are interpolated at finer ones. @param rows 0: nothing.
std::optional<NodeGrid> smooth_field(const MultilevelPlan& plan, const MultilevelSource& source, int rows);

/// The integral of radiance x lobe over the sphere in some directions. @param field of smooth_field().
void multilevel_sums(const MultilevelPlan& plan, const MultilevelSource& source, const std::optional<NodeGrid>& field,
                     std::span<const Direction> directions, std::span<MultilevelSum> out);

/// Sets the texels of a map, each with the bound of its error.
void multilevel_map(const MultilevelPlan& plan, const MultilevelSource& source, const Making& map);

}  // namespace envmap::prefiltering

/// @file
/// Prefiltering by multilevel summation: a lobe is split into parts, each summed over a grid as coarse as the part is
/// smooth (Brandt and Lubrecht 1990, "Multilevel matrix multiplication and fast solution of integral equations"; Hardy,
/// Stone and Schulten 2009, "Multilevel summation of electrostatic potentials using graphics processing units").
///
/// S_j is the lobe flattened within a radius r_j. The parts K_j = S_j - S_(j+1) add up to the lobe. Each is flat within
/// r_j and 0 beyond r_(j+1) = 2 r_j, so a grid with steps in proportion to r_j is enough for it. The lobe's first terms
/// at the horizon, in t+, t+^2 and t+^3, go to prefix sums (prefix_sums.h), and what is too narrow for any grid is
/// summed over the texels (near_field).
///
/// Bound: radiance is not negative. So if the error of one light at any angle is at most kappa x the lobe there + beta
/// x its share of the floor, then the error of every texel F of every map is at most kappa F + beta x the floor. kappa
/// and beta are measured, not proved (tests/bench/kappa.cpp). More: docs/explanation/prefilter-multilevel.md.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "envmap/prefilter/lobe_formulas.h"
#include "envmap/prefilter/multilevel/multilevel_kernels.h"
#include "envmap/prefilter/multilevel/multilevel_source.h"
#include "envmap/prefilter/prefix_sums/prefix_sums.h"
#include "envmap/prefilter/target_texels.h"

namespace envmap::prefiltering {

/// How a lobe is summed within an error.
struct MultilevelPlan {
  struct Step {
    int rows;  ///< Rows of the grid.
    LevelKernel kernel;

    [[nodiscard]] double nodes() const { return nodes_of(rows); }
    /// Number of nodes within the kernel.
    [[nodiscard]] double window() const { return 0.5 * double(kernel.end) * nodes(); }
  };
  std::optional<LevelKernel> near_field;  ///< The part that the first grid is too coarse for.
  std::vector<Step> steps;
  ClampedCosinePolynomial horizon_terms;  ///< Left to prefix sums.
  double width = 1;                       ///< The angle at which the lobe has fallen to about half, in radians.
  double constant = 0;                    ///< Integral of the lobe less that of its horizon terms.
  double error = 0, floor_error = 0;      ///< kappa and beta of the steps.
  double horizon_error = 0;               ///< The error that is left to prefix sums.

  static constexpr double rounding = 0x1p-23;  ///< Rounding of a sum to float and back.

  [[nodiscard]] int finest() const;  ///< Rows of the finest grid.
  /// Rows of the finest grid that is summed at its own nodes for a result of so many texels (measured). 0: none.
  [[nodiscard]] int field_rows(double texels) const;
  [[nodiscard]] bool has_horizon_terms() const { return horizon_terms.factors[0] > 0; }
};

/// @return nothing where the method has no bound within `error`: for errors below 1e-4, Phong lobes of exponent below
/// 3.6, and sheen.
/// @param max_rows of a grid, a power of two from 256. What is too narrow for it is the near field.
/// @param source latlong or cube.
std::optional<MultilevelPlan> multilevel_plan(const LobeFormula& lobe, double error, int max_rows = 2048,
                                              Projection source = Projection::latlong);

/// A source prepared for multilevel sums.
struct MultilevelSource {
  const Level& texels;  ///< Texels of 1.5 degrees or less, for the near field.
  const SourceGrids& grids;
  const PrefixSums* prefix_sums;  ///< Null where the plan has no horizon terms.
  double mean;                    ///< Mean radiance: the unit of the grids.
  Colour min_radiance;            ///< Grids are without it, and it is subtracted from texels.
};

struct MultilevelSum {
  Flux value{0};
  double bound = 0;  ///< Relative to the value, or to 0.001 x the mean of the source.
};

/// The steps whose grids have at most `rows` rows, summed at the nodes of these grids. Each step is as smooth over
/// outputs as over the source, so sums at coarse nodes are interpolated at finer ones. @return nothing for 0 rows.
std::optional<NodeGrid> smooth_field(const MultilevelPlan& plan, const MultilevelSource& source, int rows);

/// The integral of radiance x lobe over the sphere in some directions. @param field of smooth_field().
void multilevel_sums(const MultilevelPlan& plan, const MultilevelSource& source, const std::optional<NodeGrid>& field,
                     std::span<const Direction> directions, std::span<MultilevelSum> out);

/// Sets the texels of a map and their bounds.
void multilevel_map(const MultilevelPlan& plan, const MultilevelSource& source, const TargetTexels& map);

}  // namespace envmap::prefiltering

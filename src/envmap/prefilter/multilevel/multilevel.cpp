// The plan of each lobe, the sums of its steps, and the bound of each texel. See multilevel.h for the splitting.
#include "envmap/prefilter/multilevel/multilevel.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "envmap/base/parallel.h"
#include "envmap/maths/portable.h"
#include "envmap/prefilter/error_floor.h"

namespace envmap::prefiltering {
namespace {

// How finely a lobe is split for a range of errors. tests/bench/kappa.cpp measures kappa and beta.
struct ErrorTier {
  double radius;       // r_j of grid j, in steps of the grid.
  double steps;        // Least number of steps of the first grid in the width of the lobe.
  double flatten;      // c
  bool quartic;        // q = 4, else 3.
  double kappa, beta;  // The error of one light at any angle is at most kappa x the lobe there + beta x the floor.
  double per_sigma;    // Steps in the width of a Phong lobe of exponent 2000.
  double max_variation_ggx, max_variation_power;  // LevelKernel::max_variation.
};
constexpr ErrorTier at_1e3{.radius = 7.5,
                           .steps = 5,
                           .flatten = 0.2,
                           .quartic = false,
                           .kappa = 4.2e-4,
                           .beta = 3.5e-4,
                           .per_sigma = 3.6,
                           .max_variation_ggx = 0.85,
                           .max_variation_power = 4.2};
constexpr ErrorTier at_4e4{.radius = 8.5,
                           .steps = 5.7,
                           .flatten = 0.2,
                           .quartic = false,
                           .kappa = 1.9e-4,
                           .beta = 1.4e-4,
                           .per_sigma = 4.0,
                           .max_variation_ggx = 0.43,
                           .max_variation_power = 3.8};
constexpr ErrorTier at_1e4{.radius = 11,
                           .steps = 7,
                           .flatten = 0.15,
                           .quartic = true,
                           .kappa = 3.5e-5,
                           .beta = 3.5e-5,
                           .per_sigma = 4.8,
                           .max_variation_ggx = 0.23,
                           .max_variation_power = 3};

// The light of a cube is interpolated twice, on its faces and on the grid, so that powers need finer grids.
constexpr double finer_for_cubes = 1.06;

int rows_for(double step) {
  return std::max(least_rows, int(std::bit_ceil(unsigned(std::min(1e6, std::ceil(pi / step))))));
}

// Rows of the single grid of a power: 8 to 15 times a power of two, as the cost grows with their fourth power.
int rows_of_power(double step) {
  const int wanted = int(std::min(1e6, std::ceil(pi / step)));
  int unit = least_rows / 8;
  while (15 * unit < wanted) unit *= 2;
  return std::max(least_rows, (wanted + unit - 1) / unit * unit);
}

// Flattening within a radius r_j: x_j = r_j^2 / 2.
LevelKernel::Flattening flattened(const ErrorTier& s, double radius) {
  const double x = 0.5 * radius * radius;
  return {true, float(1 / x), float(portable::pow(s.flatten * x, s.quartic ? 0.25 : 1.0 / 3))};
}

// Leaves the first terms of the lobe's series at the horizon to prefix sums.
void set_horizon_terms(MultilevelPlan& plan, LevelKernel& last, const std::array<double, 3>& factors) {
  plan.horizon_terms = {factors}, plan.constant = 1 - plan.horizon_terms.integral();
  for (std::size_t k = 0; k < 3; ++k) last.horizon_terms[k] = float(factors[k] / last.scale);
}

// The step of a grid whose error at the horizon is within beta x the floor. A term of t^n starts there, n > 3, and the
// error of its interpolation is at most 0.04 x its factor x step^n.
double step_at_horizon(const ErrorTier& s, double factor, double n = 4) {
  constexpr double of_interpolation = 0.04;
  return portable::pow(s.beta * floor_density / (of_interpolation * std::max(1e-12, factor)), 1 / n);
}

// GGX is k t / (a + x)^2, with W = a + 1 and t = 1 - x. Its series at the horizon is
//   k (t / W^2 + 2 t^2 / W^3 + 3 t^3 / W^4 + 4 t^4 / W^5 + ...).
// The grids take S_j - S_(j+1), each twice as wide as the one before.
std::optional<MultilevelPlan> plan_of(const Ggx& lobe, const ErrorTier& s, int max_rows) {
  if (lobe.b <= 0) return std::nullopt;
  MultilevelPlan plan;
  const double a = lobe.a / lobe.b, whole = a + 1, scale = lobe.scale / (lobe.b * lobe.b),
               width = plan.width = std::min(1.0, std::sqrt(2 * a));
  const double first = scale / (whole * whole), second = 2 * first / whole, third = 1.5 * second / whole;
  int rows = rows_for(width / s.steps);
  LevelKernel k{.quartic = s.quartic, .max_variation = float(s.max_variation_ggx), .a = float(a), .scale = scale};
  if (rows > max_rows) {
    rows = max_rows;
    const double outer = s.radius * pi / rows;
    k.outer = flattened(s, outer), k.end = float(0.5 * outer * outer);
    plan.near_field = k;
    k.inner = k.outer;
  }
  for (;; rows /= 2) {
    const double outer = 2 * s.radius * pi / rows;
    if (outer > 0.7 || rows <= least_rows) break;
    k.outer = flattened(s, outer), k.end = float(0.5 * outer * outer);
    plan.steps.push_back({rows, k});
    k.inner = k.outer;
  }
  k.outer = {}, k.end = 1;
  set_horizon_terms(plan, k, {first, second, third});
  const double step = step_at_horizon(s, 4.0 / 3 * third / whole);
  plan.steps.push_back({std::max(rows, plan.steps.empty() ? rows_of_power(step) : rows_for(step)), k});
  return plan;
}

// A power is smooth at the horizon and takes a single grid: (1 - part x)^power, times t for Blinn's lobe.
std::optional<MultilevelPlan> plan_of_power(LevelKernel k, double width, int least, double error, const ErrorTier& s,
                                            int max_rows, MultilevelPlan plan) {
  k.max_variation = float(s.max_variation_power), plan.width = width;
  // The farther out a tail falls to the floor, the finer a grid it needs.
  const double tail = portable::log(k.scale / floor_density);
  const int rows = std::max(least, rows_of_power(width / (s.per_sigma * std::max(0.975, tail / 16.3))));
  // The tail is cut where its rest is small beside the floor.
  const double left = portable::log(k.scale / (0.02 * error * floor_density));
  k.end = float(std::min(1.0, -portable::expm1(-left / double(k.power)) / double(k.part)));
  if (rows > max_rows)
    plan.near_field = k;
  else
    plan.steps.push_back({rows, k});
  return plan;
}

std::optional<MultilevelPlan> plan_of(const Phong& lobe, double error, const ErrorTier& s, int max_rows) {
  if (lobe.exponent < 3.6) return std::nullopt;
  MultilevelPlan plan;
  plan.constant = 1;
  const LevelKernel k{.kind = LevelKernel::Kind::power, .power = float(lobe.exponent), .scale = lobe.scale()};
  // From exponent 6 on the lobe leaves the horizon more and more smoothly.
  const Phong steepest{std::min(6.0, lobe.exponent)};
  const int at_horizon = rows_of_power(step_at_horizon(s, steepest.scale(), std::min(4.5, lobe.exponent)));
  return plan_of_power(k, 1 / std::sqrt(lobe.exponent), at_horizon, error, s, max_rows, plan);
}

std::optional<MultilevelPlan> plan_of(const BlinnPhong& lobe, double error, const ErrorTier& s, int max_rows) {
  const double p = lobe.power;
  if (p < 1) return std::nullopt;
  MultilevelPlan plan;
  plan.constant = 1;
  LevelKernel k{.kind = LevelKernel::Kind::power, .power = float(p), .part = 0.5F, .cosine = true, .scale = lobe.scale};
  const auto terms = blinn_horizon_terms(lobe).factors;
  // Terms that are negligible even if all light lies at the horizon are dropped.
  if (most_flux * (terms[0] + terms[1] + terms[2]) > 0.002 * error * floor_of_mean) set_horizon_terms(plan, k, terms);
  const int at_horizon = rows_of_power(step_at_horizon(s, std::abs(p - 2) / 3 * terms[2]));
  return plan_of_power(k, 1 / std::sqrt(0.5 * p + 1), at_horizon, error, s, max_rows, plan);
}

}  // namespace

int MultilevelPlan::finest() const {
  return steps.empty() ? least_rows : std::ranges::max_element(steps, {}, &Step::rows)->rows;
}

std::optional<MultilevelPlan> multilevel_plan(const LobeFormula& lobe, double error, int max_rows, Projection source) {
  if (error < 1e-4) return std::nullopt;
  ErrorTier s = error < 4e-4 ? at_1e4 : error < 1e-3 ? at_4e4 : at_1e3;
  if (source == Projection::cube) s.per_sigma *= finer_for_cubes;
  std::optional<MultilevelPlan> plan;
  if (const auto* ggx = std::get_if<Ggx>(&lobe)) plan = plan_of(*ggx, s, max_rows);
  if (const auto* phong = std::get_if<Phong>(&lobe)) plan = plan_of(*phong, error, s, max_rows);
  if (const auto* blinn = std::get_if<BlinnPhong>(&lobe)) plan = plan_of(*blinn, error, s, max_rows);
  if (plan)
    plan->error = s.kappa, plan->floor_error = s.beta,
    plan->horizon_error = (error - s.kappa - 2 * MultilevelPlan::rounding) / (1 + 2 * error) - s.beta;
  return plan;
}

namespace {

// Time in nanoseconds of two cores: of a step at all of its nodes, and at one output.
double at_nodes(const MultilevelPlan::Step& s) { return s.nodes() * (130 + 0.07 * s.window()); }
double at_outputs(const MultilevelPlan::Step& s) {
  return (s.kernel.kind == LevelKernel::Kind::ggx ? 0.5 : 0.9) * s.window();
}

}  // namespace

int MultilevelPlan::field_rows(double texels) const {
  int rows = 0;
  // All nodes of a row share the kernel's values: a node takes less time than an output, most of all in wide windows.
  for (const Step& s : steps)
    if (at_nodes(s) < texels * at_outputs(s)) rows = std::max(rows, s.rows);
  return rows;
}

std::optional<NodeGrid> smooth_field(const MultilevelPlan& plan, const MultilevelSource& source, int rows) {
  std::optional<NodeGrid> field;
  std::vector<int> sizes;
  for (const MultilevelPlan::Step& s : plan.steps)
    if (s.rows <= rows) sizes.push_back(s.rows);
  std::ranges::sort(sizes);
  sizes.erase(std::ranges::unique(sizes).begin(), sizes.end());
  for (const int r : sizes) {
    NodeGrid finer(r);
    parallel_for(r, [&](int row) {
      GatherBuffers buffers;
      std::vector<Flux> sums(std::size_t(finer.columns[std::size_t(row)]), Flux(0));
      for (const MultilevelPlan::Step& s : plan.steps)
        if (s.rows == r) gather_at_row(source.grids.grid(r), s.kernel, row, buffers, sums);
      for (std::size_t k = 0; k < sums.size(); ++k) {
        if (field) sums[k] += interpolate(*field, finer.node(row, int(k)));
        for (int c = 0; c < 3; ++c) finer.channel(row, c)[k] = float(sums[k][c]);
      }
      finer.repeat_columns(row);
    });
    field = std::move(finer);
  }
  return field;
}

void multilevel_sums(const MultilevelPlan& plan, const MultilevelSource& source, const std::optional<NodeGrid>& field,
                     std::span<const Direction> directions, std::span<MultilevelSum> out) {
  const Flux from_min_radiance = plan.constant * Flux(source.min_radiance);
  const double floor = floor_of_mean * source.mean;
  std::vector<Flux> smooth(directions.size());
  GatherBuffers buffers;
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const GridView view(directions[k]);
    Flux sum(0);
    if (plan.near_field)
      sum = near_field_sum(source.texels, source.min_radiance, source.mean, *plan.near_field, directions[k]);
    if (field) sum += interpolate(*field, view);
    for (const MultilevelPlan::Step& s : plan.steps)
      if (!field || s.rows > field->rows) sum += gather(source.grids.grid(s.rows), s.kernel, view, buffers);
    smooth[k] = source.mean * sum + from_min_radiance;
    source.texels.trim();
  }
  std::vector<PrefixSum> at_horizon(directions.size());
  if (plan.has_horizon_terms())
    source.prefix_sums->sums(plan.horizon_terms, directions, plan.horizon_error, smooth, at_horizon);
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const PrefixSum& h = at_horizon[k];
    const Flux value = smooth[k] + h.value;
    out[k] = {glm::max(Flux(0), value), 0};
    for (int c = 0; c < 3; ++c) {
      const double error = h.bound[c] + plan.floor_error * floor;
      out[k].bound = std::max(out[k].bound, error / std::max((1 - plan.error) * value[c] - error, floor));
    }
    out[k].bound += plan.error + MultilevelPlan::rounding;
    if (!std::isfinite(value.x + value.y + value.z)) out[k].bound = std::numeric_limits<double>::infinity();
  }
}

void multilevel_map(const MultilevelPlan& plan, const MultilevelSource& source, const TargetTexels& map) {
  const std::optional<NodeGrid> field =
      smooth_field(plan, source, plan.field_rows(texel_count(map.target.to, map.target.size)));
  map.each_row([&](std::span<const Direction> directions, std::span<Colour> texels, std::span<float> bounds) {
    std::vector<MultilevelSum> sums(directions.size());
    multilevel_sums(plan, source, field, directions, sums);
    for (std::size_t k = 0; k < sums.size(); ++k) {
      texels[k] = Colour(sums[k].value);
      bounds[k] = std::nextafter(float(sums[k].bound), 1.F);
    }
  });
}

}  // namespace envmap::prefiltering

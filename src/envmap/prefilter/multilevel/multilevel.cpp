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

// What the splitting of a lobe depends on. Errors of one light: tests/bench/kappa.cpp.
struct Splitting {
  double radius;   // x_j = r_j^2 / 2, r_j = radius x the step of grid j.
  double steps;    // Of the first grid, over the width of the lobe, at least.
  double flatten;  // c
  bool quartic;    // q = 4, else 3.
  double kappa;  // Error of one light at any angle: kappa x the lobe there + bend x what 0.001 x the mean makes of it.
  double bend;
  double per_sigma;                 // Steps in the width of a Phong lobe of exponent 2000.
  double uneven_ggx, uneven_power;  // Of LevelKernel.
};
constexpr Splitting at_1e3{7.5, 5, 0.2, false, 4.2e-4, 3.5e-4, 3.6, 0.85, 4.2};
constexpr Splitting at_4e4{8.5, 5.7, 0.2, false, 1.9e-4, 1.4e-4, 4.0, 0.43, 3.8};
constexpr Splitting at_1e4{11, 7, 0.15, true, 3.5e-5, 3.5e-5, 4.8, 0.23, 3};

// The light of a cube is laid on two grids in turn.
constexpr double finer_for_cubes = 1.06;

int rows_for(double step) {
  return std::max(least_rows, int(std::bit_ceil(unsigned(std::min(1e6, std::ceil(pi / step))))));
}

// A power takes one grid, whose cost grows with the fourth power of its rows: 4, 5, 6 or 7 times a power of two.
int rows_of_power(double step) {
  const int wanted = int(std::min(1e6, std::ceil(pi / step)));
  int unit = least_rows / 4;
  while (7 * unit < wanted) unit *= 2;
  return std::max(least_rows, (wanted + unit - 1) / unit * unit);
}

LevelKernel::Softened softened(const Splitting& s, double radius) {
  const double x = 0.5 * radius * radius;
  return {true, float(1 / x), float(portable::pow(s.flatten * x, s.quartic ? 0.25 : 1.0 / 3))};
}

void set_hinges(MultilevelPlan& plan, LevelKernel& last, const std::array<double, 3>& factors) {
  plan.hinges = {factors}, plan.constant = 1 - plan.hinges.integral();
  for (std::size_t k = 0; k < 3; ++k) last.hinges[k] = float(factors[k] / last.scale);
}

// Rows of a grid whose error at the horizon is small enough: bend x h^4 x the factor of t^4, which starts there.
int rows_at_horizon(const Splitting& s, double fourth) {
  constexpr double bend = 0.04;
  return rows_for(std::sqrt(std::sqrt(s.bend * floor_density / (bend * std::max(1e-12, fourth)))));
}

std::optional<MultilevelPlan> plan_of(const Ggx& lobe, const Splitting& s, int max_rows) {
  if (lobe.b <= 0) return std::nullopt;
  MultilevelPlan plan;
  const double a = lobe.a / lobe.b, whole = a + 1, scale = lobe.scale / (lobe.b * lobe.b),
               width = plan.width = std::min(1.0, std::sqrt(2 * a));
  const double first = scale / (whole * whole), second = 2 * first / whole, third = 1.5 * second / whole;
  int rows = rows_for(width / s.steps);
  LevelKernel k{.quartic = s.quartic, .uneven = float(s.uneven_ggx), .a = float(a), .scale = scale};
  if (rows > max_rows) {
    rows = max_rows;
    const double outer = s.radius * pi / rows;
    k.outer = softened(s, outer), k.end = float(0.5 * outer * outer);
    plan.core = k;
    k.inner = k.outer;
  }
  for (;; rows /= 2) {
    const double outer = 2 * s.radius * pi / rows;
    if (outer > 0.7 || rows <= least_rows) break;
    k.outer = softened(s, outer), k.end = float(0.5 * outer * outer);
    plan.steps.push_back({rows, k});
    k.inner = k.outer;
  }
  k.outer = {}, k.end = 1;
  set_hinges(plan, k, {first, second, third});
  plan.steps.push_back({std::max(rows, rows_at_horizon(s, 4.0 / 3 * third / whole)), k});
  return plan;
}

// A single level: (1 - part x)^power, times t of Blinn's lobe.
std::optional<MultilevelPlan> plan_of_power(LevelKernel k, double width, int least, double error, const Splitting& s,
                                            int max_rows, MultilevelPlan plan) {
  k.uneven = float(s.uneven_power), plan.width = width;
  // Tails need finer grids the farther out they come down to 0.001 x the mean.
  const double tail = portable::log(k.scale / floor_density);
  const int rows = std::max(least, rows_of_power(width / (s.per_sigma * std::max(0.92, tail / 16.3))));
  // Cut where what is left is small beside 0.001 x the mean.
  const double left = portable::log(k.scale / (0.02 * error * floor_density));
  k.end = float(std::min(1.0, -portable::expm1(-left / double(k.power)) / double(k.part)));
  if (rows > max_rows)
    plan.core = k;
  else
    plan.steps.push_back({rows, k});
  return plan;
}

std::optional<MultilevelPlan> plan_of(const Phong& lobe, double error, const Splitting& s, int max_rows) {
  if (lobe.exponent < 4) return std::nullopt;
  MultilevelPlan plan;
  plan.constant = 1;
  const LevelKernel k{.kind = LevelKernel::Kind::power, .power = float(lobe.exponent), .scale = lobe.scale()};
  const int at_horizon = lobe.exponent >= 6 ? 128 : 256;
  return plan_of_power(k, 1 / std::sqrt(lobe.exponent), s.quartic ? 2 * at_horizon : at_horizon, error, s, max_rows,
                       plan);
}

// t (1 - x/2)^p = t ((1 + t)/2)^p: the binomial series at the horizon, whose first three factors are not negative for
// p >= 1.
std::optional<MultilevelPlan> plan_of(const BlinnPhong& lobe, double error, const Splitting& s, int max_rows) {
  const double p = lobe.power;
  if (p < 1) return std::nullopt;
  MultilevelPlan plan;
  plan.constant = 1;
  LevelKernel k{.kind = LevelKernel::Kind::power, .power = float(p), .part = 0.5F, .cosine = true, .scale = lobe.scale};
  const double first = lobe.kink(), second = p * first, third = (p - 1) / 2 * second;
  // All light of a channel at the horizon is nothing then.
  if (most_flux * (first + second + third) > 0.002 * error * floor_of_mean) set_hinges(plan, k, {first, second, third});
  const int at_horizon = rows_at_horizon(s, std::abs(p - 2) / 3 * third);
  return plan_of_power(k, 1 / std::sqrt(0.5 * p + 1), at_horizon, error, s, max_rows, plan);
}

}  // namespace

int MultilevelPlan::finest() const {
  return steps.empty() ? least_rows : std::ranges::max_element(steps, {}, &Step::rows)->rows;
}

std::optional<MultilevelPlan> multilevel_plan(const Lobe& lobe, double error, int max_rows, Projection source) {
  if (error < 1e-4) return std::nullopt;
  Splitting s = error < 4e-4 ? at_1e4 : error < 1e-3 ? at_4e4 : at_1e3;
  if (source == Projection::cube) s.per_sigma *= finer_for_cubes;
  std::optional<MultilevelPlan> plan;
  if (const auto* ggx = std::get_if<Ggx>(&lobe)) plan = plan_of(*ggx, s, max_rows);
  if (const auto* phong = std::get_if<Phong>(&lobe)) plan = plan_of(*phong, error, s, max_rows);
  if (const auto* blinn = std::get_if<BlinnPhong>(&lobe)) plan = plan_of(*blinn, error, s, max_rows);
  if (plan)
    plan->error = s.kappa, plan->floor_error = s.bend,
    plan->hinge_error = (error - s.kappa - 2 * MultilevelPlan::rounding) / (1 + 2 * error) - s.bend;
  return plan;
}

namespace {

// Nanoseconds of two cores: a step at all of its nodes, and at one output.
double at_nodes(const MultilevelPlan::Step& s) { return s.nodes() * (130 + 0.07 * s.window()); }
double at_outputs(const MultilevelPlan::Step& s) {
  return (s.kernel.kind == LevelKernel::Kind::ggx ? 0.5 : 0.9) * s.window();
}

}  // namespace

int MultilevelPlan::field_rows(double texels) const {
  int rows = 0;
  // Nodes see kernels that are at hand, so each takes less than an output does, and less by more in a wide window.
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
      GatherRoom room;
      std::vector<Flux> sums(std::size_t(finer.columns[std::size_t(row)]), Flux(0));
      for (const MultilevelPlan::Step& s : plan.steps)
        if (s.rows == r) gather_at_row(source.grids.grid(r), s.kernel, row, room, sums);
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
  const Flux even = plan.constant * Flux(source.darkest);
  const double floor = floor_of_mean * source.mean;
  std::vector<Flux> smooth(directions.size());
  GatherRoom room;
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const GridView view(directions[k]);
    Flux sum(0);
    if (plan.core) sum = core_sum(source.texels, source.darkest, source.mean, *plan.core, directions[k]);
    if (field) sum += interpolate(*field, view);
    for (const MultilevelPlan::Step& s : plan.steps)
      if (!field || s.rows > field->rows) sum += gather(source.grids.grid(s.rows), s.kernel, view, room);
    smooth[k] = source.mean * sum + even;
    source.texels.trim();
  }
  std::vector<HingeSum> hinges(directions.size());
  if (plan.has_hinges()) source.hinges->sums(plan.hinges, directions, plan.hinge_error, smooth, hinges);
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const HingeSum& h = hinges[k];
    const Flux value = smooth[k] + h.value;
    out[k] = {glm::max(Flux(0), value), 0};
    for (int c = 0; c < 3; ++c) {
      const double apart = h.bound[c] + plan.floor_error * floor;
      out[k].bound = std::max(out[k].bound, apart / std::max((1 - plan.error) * value[c] - apart, floor));
    }
    out[k].bound += plan.error + MultilevelPlan::rounding;
    if (!std::isfinite(value.x + value.y + value.z)) out[k].bound = std::numeric_limits<double>::infinity();
  }
}

void multilevel_map(const MultilevelPlan& plan, const MultilevelSource& source, const Making& map) {
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

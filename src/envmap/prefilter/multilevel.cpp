#include "envmap/prefilter/multilevel.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "envmap/base/parallel.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/measure.h"
#include "envmap/prefilter/lobe_core.h"

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
  double per_sigma;                 // Steps in the width of a Phong lobe.
  double uneven_ggx, uneven_power;  // Of LevelKernel.
};
constexpr Splitting coarse{7.5, 5, 0.2, false, 4.2e-4, 3.5e-4, 4.2, 0.36, 4.2};
constexpr Splitting fine{11, 7, 0.15, true, 3.5e-5, 3.5e-5, 5.2, 0.16, 3};

constexpr double rounding = 0x1p-23;  // Of a sum, to float and back.

// 0.001 x the mean of three channels, over the flux of a light in one.
constexpr double floor_density = 1e-3 / (12 * pi);

int rows_for(double step) {
  return std::max(least_rows, int(std::bit_ceil(unsigned(std::min(1e6, std::ceil(pi / step))))));
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
               width = std::min(1.0, std::sqrt(2 * a));
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
  k.uneven = float(s.uneven_power);
  const int rows = std::max(least, rows_for(width / s.per_sigma));
  max_rows = std::min(2 * max_rows, 2048);  // A power is cut off many widths away, and so sees more texels.
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
  // All light of a channel at the horizon, 12 pi x the mean, is nothing then.
  if (12 * pi * (first + second + third) > 0.002 * error * 1e-3) set_hinges(plan, k, {first, second, third});
  const int at_horizon = rows_at_horizon(s, std::abs(p - 2) / 3 * third);
  return plan_of_power(k, 1 / std::sqrt(0.5 * p + 1), at_horizon, error, s, max_rows, plan);
}

}  // namespace

int MultilevelPlan::finest() const {
  return steps.empty() ? least_rows : std::ranges::max_element(steps, {}, &Step::rows)->rows;
}

std::optional<MultilevelPlan> multilevel_plan(const Lobe& lobe, double error, int max_rows) {
  if (error < 1e-4) return std::nullopt;
  const Splitting& s = error < 1e-3 ? fine : coarse;
  std::optional<MultilevelPlan> plan;
  if (const auto* ggx = std::get_if<Ggx>(&lobe)) plan = plan_of(*ggx, s, max_rows);
  if (const auto* phong = std::get_if<Phong>(&lobe)) plan = plan_of(*phong, error, s, max_rows);
  if (const auto* blinn = std::get_if<BlinnPhong>(&lobe)) plan = plan_of(*blinn, error, s, max_rows);
  if (plan)
    plan->error = s.kappa, plan->floor_error = s.bend,
    plan->hinge_error = (error - s.kappa - s.bend - 2 * rounding) / (1 + 2 * error);
  return plan;
}

bool MultilevelPlan::is_quick(const Level& from, std::size_t texels, double max_error) const {
  if (steps.empty() || (core && from.projection() == Projection::latlong)) return true;
  // A broad lobe sees most of its grids, where a tree takes a few large nodes.
  double nodes = 0;
  for (const Step& step : steps) nodes += 2 / pi * double(step.rows) * step.rows * double(step.kernel.end);
  const double rows = steps.front().rows, outputs = double(texels), root = portable::cbrt(1e3 * max_error),
               opened = (steps.size() > 1 ? 43 : 21) * rows / (root * root);
  // The light of a cube is laid on grids point by point. That pays for narrow lobes of many texels, and sooner without
  // sums at the horizon.
  if (from.projection() == Projection::cube) {
    if (core || rows >= 1024) return 250 * outputs >= rows * rows;
    return !has_hinges() && rows >= 256 && 35 * outputs >= rows * rows && 2 * nodes < opened;
  }
  const double size = double(index_of(from, {from.faces(), 0, 0}));
  constexpr double most = 1 << 24;  // Texels that a tree of nodes is made of: it takes 30 bytes for each.
  // In nanoseconds of two cores: what one output takes, and the source.
  const bool ggx = steps.front().kernel.kind == LevelKernel::Kind::ggx;
  const double by_grids = (ggx ? 0.5 : 1.1) * nodes + (has_hinges() ? 1500 : 500), by_tree = opened;
  const double grids = 12 * size + 240 * rows * rows + (has_hinges() ? 12 * size : 0), tree = 4e7 + 50 * size;
  return size > most || grids + outputs * by_grids < tree + outputs * by_tree;
}

void multilevel_sums(const MultilevelPlan& plan, const MultilevelSource& source, std::span<const Direction> directions,
                     std::span<MultilevelSum> out) {
  const Flux even = plan.constant * Flux(source.darkest);
  const double floor = 1e-3 * source.mean;
  std::vector<Flux> smooth(directions.size());
  GatherRoom room;
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const GridView view(directions[k]);
    Flux sum(0);
    if (plan.core) sum = core_sum(source.texels, source.darkest, source.mean, *plan.core, directions[k]);
    for (const MultilevelPlan::Step& s : plan.steps) sum += gather(source.grids.grid(s.rows), s.kernel, view, room);
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
    out[k].bound += plan.error + rounding;
    if (!std::isfinite(value.x + value.y + value.z)) out[k].bound = std::numeric_limits<double>::infinity();
  }
}

void multilevel_map(const MultilevelPlan& plan, const MultilevelSource& source, const Making& map) {
  map.each_row([&](std::span<const Direction> directions, std::span<Colour> texels, std::span<float> bounds) {
    std::vector<MultilevelSum> sums(directions.size());
    multilevel_sums(plan, source, directions, sums);
    for (std::size_t k = 0; k < sums.size(); ++k) {
      texels[k] = Colour(sums[k].value);
      bounds[k] = std::nextafter(float(sums[k].bound), 1.F);
    }
  });
}

}  // namespace envmap::prefiltering

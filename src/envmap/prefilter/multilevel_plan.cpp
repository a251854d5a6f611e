#include <algorithm>
#include <bit>
#include <cmath>

#include "envmap/maths/portable.h"
#include "envmap/prefilter/error_floor.h"
#include "envmap/prefilter/multilevel.h"

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

}  // namespace envmap::prefiltering

// The costs of all methods. Each is a formula of counted steps whose factors were measured on two cores (tests/bench).
#include "envmap/prefilter/choose_method.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "envmap/maths/portable.h"
#include "envmap/prefilter/near_field/point_rules.h"
#include "envmap/prefilter/treecode/treecode.h"

namespace envmap::prefiltering {
namespace {

// The source and the size of a map to make.
struct Job {
  const Level& source;
  double texels;  // Number of texels of the whole result.
  double error;

  [[nodiscard]] bool cube() const { return source.projection() == Projection::cube; }
  [[nodiscard]] double size() const { return double(index_of(source, {source.faces(), 0, 0})); }
  [[nodiscard]] double rows() const { return rows_between_poles(source); }
};

// Nanoseconds of two cores, measured, for each unit of work (work_counters.h).
constexpr double grid_node = 80;                      // All grids of a source, per square of the rows of the finest.
constexpr double interpolated = 150;                  // An output or a node that is interpolated from a grid.
constexpr double tap = 0.07;                          // A node of a window whose kernel value is shared.
constexpr double ggx_value = 0.6, power_value = 0.9;  // A node of a window whose kernel value is computed.
constexpr double near_field_point = 0.65, power_texel = 1.6, power_point = 1.6, panel = 1.5;

// The near field of one output.
double near_field_cost(const Job& job, const LevelKernel& kernel) {
  if (kernel.kind == LevelKernel::Kind::power) {
    const double seen = 0.5 * double(kernel.end) * job.size(), reach = std::sqrt(2 * double(kernel.end));
    if (job.cube()) {
      const double side = 2.0 / job.source.height();
      const auto panels = panels_on_face(kernel, side);
      if (!panels) return 500 + power_point * points_in_texel(kernel, side) * seen;
      const int inner = *panels - 1;
      const double near = inner > 0 ? std::min(1.0, portable::pow(reach_of_panels(kernel, side, inner) / reach, 2)) : 0;
      return 500 + panel * ((inner > 0 ? 2 : 1) * double(panel_values) +
                            1.3 * seen * std::lerp(*panels * *panels, inner * inner, near));
    }
    const double side = pi / job.rows(), panels = std::ceil(std::max(1.0, variation_over(kernel, side)));
    if (panels > most_panels) return 500 + power_point * points_in_texel(kernel, side) * seen;
    const double polar = 1 - portable::cos(std::min(0.5 * pi, 64 * side + reach));  // By points.
    return 500 + (power_texel * panels + power_point * points_in_texel(kernel, side) * polar) * seen;
  }
  const double radius = std::sqrt(2 * double(kernel.end)) * job.rows() / pi;  // Counted in texels.
  return 500 + 60 * radius + near_field_point * (1200 + 23 * radius * radius) * (job.cube() ? 1.8 : 1);
}

double cost_of(const Job& job, const MultilevelPlan& plan) {
  double once = (job.cube() ? 60 : 12) * job.size() + (job.cube() ? 5 : 1) * grid_node * plan.finest() * plan.finest();
  double each = 0;
  if (plan.near_field) each += near_field_cost(job, *plan.near_field);
  if (plan.has_horizon_terms()) {
    once += (job.cube() ? 55 : 6) * job.size();
    each += (job.cube() ? 7000 : 4000) * std::sqrt(std::sqrt(plan.horizon_terms.integral()));
  }
  const int at_nodes = plan.field_rows(job.texels);
  if (at_nodes > 0) each += interpolated;
  for (const MultilevelPlan::Step& s : plan.steps)
    if (s.rows <= at_nodes)
      once += s.nodes() * (interpolated + tap * s.window());
    else
      each += (s.kernel.kind == LevelKernel::Kind::ggx ? ggx_value : power_value) * s.window();
  return once + job.texels * each;
}

double cost_of(const Job& job, const ClampedCosinePolynomial&) {
  return (job.cube() ? 32 : 6) * job.size() +
         job.texels * (job.cube() ? 2900 : 2200) * portable::pow(std::max(1.0, 1e-3 / job.error), 0.3);
}

double cost_of(const Job& job, const SheenPlan& plan) {
  const double rows = std::max(job.rows(), pi / plan.texel());
  return job.texels * 1e5 * portable::pow(rows / 512, 1.5) * portable::pow(std::max(1.0, plan.power / 12.5), 0.45);
}

// A tile goes down the tree once, and each of its directions sums the nodes, in lanes of eight.
double cost_of(const Job& job, const TreecodeLobe& lobe) {
  constexpr double bounded = 18, summed = 2.5, built = 110;
  const double across = tile_sine(lobe.lobe, job.error),
               in_tile = std::clamp(across * across * job.texels / (2 * pi), 1.0, 64.0);
  double each = nodes_of_output(lobe.lobe, job.error) * (bounded / in_tile + summed * std::max(1.0, 8 / in_tile));
  double once = built * job.size();
  if (lobe.has_horizon_terms()) {
    once += (job.cube() ? 55 : 6) * job.size();
    each += (job.cube() ? 7000 : 4000) * std::sqrt(std::sqrt(lobe.horizon_terms.integral()));
  }
  return once + job.texels * each;
}

// The quickest plan. The rows of the finest grid are free: the near field takes what is too narrow for it.
std::optional<MultilevelPlan> quickest_plan(const Job& job, const LobeFormula& lobe, double& cost) {
  std::optional<MultilevelPlan> best;
  for (int rows = 256; rows <= 2048; rows *= 2) {
    auto plan = multilevel_plan(lobe, job.error, rows, job.source.projection());
    constexpr double farthest = 0.026;  // 0.23 radians.
    if (!plan || (plan->near_field && double(plan->near_field->end) > farthest)) continue;
    const double now = cost_of(job, *plan);
    if (!best || now < cost) best = std::move(plan), cost = now;
  }
  return best;
}

}  // namespace

Choice choose(const LobeFormula& lobe, const Level& source, double texels, double error, Method wanted) {
  const Job job{source, texels, error};
  const bool any = wanted == Method::automatic;
  Choice best;
  const auto offer = [&](Method method, auto&& plan, double cost) {
    if (best.method == Method::exact || cost < best.cost)
      best = {.method = method, .cost = cost, .plan = std::forward<decltype(plan)>(plan)};
  };
  const auto polynomial = clamped_cosine_polynomial(lobe);
  if (polynomial && wanted != Method::treecode) offer(Method::prefix_sums, *polynomial, cost_of(job, *polynomial));
  if (!polynomial && (any || wanted == Method::multilevel)) {
    double cost = 0;
    if (serves_multilevel(source))
      if (auto plan = quickest_plan(job, lobe, cost)) offer(Method::multilevel, *std::move(plan), cost);
    if (const auto sheen = sheen_plan(lobe, error)) offer(Method::multilevel, *sheen, cost_of(job, *sheen));
  }
  const bool tree_is_cheap = any && !polynomial && job.size() <= most_tree_texels;
  if (wanted == Method::treecode || best.method == Method::exact || tree_is_cheap)
    if (const auto tree = treecode_lobe(lobe)) offer(Method::treecode, *tree, cost_of(job, *tree));
  return best;
}

}  // namespace envmap::prefiltering

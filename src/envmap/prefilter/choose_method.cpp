#include "envmap/prefilter/choose_method.h"

#include <algorithm>
#include <cmath>

#include "envmap/maths/portable.h"
#include "envmap/prefilter/treecode/treecode.h"

namespace envmap::prefiltering {
namespace {

// What a map is made of.
struct Job {
  const Level& source;
  double texels;  // Of the result.
  double error;

  [[nodiscard]] bool cube() const { return source.projection() == Projection::cube; }
  [[nodiscard]] double size() const { return double(index_of(source, {source.faces(), 0, 0})); }
  [[nodiscard]] double rows() const { return rows_between_poles(source); }
};

// Nanoseconds of two cores, measured, for each unit of work (work_counters.h).
constexpr double grid_node = 80;                      // Of the finest grid, rows squared: all grids of a source.
constexpr double interpolated = 150;                  // An output from a grid, or a node from a coarser one.
constexpr double tap = 0.07;                          // A node of a window, by a kernel at hand.
constexpr double ggx_value = 0.6, power_value = 0.9;  // By a kernel at an output.
constexpr double core_point = 0.65, power_texel = 1.6;

// A core of 1 - cos up to `end`.
double core_cost(const Job& job, const LevelKernel& core) {
  if (core.kind == LevelKernel::Kind::power) {
    const double seen = 0.5 * double(core.end) * job.size(), reach = std::sqrt(2 * double(core.end));
    // Texels of cubes, and those near poles, take 16 points on each of 1, 4 or 16 panels.
    const double side = pi / job.rows(), fall = side * double(core.power * core.part) * (reach + side) / core.uneven;
    const double by_points = 26 * (fall <= 1 ? 1 : fall <= 2 ? 4 : 16);
    const double polar = job.cube() ? 1 : 1 - portable::cos(std::min(0.5 * pi, 64 * side + reach));
    return 500 + (power_texel + by_points * polar) * seen;
  }
  const double radius = std::sqrt(2 * double(core.end)) * job.rows() / pi;  // In texels.
  return 500 + 60 * radius + core_point * (1200 + 23 * radius * radius) * (job.cube() ? 1.8 : 1);
}

double cost_of(const Job& job, const MultilevelPlan& plan) {
  double once = (job.cube() ? 30 : 12) * job.size() + (job.cube() ? 3 : 1) * grid_node * plan.finest() * plan.finest();
  double each = 0;
  if (plan.core) each += core_cost(job, *plan.core);
  if (plan.has_hinges()) {
    once += (job.cube() ? 55 : 6) * job.size();
    each += (job.cube() ? 7000 : 4000) * std::sqrt(std::sqrt(plan.hinges.integral()));
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

double cost_of(const Job& job, const HingePolynomial&) {
  return (job.cube() ? 32 : 6) * job.size() +
         job.texels * (job.cube() ? 2900 : 2200) * portable::pow(std::max(1.0, 1e-3 / job.error), 0.3);
}

double cost_of(const Job& job, const SheenPlan& plan) {
  const double rows = std::max(job.rows(), pi / plan.texel());
  return job.texels * 1e5 * portable::pow(rows / 512, 1.5) * portable::pow(std::max(1.0, plan.power / 12.5), 0.45);
}

// A tile goes down the tree, and each of its directions sums its nodes, in lanes of eight.
double cost_of(const Job& job, const TreecodeLobe& lobe) {
  constexpr double judged = 18, seen = 2.5, built = 110;
  const double across = tile_sine(lobe.lobe, job.error),
               in_tile = std::clamp(across * across * job.texels / (2 * pi), 1.0, 64.0);
  double each = nodes_of_output(lobe.lobe, job.error) * (judged / in_tile + seen * std::max(1.0, 8 / in_tile));
  double once = built * job.size();
  if (lobe.has_hinges()) {
    once += (job.cube() ? 55 : 6) * job.size();
    each += (job.cube() ? 7000 : 4000) * std::sqrt(std::sqrt(lobe.hinges.integral()));
  }
  return once + job.texels * each;
}

// The quickest plan: a core takes what is too narrow for the finest grid, and the rows of that are free.
std::optional<MultilevelPlan> quickest_plan(const Job& job, const Lobe& lobe, double& cost) {
  std::optional<MultilevelPlan> best;
  for (int rows = 256; rows <= 2048; rows *= 2) {
    auto plan = multilevel_plan(lobe, job.error, rows, job.source.projection());
    constexpr double farthest = 0.026;  // 0.23 radians.
    if (!plan || (plan->core && double(plan->core->end) > farthest)) continue;
    const double now = cost_of(job, *plan);
    if (!best || now < cost) best = std::move(plan), cost = now;
  }
  return best;
}

}  // namespace

Choice choose(const Lobe& lobe, const Level& source, double texels, double error, Method wanted) {
  const Job job{source, texels, error};
  const bool any = wanted == Method::automatic;
  Choice best;
  const auto take = [&](Choice&& c) {
    if (best.method == Method::exact || c.cost < best.cost) best = std::move(c);
  };
  const auto hinges = hinge_polynomial(lobe);
  if (hinges && wanted != Method::treecode)
    take({.method = Method::prefix_sums,
          .cost = cost_of(job, *hinges),
          .hinges = hinges,
          .plan = {},
          .sheen = {},
          .tree = {}});
  if (!hinges && (any || wanted == Method::multilevel)) {
    double cost = 0;
    if (serves_multilevel(source))
      if (auto plan = quickest_plan(job, lobe, cost))
        take({.method = Method::multilevel,
              .cost = cost,
              .hinges = {},
              .plan = std::move(plan),
              .sheen = {},
              .tree = {}});
    if (const auto sheen = sheen_plan(lobe, error))
      take({.method = Method::multilevel,
            .cost = cost_of(job, *sheen),
            .hinges = {},
            .plan = {},
            .sheen = sheen,
            .tree = {}});
  }
  if (wanted == Method::treecode || best.method == Method::exact || (any && !hinges && job.size() <= most_tree_texels))
    if (auto tree = treecode_lobe(lobe))
      take({.method = Method::treecode,
            .cost = cost_of(job, *tree),
            .hinges = {},
            .plan = {},
            .sheen = {},
            .tree = std::move(tree)});
  return best;
}

}  // namespace envmap::prefiltering

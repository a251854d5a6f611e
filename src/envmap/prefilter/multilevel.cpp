#include "envmap/prefilter/multilevel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "envmap/base/parallel.h"
#include "envmap/prefilter/error_floor.h"

namespace envmap::prefiltering {

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

// Sums of sheen, compiled once for every instruction set and chosen at run time.
#include "envmap/prefilter/sheen/sheen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "envmap/base/parallel.h"
#include "envmap/base/stop_point.h"
#include "envmap/base/without_avx512.h"
#include "envmap/map/environment_map.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/measure.h"
#include "envmap/prefilter/error_floor.h"
#include "envmap/prefilter/multilevel/multilevel_kernels.h"
#include "envmap/prefilter/source_cube.h"
#include "envmap/prefilter/work_counters.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/sheen/sheen.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/prefilter/sheen/sheen_places-inl.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

// Sums one direction after the other.
template <class Place>
class SheenSummation {
 public:
  SheenSummation(const SheenPlan& plan, const SheenBlocks& blocks)
      : plan_(plan), blocks_(blocks), place_(blocks, plan), side_(blocks.layers().front().side) {}

  SheenSum over(const Direction& n) {
    total_ = {}, error_ = Flux(0), uncertain_.clear();
    const std::size_t top = blocks_.layers().size() - 1;
    const SheenBlocks::Layer& layer = blocks_.layers()[top];
    for (int face = 0; face < blocks_.faces(); ++face) {
      const Direction in_face = blocks_.in_face(face, n);
      for (int row = 0; row < layer.down; ++row)
        for (int column = 0; column < layer.across; ++column) add_block(top, in_face, face, row, column);
    }
    SheenSum sum{blocks_.min_radiance() + total_.flux(), 0};
    if (relative_error(sum.value) > plan_.cut) refine(sum.value);
    sum.error = std::isfinite(sum.value.x + sum.value.y + sum.value.z) ? relative_error(sum.value)
                                                                       : std::numeric_limits<double>::infinity();
    return sum;
  }

 private:
  struct UncertainBlock {
    Direction seen;
    int row, column;
    std::size_t block;
  };

  [[nodiscard]] double relative_error(const Flux& value) const {
    double most = 0;
    for (int c = 0; c < 3; ++c) most = std::max(most, error_[c] / std::max(floor_of_mean, value[c]));
    return most;
  }

  // Skips, adds or divides a block.
  void add_block(std::size_t depth, const Direction& n, int face, int row, int column) {
    const SheenBlocks::Layer& layer = blocks_.layers()[depth];
    const std::size_t block = layer.index(face, row, column);
    if (layer.lit[block] == 0) return;
    const Direction seen = blocks_.in_block(n, layer, column);
    const SheenBlocks::Shape& shape = blocks_.shape(layer, row, column);
    const double t = glm::dot(seen, shape.centre), reach = shape.radius;
    if (t <= -reach || t - reach >= plan_.end) return;
    if (int(depth) < plan_.layers && t >= 1.35 * reach) return add_points(seen, t, shape, layer.light[block]);
    if (depth == 0) return add_texels(seen, row, column, block);
    const SheenBlocks::Layer& finer = blocks_.layers()[depth - 1];
    for (int r = 2 * row; r < std::min(2 * row + 2, finer.down); ++r)
      for (int q = 2 * column; q < std::min(2 * column + 2, finer.across); ++q) add_block(depth - 1, n, face, r, q);
  }

  void add_points(const Direction& seen, double t, const SheenBlocks::Shape& shape, const SheenBlocks::Points& light) {
    const D d;
    const V x = broadcast(d, seen.x), y = broadcast(d, seen.y), z = broadcast(d, seen.z), middle = broadcast(d, t),
            scale = broadcast(d, plan_.scale);
    Sums sum;
    count(Work::sheen, std::size_t(SheenBlocks::points));
    for (std::size_t k = 0; k < std::size_t(SheenBlocks::points); k += virtual_lanes)
      for (std::size_t part = 0; part < parts; ++part) {
        const std::size_t at = k + part * lanes;
        const V offset = x * hn::Load(d, shape.offset[0] + at) +
                         (y * hn::Load(d, shape.offset[1] + at) + z * hn::Load(d, shape.offset[2] + at));
        const V cosine = middle + offset;
        const V value = scale * cosine * sheen_power(d, plan_.power, cosine);
        sum.add(part, value, light.light[0] + at, SheenBlocks::points);
      }
    total_.add(sum);
  }

  // Adds the texels of a block that the horizon cuts, or that its points do not serve.
  void add_texels(const Direction& seen, int row, int column, std::size_t block) {
    const D d;
    const auto stride = std::size_t(side_);
    Sums sum, error;
    bool uncertain = false;
    count(Work::sheen, stride * stride);
    for (int j = 0; j < side_; ++j)
      for (int i = 0; i < side_; i += int(virtual_lanes)) {
        const auto texels = place_.texels(seen, row, column, j, i);
        for (std::size_t part = 0; part < parts; ++part) {
          const Weights w = weights(texels, part * lanes);
          uncertain = uncertain || !hn::AllFalse(d, w.uncertain);
          const float* light = blocks_.texels(block, j, 0) + std::size_t(i) + part * lanes;
          sum.add(part, w.sum, light, stride), error.add(part, w.error, light, stride);
        }
      }
    total_.add(sum);
    if (!uncertain) return;
    error_ += error.whole();
    uncertain_.push_back({seen, row, column, block});
  }

  // The integral of the lobe over texels, an estimate of its error, and the texels whose error counts.
  struct Weights {
    V sum, error;
    hn::Mask<D> uncertain;
  };
  template <class Texels>
  HWY_INLINE Weights weights(const Texels& texels, std::size_t lane) const {
    const D d;
    const V zero = hn::Zero(d), scale = broadcast(d, plan_.scale);
    Weights w{zero, zero, hn::Lt(zero, zero)};
    const Cell<V> all = texels.texel(lane);
    const V wide = extent(all) + broadcast(d, texels.bend());
    // The result of a lane must not depend on other lanes: their number depends on the processor.
    const auto seen = hn::And(hn::Gt(all.centre, hn::Neg(wide)), hn::Lt(all.centre - wide, broadcast(d, plan_.end)));
    if (hn::AllFalse(d, seen)) return w;
    const auto above = hn::And(seen, hn::Ge(all.centre, wide));
    const bool takes_points = texels.is_polar() || plan_.cells > 1;
    if (takes_points && !hn::AllFalse(d, above)) w.sum = hn::IfThenElseZero(above, by_points(texels, lane));
    const auto by_cells = takes_points ? hn::AndNot(above, seen) : seen;
    for (int r = 0; r < texels.down() && !hn::AllFalse(d, by_cells); ++r)
      for (int q = 0; q < texels.across(); ++q)
        add_cell(texels, r, plan_.cells == 1 ? all : texels.cell(r, q, lane), by_cells, w);
    w.sum = w.sum * scale, w.error = w.error * scale;
    return w;
  }

  // Adds one cell of each of some texels, in row r of their cells.
  template <class Texels>
  HWY_INLINE void add_cell(const Texels& texels, int r, const Cell<V>& cell, hn::Mask<D> some, Weights& w) const {
    const D d;
    const V bend = broadcast(d, texels.bend(r)), reach = extent(cell) + bend;
    const auto is_above = hn::And(some, hn::Ge(cell.centre, reach));
    const auto is_cut = hn::AndNot(is_above, hn::And(some, hn::Gt(cell.centre, hn::Neg(reach))));
    if (!hn::AllFalse(d, is_above)) w.sum += hn::IfThenElseZero(is_above, cell.area * mean_above(d, plan_.power, cell));
    if (texels.is_polar()) {
      const V skew = reach * reach * (reach * broadcast(d, polar_error * plan_.power * plan_.power));
      w.error += hn::IfThenElseZero(is_above, cell.area * skew);
      w.uncertain = hn::Or(w.uncertain, is_above);
    }
    if (hn::AllFalse(d, is_cut)) return;
    const V mean = mean_cut(d, plan_.power, cell);
    const V steep = broadcast(d, plan_.power) * reach, square = steep * steep;
    const V of_bend = bend * broadcast(d, texels.is_polar() ? 1 : 0.35);
    const V of_series = mean * (broadcast(d, series_error) * (square * square));
    const V error = reach * broadcast(d, 1e-5) + (of_bend + of_series);
    w.sum += hn::IfThenElseZero(is_cut, cell.area * mean);
    w.error += hn::IfThenElseZero(is_cut, cell.area * error);
    w.uncertain = hn::Or(w.uncertain, is_cut);
  }

  // The integral over texels above the horizon, by Gauss points.
  template <class Texels>
  HWY_INLINE V by_points(const Texels& texels, std::size_t lane) const {
    const D d;
    V sum = hn::Zero(d);
    for (int r = 0; r < texels.points_down(); ++r)
      for (int q = 0; q < texels.points_across(); ++q) {
        const Point<V> p = texels.point(r, q, lane);
        sum += p.weight * p.cosine * sheen_power(d, plan_.power, p.cosine);
      }
    return sum;
  }

  // Divides the texels with cut cells whose errors are too large.
  void refine(Flux& value) {
    const double lights = double(uncertain_.size()) * side_;
    Flux most(0);  // The error that one texel may have.
    for (int c = 0; c < 3; ++c) most[c] = 0.5 * plan_.cut * std::max(floor_of_mean, value[c]) / lights;
    error_ = Flux(0);
    for (const UncertainBlock& b : uncertain_)
      for (int j = 0; j < side_; ++j)
        for (int i = 0; i < side_; i += int(virtual_lanes)) {
          const auto texels = place_.texels(b.seen, b.row, b.column, j, i);
          for (std::size_t part = 0; part < parts; ++part)
            refine_texels(texels, part * lanes, b, j, std::size_t(i) + part * lanes, most, value);
        }
  }
  // A vector of texels from `lane` on, which are texels `first` and so on of row j of their block.
  template <class Texels>
  void refine_texels(const Texels& texels, std::size_t lane, const UncertainBlock& b, int j, std::size_t first,
                     const Flux& most, Flux& value) {
    const Weights w = weights(texels, lane);
    float sum[virtual_lanes], error[virtual_lanes];
    hn::StoreU(w.sum, D(), sum), hn::StoreU(w.error, D(), error);
    for (std::size_t k = 0; k < lanes; ++k) {
      Flux light;
      for (int c = 0; c < 3; ++c) light[c] = double(blocks_.texels(b.block, j, c)[first + k]);
      if (!(error[k] > 0) || light == Flux(0)) continue;
      double allowed = 1e300;
      for (int c = 0; c < 3; ++c)
        if (light[c] > 0) allowed = std::min(allowed, most[c] / light[c]);
      double refined = sum[k], left = error[k];
      if (left > allowed)
        refined = left = 0, divide(texels.whole(int(lane + k)), b.seen, allowed / 16, 0, refined, left);
      value += (refined - double(sum[k])) * light, error_ += left * light;
    }
  }

  // Adds a texel or a part of one in double, divided until its error is allowed.
  void divide(const typename Place::Part& part, const Direction& seen, double allowed, int depth, double& sum,
              double& bound) const {
    const ScalarTag d;
    const auto cell = part.cell(seen);
    const double reach = hn::GetLane(extent(cell)), centre = hn::GetLane(cell.centre),
                 area = hn::GetLane(cell.area) * plan_.scale, steep = plan_.power * reach, bend = part.bend();
    if (centre <= -reach - bend) return;
    const bool above = centre >= reach + bend;
    const double mean = hn::GetLane(above ? mean_above(d, plan_.power, cell) : mean_cut(d, plan_.power, cell));
    const double skew = part.is_polar() ? polar_error * reach * steep * steep : 0;
    const double error = above ? 0.1 * std::abs(mean) * steep * steep * steep * steep + skew
                               : 1e-8 * reach + bend + series_error * mean * steep * steep * steep * steep;
    constexpr int deepest = 14;
    if (area * error <= (above ? 1e-5 : 1) * allowed + 1e-5 * area * mean || depth == deepest) {
      sum += area * mean, bound += area * error;
      return;
    }
    for (int k = 0; k < 4; ++k) divide(part.quarter(k), seen, allowed, depth + 1, sum, bound);
  }

  // The light of many blocks. After every 32 blocks the float sums move to double.
  struct Total {
    Sums sum;
    Flux settled{0};
    int count = 0;
    Total() {}  // NOLINT: a defaulted constructor lacks the target's attributes.
    void add(const Sums& more) {
      sum.add(more);
      if (++count == 32) settle();
    }
    void settle() {
      settled += sum.whole();
      sum = {}, count = 0;
    }
    Flux flux() {
      settle();
      return settled;
    }
  };

  static constexpr double series_error = 5e-3;  // Factor of the fourth order, which mean_cut() leaves out.

  static constexpr double polar_error = 0.012;  // Factor of the third order of cells that narrow to one side.

  const SheenPlan& plan_;
  const SheenBlocks& blocks_;
  const Place place_;
  int side_;
  Total total_;
  Flux error_{0};
  std::vector<UncertainBlock> uncertain_;
};

void SumAll(const SheenPlan& plan, const SheenBlocks& blocks, std::span<const Direction> directions,
            std::span<SheenSum> out) {
  const auto go = [&](auto summation) {
    for (std::size_t k = 0; k < directions.size(); ++k) {
      stop_point();
      out[k] = summation.over(directions[k]);
    }
  };
  if (blocks.is_latlong())
    go(SheenSummation<OnLatlongCells>(plan, blocks));
  else
    go(SheenSummation<OnCubeCells>(plan, blocks));
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap::prefiltering {
HWY_EXPORT(SumAll);

// By the remainder of Gauss's rule (Abramowitz and Stegun 1964, 25.4.30) for a power of e, and for t times it near the
// horizon. At least three points, as two are too few for narrow texels at a pole.
int points_for(double steep, double error) {
  double factor = 1;  // (n!)^4 / ((2n)!)^3 x steep^2n.
  for (int n = 1; n <= most_points; ++n) {
    const double even = 2.0 * n * (2 * n - 1);
    factor *= double(n) * n * n * n * steep * steep / (even * even * even);
    if (n > 2 && factor / (2 * n + 1) * (1 + steep) * (1 + 2 * n / steep) <= error) return n;
  }
  return most_points;
}

namespace {

// The largest error of interpolation over blocks above the horizon, in the direction in which the lobe varies, relative
// to the lobe or to the floor. @param size of a block, an angle.
double interpolation_error(const Charlie& lobe, double size) {
  constexpr int nodes = SheenBlocks::nodes, steps = 12;
  const auto lobe_at = [&](double angle) { return lobe.value(1 - portable::sin_pi(angle / pi)); };
  std::array<double, nodes> node;
  for (int k = 0; k < nodes; ++k) node[std::size_t(k)] = 0.5 - 0.5 * portable::cos_pi((k + 0.5) / nodes);
  double worst = 0;
  for (double from = 0.25 * size; from < 0.5 * pi; from *= 1.2)
    for (int step = 0; step <= steps; ++step) {
      const double x = double(step) / steps;
      double sum = 0;
      for (std::size_t i = 0; i < nodes; ++i) {
        double weight = 1;
        for (std::size_t k = 0; k < nodes; ++k)
          if (k != i) weight *= (x - node[k]) / (node[i] - node[k]);
        sum += weight * lobe_at(from + node[i] * size);
      }
      const double truth = lobe_at(from + x * size);
      worst = std::max(worst, std::abs(sum - truth) / std::max(truth, floor_density));
    }
  return worst;
}

}  // namespace

std::optional<SheenPlan> sheen_plan(const LobeFormula& lobe, double error) {
  const auto* sheen = std::get_if<Charlie>(&lobe);
  if (sheen == nullptr || sheen->power < least_sheen_power || error < 1e-4) return std::nullopt;
  SheenPlan plan{.power = sheen->power,
                 .scale = sheen->scale(),
                 .end = sheen->width(),
                 .layers = 0,
                 .cells = 1,
                 .points = 3,
                 .points_error = 0,
                 .cut = 0.4 * error,
                 .error = 0.6 * error};
  double high = 1;
  for (int step = 0; step < 50; ++step) {
    const double middle = 0.5 * (plan.end + high);
    (sheen->value(1 - middle) < 0.02 * error * floor_density ? high : plan.end) = middle;
  }
  plan.end = high;
  return plan;
}

SheenPlan fitted(SheenPlan plan, const SheenBlocks& blocks) {
  const double texel = blocks.texel();
  const double error = plan.error / 0.6;
  const double steep = plan.power * texel;
  plan.cells = std::max(1, int(std::ceil(steep / portable::pow(105 * error, 0.25))));
  plan.points_error = 0.1 * error, plan.points = points_for(steep, plan.points_error);
  Charlie lobe(1);
  lobe.power = plan.power;
  for (const SheenBlocks::Layer& layer : blocks.layers()) {
    if (interpolation_error(lobe, layer.side * texel) > 0.3 * error) break;
    ++plan.layers;
  }
  return plan;
}

void sheen_sums(const SheenPlan& plan, const SheenBlocks& blocks, std::span<const Direction> directions,
                std::span<SheenSum> out) {
  HWY_DYNAMIC_DISPATCH(SumAll)(plan, blocks, directions, out);
}

void sheen_map(const SheenPlan& plan, const SheenBlocks& blocks, double unit, const TargetTexels& map) {
  const SheenPlan fit = fitted(plan, blocks);
  map.each_row([&](std::span<const Direction> directions, std::span<Colour> texels, std::span<float> bounds) {
    std::vector<SheenSum> sums(directions.size());
    sheen_sums(fit, blocks, directions, sums);
    for (std::size_t k = 0; k < sums.size(); ++k) {
      texels[k] = Colour(unit * glm::max(Flux(0), sums[k].value));
      bounds[k] = std::nextafter(float(fit.error + sums[k].error), 1.F);
    }
  });
}

}  // namespace envmap::prefiltering
#endif  // HWY_ONCE

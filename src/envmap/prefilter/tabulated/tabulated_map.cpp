// One sum: of all nodes whose bounds are added up, the one of the largest is opened, until the sum of the bounds is
// small enough. docs/explanation/prefilter-tables.md derives the bound of a node.
#include "envmap/prefilter/tabulated/tabulated_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "envmap/base/stop_point.h"
#include "envmap/prefilter/cell_moments.h"
#include "envmap/prefilter/error_floor.h"
#include "envmap/prefilter/work_counters.h"

namespace envmap::prefiltering {
namespace {

// A block of the tree, or below its first level a part of a texel.
struct Place {
  int face, level, i, j;
  Rect rect{};
  Flux radiance{0};
};
constexpr int of_texel = -1, deepest = of_texel - 16;  // Levels of texels and of their parts.

struct Term {
  double key;  // What opening it may take from the bound.
  Flux sum, error;
  Place place;
};

// The cosines of the angles between a direction and the light of a node, at least and at most.
struct Interval {
  double low, high;
};
Interval cosines(const TreeNode& node, double to_axis) {
  constexpr double rounding = 5e-7;  // Of the node's cosine and sine.
  const double c = double(node.cosine), s = double(node.sine);
  const double side = std::sqrt(std::max(0.0, (1 - to_axis) * (1 + to_axis)));
  const double middle = to_axis * c, half = side * s;
  return {to_axis > -c ? middle - half - rounding : -1, to_axis < c ? middle + half + rounding : 1};
}

class TableSum {
 public:
  TableSum(const Tree& tree, const TableLobe& lobe, double max_error)
      : tree_(tree), lobe_(lobe), max_error_(max_error) {}

  // @return the sum and its bound in units of the mean, of the excess over the least radiance.
  struct Total {
    Flux sum{0}, error{0};
  };
  Total over(const Direction& r) {
    constexpr std::size_t most_terms = 1 << 18;
    r_ = r, terms_.clear(), done_ = {}, now_ = {};
    const Tree::Blocks& top = tree_.blocks(tree_.last());
    for (int face = 0; face < top.faces; ++face) add({face, tree_.last(), 0, 0});
    std::uint64_t opened = 0;
    while (!terms_.empty() && !within() && terms_.size() < most_terms) {
      std::ranges::pop_heap(terms_, {}, &Term::key);
      const Term t = terms_.back();
      terms_.pop_back();
      now_.sum -= t.sum, now_.error -= t.error;
      open(t.place);
      if (++opened % 65536 == 0) stop_point();
    }
    count(Work::bounded_nodes, 4 * opened);
    count(Work::node_sums, terms_.size());
    // The sums that opened nodes were taken from have rounded.
    Total total = done_;
    for (const Term& t : terms_) total.sum += t.sum, total.error += t.error;
    return total;
  }

 private:
  [[nodiscard]] bool within() const {
    for (int c = 0; c < 3; ++c) {
      const double sum = done_.sum[c] + now_.sum[c], error = done_.error[c] + now_.error[c];
      const double least = std::max(sum - error + tree_.min_radiance()[c], floor_of_mean);
      if (error > 0.98 * max_error_ * least) return false;
    }
    return true;
  }

  void add(const Place& place) {
    const TreeNode& node = tree_.blocks(place.level).node(place.face, place.i, place.j);
    add(node, place);
  }
  void add(const TreeNode& node, const Place& place) {
    const Flux flux(node.flux[0], node.flux[1], node.flux[2]);
    if (flux == Flux(0)) return;
    const double to_axis = std::clamp(glm::dot(r_, node.axis), -1.0, 1.0);
    const Interval in = cosines(node, to_axis);
    const LobeLine line = lobe_.line(in.low, in.high, to_axis * (1 - double(node.sag)));
    // Of the floats of the node, and of its moments by Gauss's points (moments.h).
    constexpr double of_floats = 4 * 0x1p-24, of_moments = 1e-11;
    const double rounding = of_floats * (std::abs(line.value) + std::abs(line.slope) * (in.high - in.low)) +
                            of_moments * std::abs(line.slope);
    if (line.value == 0 && line.error == 0 && rounding == 0) return;
    Term t{.key = line.error * (flux.x + flux.y + flux.z),
           .sum = {},
           .error = (line.error + rounding) * flux,
           .place = place};
    for (int c = 0; c < 3; ++c) {
      const auto& first = node.first[std::size_t(c)];
      t.sum[c] = line.value * flux[c] +
                 line.slope * (r_.x * double(first[0]) + r_.y * double(first[1]) + r_.z * double(first[2]));
    }
    if (line.error == 0 || place.level <= deepest) {
      done_.sum += t.sum, done_.error += t.error;
      return;
    }
    now_.sum += t.sum, now_.error += t.error;
    terms_.push_back(t);
    std::ranges::push_heap(terms_, {}, &Term::key);
  }

  void open(const Place& p) {
    if (p.level > tree_.first()) {
      const Tree::Blocks& below = tree_.blocks(p.level - 1);
      for (int j = 2 * p.j; j < std::min(below.height, 2 * p.j + 2); ++j)
        for (int i = 2 * p.i; i < std::min(below.width, 2 * p.i + 2); ++i) add({p.face, p.level - 1, i, j});
    } else {
      visit_source(tree_.source().projection(), [&](auto projection) { open_texels<decltype(projection)>(p); });
    }
  }
  template <class P>
  void open_texels(const Place& p) {
    if (p.level < tree_.first()) {
      for (const Rect& r : quarters(p.rect)) add_part<P>({p.face, p.level - 1, 0, 0, r, p.radiance});
      return;
    }
    const Level& source = tree_.source();
    const int side = 1 << tree_.first();
    for (int j = p.j * side; j < std::min(source.height(), (p.j + 1) * side); ++j)
      for (int i = p.i * side; i < std::min(source.width(), (p.i + 1) * side); ++i)
        if (const Flux light = tree_.excess(*source.texel(p.face, i, j)); light != Flux(0))
          add_part<P>({p.face, of_texel, 0, 0, texel_rect(i, j, source.width(), source.height()), light});
  }
  template <class P>
  void add_part(const Place& p) {
    add(node_of(patch_of<P>(p.face, p.rect), {p.radiance.x, p.radiance.y, p.radiance.z}), p);
  }

  const Tree& tree_;
  const TableLobe& lobe_;
  double max_error_;
  Direction r_{0};
  std::vector<Term> terms_;  // A heap.
  Total done_, now_;         // Of nodes that opening does not help, and of the others.
};

}  // namespace

void tabulated_map(const Tree& tree, const TableLobe& lobe, double max_error, const TargetTexels& map) {
  constexpr double rounding = 0x1p-22;  // Of the result, and of the source less its least radiance.
  map.each_row([&](std::span<const Direction> directions, std::span<Colour> texels, std::span<float> bounds) {
    TableSum sum(tree, lobe, max_error - rounding);
    for (std::size_t k = 0; k < directions.size(); ++k) {
      const auto [excess, error] = sum.over(directions[k]);
      double worst = 0;
      for (int c = 0; c < 3; ++c) {
        const double whole = excess[c] + tree.min_radiance()[c];
        worst = std::max(worst, error[c] / std::max(whole - error[c], floor_of_mean));
        texels[k][c] = float(tree.mean() * std::max(0.0, whole));
      }
      bounds[k] = std::nextafter(float(worst + rounding), std::numeric_limits<float>::infinity());
    }
    tree.source().trim();
  });
}

}  // namespace envmap::prefiltering

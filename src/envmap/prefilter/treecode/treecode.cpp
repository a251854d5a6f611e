// Goes down the tree for tiles of neighbouring directions, sums the nodes, and certifies each texel by the sum of their
// bounds. Where that exceeds the error that was asked for, smaller nodes are tried.
#include "envmap/prefilter/treecode/treecode.h"

#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "envmap/base/parallel.h"
#include "envmap/base/stop_point.h"
#include "envmap/operate/measure.h"
#include "envmap/prefilter/cell_moments.h"
#include "envmap/prefilter/error_floor.h"
#include "envmap/prefilter/treecode/treecode_kernels.h"
#include "envmap/prefilter/work_counters.h"

namespace envmap::prefiltering {
namespace {

constexpr int tile_side = 8;

// The opening criterion of a tile: a node is small enough if its bound x flux x weight is within the limit.
struct Criterion {
  std::array<float, channels> weight;  // 1 over the result of a direction, about.
  float limit;                         // Largest error of a node, relative to the result.
  std::size_t most_nodes;              // With more nodes the exact sum is quicker.
};

// Goes down a tree, level by level, to nodes that are small enough for all directions of a tile.
class Traversal {
 public:
  explicit Traversal(const Tree& tree, const TreecodeLobe& lobe) : tree_(tree), lobe_(lobe) {}

  // @return false where there are too many nodes.
  bool run(const Tile& tile, const Criterion& criterion) {
    tile_ = &tile, criterion_ = criterion;
    nodes_.clear(), own_.clear(), bound_ = {}, bounded_ = 0;
    next_.clear();
    const Tree::Blocks& top = tree_.blocks(tree_.last());
    for (int face = 0; face < top.faces; ++face) next_.push_back({face, 0, 0});
    // The top of a face is read as the first of four blocks.
    for (int k = tree_.last(); k >= tree_.first() && !next_.empty() && !enough(); --k) open_level(k);
    if (!enough()) visit_source(tree_.source().projection(), [&](auto p) { open_blocks<decltype(p)>(); });
    count(Work::bounded_nodes, bounded_);
    return !enough();
  }
  [[nodiscard]] const NodeSums& nodes() const { return nodes_; }
  // The sum of their bounds.
  [[nodiscard]] const std::array<double, channels>& bound() const { return bound_; }

 private:
  struct Block {
    int face, i, j;
  };
  // A texel or a part of one.
  struct Part {
    int face, depth;
    Rect rect;
    std::array<double, channels> radiance;
  };
  static constexpr int deepest = 16;  // Halvings of a texel.

  [[nodiscard]] bool enough() const {
    return nodes_.count() > criterion_.most_nodes || bounded_ > 4 * criterion_.most_nodes;  // Twice as many as usual.
  }

  [[nodiscard]] bool good(const NodeGroup& group, std::size_t lane) const {
    float flux = 0;
    for (std::size_t c = 0; c < channels; ++c) flux = std::max(flux, group.flux[c][lane] * criterion_.weight[c]);
    return bounds_.bound[lane] * flux <= criterion_.limit;
  }
  void accept(const TreeNode& node, std::size_t lane) {
    nodes_.of(bounds_.form[lane]).push_back({&node, bounds_.constant[lane], bounds_.line[lane]});
    for (std::size_t c = 0; c < channels; ++c) bound_[c] += double(bounds_.bound[lane]) * node.flux[c];
  }

  // Bounds the nodes in the group. A tile beside a sun has so many groups that an operation may end between them.
  void bound_group(std::size_t nodes) {
    stop_point();
    bound_nodes(lobe_, *tile_, group_, bounds_);
    bounded_ += nodes;
  }

  // Takes or opens the blocks of level k. `next_` names them by fours, and afterwards the fours of the level below, or
  // blocks of texels to be opened.
  void open_level(int k) {
    const Tree::Blocks& blocks = tree_.blocks(k);
    std::swap(now_, next_), next_.clear();
    for (std::size_t from = 0; from < now_.size() && !enough(); from += 4) {
      const std::size_t many = std::min<std::size_t>(4, now_.size() - from);
      for (std::size_t q = 0; q < 4; ++q)
        put(q < many ? blocks.quad(now_[from + q].face, now_[from + q].i, now_[from + q].j) : NodeQuad{}, q);
      bound_group(4 * many);
      for (std::size_t lane = 0; lane < 4 * many; ++lane) {
        if (!(bounds_.visible >> lane & 1)) continue;
        const Block& of = now_[from + lane / 4];
        const Block block{of.face, 2 * of.i + int(lane % 2), 2 * of.j + int(lane / 2 % 2)};
        if (good(group_, lane))
          accept(blocks.node(block.face, block.i, block.j), lane);
        else
          next_.push_back(block);
      }
    }
  }
  // Four nodes of a group.
  void put(const NodeQuad& quad, std::size_t place) {
    const auto copy = [&](const NodeQuad::Lanes& from, NodeGroup::Lanes& to) {
      std::copy(from.begin(), from.end(), to.begin() + std::ptrdiff_t(4 * place));
    };
    for (std::size_t n = 0; n < 3; ++n) copy(quad.axis[n], group_.axis[n]);
    copy(quad.cosine, group_.cosine), copy(quad.sine, group_.sine);
    copy(quad.tangent2, group_.tangent2), copy(quad.tangent4, group_.tangent4), copy(quad.tangent3, group_.tangent3);
    copy(quad.radial2, group_.radial2), copy(quad.radial4, group_.radial4);
    for (std::size_t c = 0; c < channels; ++c) copy(quad.flux[c], group_.flux[c]);
  }

  // Opens the lowest blocks that are too large into texels, texels into quarters, and so on.
  template <class P>
  void open_blocks() {
    const Level& source = tree_.source();
    const int side = 1 << tree_.first();
    parts_.clear();
    for (const Block& b : next_)
      for (int j = b.j * side; j < std::min(source.height(), (b.j + 1) * side); ++j)
        for (int i = b.i * side; i < std::min(source.width(), (b.i + 1) * side); ++i)
          if (const Flux light = tree_.excess(*source.texel(b.face, i, j)); light != Flux(0)) {
            const Part texel{b.face, 0, texel_rect(i, j, source.width(), source.height()), {light.x, light.y, light.z}};
            if (side == 1)  // A block of one texel was tried as such.
              divide(texel);
            else
              parts_.push_back(texel);
          }
    while (!parts_.empty() && !enough()) {
      std::swap(parts_, open_), parts_.clear();
      for (std::size_t from = 0; from < open_.size() && !enough(); from += 16)
        open_parts<P>(std::span(open_).subspan(from, std::min<std::size_t>(16, open_.size() - from)));
    }
  }
  template <class P>
  void open_parts(std::span<const Part> parts) {
    group_ = {};
    std::array<const TreeNode*, 16> made;
    for (std::size_t lane = 0; lane < parts.size(); ++lane) {
      made[lane] = &own_.emplace_back(node_of(patch_of<P>(parts[lane].face, parts[lane].rect), parts[lane].radiance));
      group_.set(lane, *made[lane]);
    }
    bound_group(parts.size());
    for (std::size_t lane = 0; lane < parts.size(); ++lane) {
      const Part& part = parts[lane];
      if (!(bounds_.visible >> lane & 1)) continue;
      if (good(group_, lane) || part.depth >= deepest)
        accept(*made[lane], lane);
      else
        divide(part);
    }
  }
  void divide(const Part& part) {
    for (const Rect& r : quarters(part.rect)) parts_.push_back({part.face, part.depth + 1, r, part.radiance});
  }

  const Tree& tree_;
  const TreecodeLobe& lobe_;
  const Tile* tile_ = nullptr;
  Criterion criterion_{};
  NodeSums nodes_;
  std::deque<TreeNode> own_;  // Nodes of texels and of their parts.
  std::array<double, channels> bound_{};
  std::uint64_t bounded_ = 0;
  std::vector<Block> now_, next_;
  std::vector<Part> parts_, open_;
  NodeGroup group_{};
  NodeBounds bounds_{};
};

// Makes the tiles of a row, from left to right.
class TileRow {
 public:
  TileRow(const Tree& tree, const PrefixSums* prefix_sums, const TreecodeLobe& lobe, double max_error,
          const TargetTexels& map)
      : tree_(tree),
        prefix_sums_(prefix_sums),
        lobe_(lobe),
        max_error_(max_error),
        most_sine_(tile_sine(lobe.lobe, max_error)),
        map_(map),
        traversal_(tree, lobe),
        from_min_radiance_((1 - lobe.horizon_terms.integral()) * tree.min_radiance()) {
    // A guess for the first tile of a row.
    for (int c = 0; c < 3; ++c) guess_[std::size_t(c)] = std::max(tree.min_radiance()[c], 0.3);
    limit_ = 1e-3 * max_error;
  }

  void fill(int face, int x, int y, int w, int h) {
    std::array<Direction, Tile::most> directions;
    std::array<Texel, Tile::most> texels;
    std::size_t count = 0;
    for (int j = y; j < y + h; ++j) {
      const Columns in = columns(map_.target.to, map_.target.size, j);
      const int first = std::max(x, in.first), end = std::min(x + w, in.end);
      if (first >= end) continue;
      texel_directions(map_.target.to, map_.target.size, face, j, first,
                       std::span(directions).subspan(count, std::size_t(end - first)));
      for (int i = first; i < end; ++i) texels[count++] = {face, i, j};
    }
    if (count == 0) return;
    const std::span all = std::span(directions).first(count);
    rotate(map_.target.to_source, all);
    const Tile tile(all);
    if ((count == 1 || (tile.sine <= most_sine_ && tile.cosine > 0)) && set(tile, all, std::span(texels).first(count)))
      return;
    if (count == 1) return;
    const int left = w >= h ? w / 2 : w, top = w >= h ? h : h / 2;
    fill(face, x, y, left, top);
    if (w >= h)
      fill(face, x + left, y, w - left, h);
    else
      fill(face, x, y + top, w, h - top);
  }

 private:
  // Sets the texels of a tile. @return false, with no texel set, where all tries together would take too many nodes.
  bool set(const Tile& tile, std::span<const Direction> directions, std::span<const Texel> texels) {
    constexpr int most_tries = 8;
    std::array<PrefixSum, Tile::most> at_horizon{};
    bool has_horizon = false;
    double before = std::numeric_limits<double>::infinity();
    const float first_limit = limit_;
    const auto give_up = [&] {
      limit_ = first_limit;
      return false;
    };
    std::size_t left = most_nodes(texels.size());
    for (int n = 0; n < most_tries; ++n) {
      if (!traversal_.run(tile, criterion(left))) return give_up();
      left -= traversal_.nodes().count();
      evaluate(lobe_, traversal_.nodes(), tile, sums_);
      count(Work::node_sums, traversal_.nodes().count() * tile.count);
      if (lobe_.has_horizon_terms() && !std::exchange(has_horizon, true)) set_horizon(directions, at_horizon);
      const TileBounds bounds = bound(tile.count, at_horizon);
      // The bound over the error that is left to the nodes. It falls about as the limit to the power of two thirds.
      const double ratio = std::max(1e-3, (bounds.all - bounds.horizon) / (max_error_ - bounds.horizon));
      if (bounds.all <= max_error_) {
        limit_ *= float(std::clamp(portable::pow(0.85 / ratio, 1.5), 0.3, 2.0));
        store(texels, at_horizon);
        return true;
      }
      // Smaller nodes do not help where rounding or the horizon has the largest part.
      if (!(bounds.all <= 0.95 * before) || bounds.horizon > 0.8 * max_error_) return give_up();
      before = bounds.all, limit_ *= float(std::clamp(portable::pow(0.8 / ratio, 1.5), 1e-3, 0.8));
    }
    return give_up();
  }

  // The number of nodes from which the exact sum of so many directions is quicker.
  [[nodiscard]] std::size_t most_nodes(std::size_t directions) const {
    const Level& s = tree_.source();
    return std::clamp<std::size_t>(directions * index_of(s, {s.faces(), 0, 0}) / 4, 1 << 15, 1 << 17);
  }
  [[nodiscard]] Criterion criterion(std::size_t most_nodes) const {
    Criterion c{.weight = {}, .limit = limit_, .most_nodes = most_nodes};
    for (std::size_t k = 0; k < channels; ++k) c.weight[k] = float(1 / std::max(floor_of_mean, guess_[k]));
    return c;
  }

  void set_horizon(std::span<const Direction> directions, std::span<PrefixSum> out) const {
    std::array<Flux, Tile::most> beside;
    for (std::size_t k = 0; k < directions.size(); ++k) beside[k] = tree_.mean() * smooth(k);
    prefix_sums_->sums(lobe_.horizon_terms, directions, 0.3 * max_error_, std::span(beside).first(directions.size()),
                       out);
  }
  [[nodiscard]] Flux smooth(std::size_t k) const {
    return Flux(sums_[0][k], sums_[1][k], sums_[2][k]) + from_min_radiance_;
  }

  struct TileBounds {
    double all = 0, horizon = 0;  // The largest bound of a texel, and of its prefix sums.
  };
  // Sets the bound of each texel, and the guess for the next try or tile.
  TileBounds bound(std::size_t count, std::span<const PrefixSum> at_horizon) {
    constexpr double rounding = 0x1p-22;  // Of the result, and of the source less its least radiance.
    TileBounds largest;
    guess_.fill(std::numeric_limits<double>::max());
    for (std::size_t k = 0; k < count; ++k) {
      const Flux sum = smooth(k) + at_horizon[k].value / tree_.mean();
      double worst = 0;
      for (int c = 0; c < 3; ++c) {
        const auto ch = std::size_t(c);
        const double horizon = at_horizon[k].bound[c] / tree_.mean(), error = traversal_.bound()[ch] + horizon;
        const double least = std::max(sum[c] - error, floor_of_mean);
        if (!std::isfinite(error)) worst = std::numeric_limits<double>::infinity();
        worst = std::max(worst, error / least), largest.horizon = std::max(largest.horizon, horizon / least);
        guess_[ch] = std::min(guess_[ch], std::max(least, 0.5 * sum[c]));
      }
      if (!std::isfinite(sum.x + sum.y + sum.z)) worst = std::numeric_limits<double>::infinity();
      bounds_[k] = worst + rounding, largest.all = std::max(largest.all, bounds_[k]);
    }
    return largest;
  }
  void store(std::span<const Texel> texels, std::span<const PrefixSum> at_horizon) const {
    for (std::size_t k = 0; k < texels.size(); ++k) {
      const Texel& t = texels[k];
      const Flux value = tree_.mean() * smooth(k) + at_horizon[k].value;
      *map_.out.texel(t.face, t.i, t.j) = Colour(glm::max(Flux(0), value));
      map_.bounds[index_of(map_.out, t)] = std::nextafter(float(bounds_[k]), std::numeric_limits<float>::infinity());
    }
  }

  const Tree& tree_;
  const PrefixSums* prefix_sums_;
  const TreecodeLobe& lobe_;
  double max_error_, most_sine_;
  const TargetTexels& map_;
  Traversal traversal_;
  Flux from_min_radiance_;  // The part of every result that the least radiance adds.
  TileSums sums_{};
  std::array<double, Tile::most> bounds_{};
  std::array<double, channels> guess_{};
  float limit_;
};

}  // namespace

double tile_sine(const LobeFormula& lobe, double max_error) {
  // The error of nodes at the horizon is p t^2 times the slope of the lobe there, of a sum of about that slope / ((p +
  // 1) (p + 2)). So they must be small, and a tile sees as many of them as it is wide.
  if (const auto* sheen = std::get_if<Charlie>(&lobe)) {
    const double p = sheen->power;
    return std::min(0.12, 0.5 * portable::cbrt(max_error / (p * (p + 1) * (p + 2))));
  }
  return std::visit([](const auto& l) { return std::min(0.12, 0.5 * std::sqrt(2 * l.width())); }, lobe);
}

double nodes_of_output(const LobeFormula& lobe, double max_error) {
  const double finer = std::sqrt(1e-3 / max_error);
  if (const auto* sheen = std::get_if<Charlie>(&lobe)) return 300 * (1 + sheen->power * sheen->power) * finer;
  return 100 / std::visit([](const auto& l) { return l.width(); }, lobe) * finer;
}

void treecode_map(const Tree& tree, const PrefixSums* prefix_sums, const TreecodeLobe& lobe, double max_error,
                  const TargetTexels& map) {
  if (!lobe.has_rest()) return prefix_sums_map(*prefix_sums, lobe.horizon_terms, max_error, tree.mean(), map);
  const int width = map.out.width(), height = map.out.height();
  for_each_row(map.out.faces(), (height + tile_side - 1) / tile_side, map.progress, [&](int face, int row) {
    const int y = row * tile_side, h = std::min(tile_side, height - y);
    bool any = false;
    for (int j = y; j < y + h; ++j) any = any || map.wants(face, j);
    if (!any) return;
    TileRow tiles(tree, prefix_sums, lobe, max_error, map);
    for (int x = 0; x < width; x += tile_side) {
      tiles.fill(face, x, y, std::min(tile_side, width - x), h);
      tree.source().trim();
    }
  });
}

}  // namespace envmap::prefiltering

#include "envmap/prefilter/treecode/treecode.h"

#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "envmap/base/parallel.h"
#include "envmap/operate/measure.h"
#include "envmap/prefilter/cell_moments.h"
#include "envmap/prefilter/error_floor.h"
#include "envmap/prefilter/treecode/treecode_kernels.h"
#include "envmap/prefilter/work_counters.h"

namespace envmap::prefiltering {
namespace {

constexpr int tile_side = 8;

// What is asked of the nodes of a tile.
struct Criterion {
  std::array<float, channels> weight;  // 1 over what a direction gets, about.
  float limit;                         // What a node may be off, relative to that.
  std::size_t most_nodes;              // More are of no use.
};

// Goes down a tree to nodes that are good enough for all directions of a tile.
class Traversal {
 public:
  explicit Traversal(const Tree& tree, const TreecodeLobe& lobe) : tree_(tree), lobe_(lobe) {}

  // @return false where there are too many nodes.
  bool run(const Tile& tile, const Criterion& criterion) {
    tile_ = &tile, criterion_ = criterion;
    nodes_.clear(), own_.clear(), bound_ = {}, judged_ = 0;
    next_.clear();
    const Tree::Blocks& top = tree_.blocks(tree_.last());
    for (int face = 0; face < top.faces; ++face) next_.push_back({face, 0, 0});
    // The top of a face is judged as the first of four blocks.
    for (int k = tree_.last(); k >= tree_.first() && !next_.empty() && !enough(); --k) judge_level(k);
    if (!enough()) visit_source(tree_.source().projection(), [&](auto p) { open_blocks<decltype(p)>(); });
    count(Work::judged, judged_);
    return !enough();
  }
  [[nodiscard]] const NodeSums& nodes() const { return nodes_; }
  // What they are off together, at most.
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
  static constexpr int deepest = 16;  // Of halvings of a texel.

  [[nodiscard]] bool enough() const {
    return nodes_.count() > criterion_.most_nodes || judged_ > 4 * criterion_.most_nodes;  // Twice as many as usual.
  }

  [[nodiscard]] bool good(const NodeGroup& group, std::size_t lane) const {
    float flux = 0;
    for (std::size_t c = 0; c < channels; ++c) flux = std::max(flux, group.flux[c][lane] * criterion_.weight[c]);
    return judgement_.bound[lane] * flux <= criterion_.limit;
  }
  void accept(const TreeNode& node, std::size_t lane) {
    nodes_.of(judgement_.form[lane]).push_back({&node, judgement_.even[lane], judgement_.line[lane]});
    for (std::size_t c = 0; c < channels; ++c) bound_[c] += double(judgement_.bound[lane]) * node.flux[c];
  }

  // Blocks of level k by fours: `next_` names the fours, and then the fours of the next level, or blocks to be opened.
  void judge_level(int k) {
    const Tree::Blocks& blocks = tree_.blocks(k);
    std::swap(now_, next_), next_.clear();
    for (std::size_t from = 0; from < now_.size() && !enough(); from += 4) {
      const std::size_t many = std::min<std::size_t>(4, now_.size() - from);
      for (std::size_t q = 0; q < 4; ++q)
        put(q < many ? blocks.quad(now_[from + q].face, now_[from + q].i, now_[from + q].j) : NodeQuad{}, q);
      judge(lobe_, *tile_, group_, judgement_);
      judged_ += 4 * many;
      for (std::size_t lane = 0; lane < 4 * many; ++lane) {
        if (!(judgement_.visible >> lane & 1)) continue;
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

  // Texels of the lowest blocks that are not good enough, and their quarters, and so on.
  template <class P>
  void open_blocks() {
    const Level& source = tree_.source();
    const int side = 1 << tree_.first();
    parts_.clear();
    for (const Block& b : next_)
      for (int j = b.j * side; j < std::min(source.height(), (b.j + 1) * side); ++j)
        for (int i = b.i * side; i < std::min(source.width(), (b.i + 1) * side); ++i)
          if (const Flux light = tree_.beyond(*source.texel(b.face, i, j)); light != Flux(0)) {
            const Part texel{b.face, 0, texel_rect(i, j, source.width(), source.height()), {light.x, light.y, light.z}};
            if (side == 1)  // A block of one texel was judged as such.
              divide(texel);
            else
              parts_.push_back(texel);
          }
    while (!parts_.empty() && !enough()) {
      std::swap(parts_, open_), parts_.clear();
      for (std::size_t from = 0; from < open_.size() && !enough(); from += 16)
        judge_parts<P>(std::span(open_).subspan(from, std::min<std::size_t>(16, open_.size() - from)));
    }
  }
  template <class P>
  void judge_parts(std::span<const Part> parts) {
    group_ = {};
    std::array<const TreeNode*, 16> made;
    for (std::size_t lane = 0; lane < parts.size(); ++lane) {
      made[lane] = &own_.emplace_back(node_of(patch_of<P>(parts[lane].face, parts[lane].rect), parts[lane].radiance));
      group_.set(lane, *made[lane]);
    }
    judge(lobe_, *tile_, group_, judgement_);
    judged_ += parts.size();
    for (std::size_t lane = 0; lane < parts.size(); ++lane) {
      const Part& part = parts[lane];
      if (!(judgement_.visible >> lane & 1)) continue;
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
  std::deque<TreeNode> own_;  // Of texels and their parts.
  std::array<double, channels> bound_{};
  std::uint64_t judged_ = 0;
  std::vector<Block> now_, next_;
  std::vector<Part> parts_, open_;
  NodeGroup group_{};
  Judged judgement_{};
};

// Makes the tiles of a row, from left to right.
class TileRow {
 public:
  TileRow(const Tree& tree, const Hinges* hinges, const TreecodeLobe& lobe, double max_error, const Making& map)
      : tree_(tree),
        hinges_(hinges),
        lobe_(lobe),
        max_error_(max_error),
        most_sine_(tile_sine(lobe.lobe, max_error)),
        map_(map),
        traversal_(tree, lobe),
        even_((1 - lobe.hinges.integral()) * tree.darkest()) {
    // Of the first tile of a row, as good as any.
    for (int c = 0; c < 3; ++c) guess_[std::size_t(c)] = std::max(tree.darkest()[c], 0.3);
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
  // @return false, and the texels of the tile are not set, where they would take too many nodes in all tries together.
  bool set(const Tile& tile, std::span<const Direction> directions, std::span<const Texel> texels) {
    constexpr int most_tries = 8;
    std::array<HingeSum, Tile::most> at_horizon{};
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
      count(Work::seen, traversal_.nodes().count() * tile.count);
      if (lobe_.has_hinges() && !std::exchange(has_horizon, true)) set_horizon(directions, at_horizon);
      const Figures figures = bound(tile.count, at_horizon);
      const double figure = figures.all;
      // Of what is left to the nodes. The error of all falls about as that of each to the power of two thirds.
      const double off = std::max(1e-3, (figure - figures.horizon) / (max_error_ - figures.horizon));
      if (figure <= max_error_) {
        limit_ *= float(std::clamp(portable::pow(0.85 / off, 1.5), 0.3, 2.0));
        store(texels, at_horizon);
        return true;
      }
      // What is left is rounding, or the horizon's.
      if (!(figure <= 0.95 * before) || figures.horizon > 0.8 * max_error_) return give_up();
      before = figure, limit_ *= float(std::clamp(portable::pow(0.8 / off, 1.5), 1e-3, 0.8));
    }
    return give_up();
  }

  // Nodes beyond which the exact sum of so many directions is quicker.
  [[nodiscard]] std::size_t most_nodes(std::size_t directions) const {
    const Level& s = tree_.source();
    return std::clamp<std::size_t>(directions * index_of(s, {s.faces(), 0, 0}) / 4, 1 << 15, 1 << 17);
  }
  [[nodiscard]] Criterion criterion(std::size_t most_nodes) const {
    Criterion c{.weight = {}, .limit = limit_, .most_nodes = most_nodes};
    for (std::size_t k = 0; k < channels; ++k) c.weight[k] = float(1 / std::max(floor_of_mean, guess_[k]));
    return c;
  }

  void set_horizon(std::span<const Direction> directions, std::span<HingeSum> out) const {
    std::array<Flux, Tile::most> beside;
    for (std::size_t k = 0; k < directions.size(); ++k) beside[k] = tree_.mean() * smooth(k);
    hinges_->sums(lobe_.hinges, directions, 0.3 * max_error_, std::span(beside).first(directions.size()), out);
  }
  [[nodiscard]] Flux smooth(std::size_t k) const { return Flux(sums_[0][k], sums_[1][k], sums_[2][k]) + even_; }

  struct Figures {
    double all = 0, horizon = 0;  // The largest bound of a texel, and of what is summed at the horizon.
  };
  // Sets the bound of each texel, and the guess for the next try or tile.
  Figures bound(std::size_t count, std::span<const HingeSum> at_horizon) {
    constexpr double rounding = 0x1p-22;  // Of the result and of what is taken off the source.
    Figures largest;
    guess_.fill(std::numeric_limits<double>::max());
    for (std::size_t k = 0; k < count; ++k) {
      const Flux sum = smooth(k) + at_horizon[k].value / tree_.mean();
      double worst = 0;
      for (int c = 0; c < 3; ++c) {
        const auto ch = std::size_t(c);
        const double horizon = at_horizon[k].bound[c] / tree_.mean(), off = traversal_.bound()[ch] + horizon;
        const double least = std::max(sum[c] - off, floor_of_mean);
        if (!std::isfinite(off)) worst = std::numeric_limits<double>::infinity();
        worst = std::max(worst, off / least), largest.horizon = std::max(largest.horizon, horizon / least);
        guess_[ch] = std::min(guess_[ch], std::max(least, 0.5 * sum[c]));
      }
      if (!std::isfinite(sum.x + sum.y + sum.z)) worst = std::numeric_limits<double>::infinity();
      bounds_[k] = worst + rounding, largest.all = std::max(largest.all, bounds_[k]);
    }
    return largest;
  }
  void store(std::span<const Texel> texels, std::span<const HingeSum> at_horizon) const {
    for (std::size_t k = 0; k < texels.size(); ++k) {
      const Texel& t = texels[k];
      const Flux value = tree_.mean() * smooth(k) + at_horizon[k].value;
      *map_.out.texel(t.face, t.i, t.j) = Colour(glm::max(Flux(0), value));
      map_.bounds[index_of(map_.out, t)] = std::nextafter(float(bounds_[k]), std::numeric_limits<float>::infinity());
    }
  }

  const Tree& tree_;
  const Hinges* hinges_;
  const TreecodeLobe& lobe_;
  double max_error_, most_sine_;
  const Making& map_;
  Traversal traversal_;
  Flux even_;  // What the darkest texel adds to every result.
  TileSums sums_{};
  std::array<double, Tile::most> bounds_{};
  std::array<double, channels> guess_{};
  float limit_;
};

}  // namespace

double tile_sine(const Lobe& lobe, double max_error) {
  // Nodes at the horizon are off by p t^2 times the first slope of the lobe, of a sum that is that slope / ((p + 1)
  // (p + 2)): they must be small, and a tile sees as many of them as it is wide.
  if (const auto* sheen = std::get_if<Charlie>(&lobe)) {
    const double p = sheen->power;
    return std::min(0.12, 0.5 * portable::cbrt(max_error / (p * (p + 1) * (p + 2))));
  }
  return std::visit([](const auto& l) { return std::min(0.12, 0.5 * std::sqrt(2 * l.width())); }, lobe);
}

double nodes_of_output(const Lobe& lobe, double max_error) {
  const double finer = std::sqrt(1e-3 / max_error);
  if (const auto* sheen = std::get_if<Charlie>(&lobe)) return 300 * (1 + sheen->power * sheen->power) * finer;
  return 100 / std::visit([](const auto& l) { return l.width(); }, lobe) * finer;
}

void treecode_map(const Tree& tree, const Hinges* hinges, const TreecodeLobe& lobe, double max_error,
                  const Making& map) {
  if (!lobe.has_rest()) return hinge_map(*hinges, lobe.hinges, max_error, tree.mean(), map);
  const int width = map.out.width(), height = map.out.height();
  for_each_row(map.out.faces(), (height + tile_side - 1) / tile_side, map.progress, [&](int face, int row) {
    const int y = row * tile_side, h = std::min(tile_side, height - y);
    bool any = false;
    for (int j = y; j < y + h; ++j) any = any || map.wants(face, j);
    if (!any) return;
    TileRow tiles(tree, hinges, lobe, max_error, map);
    for (int x = 0; x < width; x += tile_side)
      tiles.fill(face, x, y, std::min(tile_side, width - x), h), tree.source().trim();
  });
}

}  // namespace envmap::prefiltering

/// @file
/// Below the stored nodes: the texels of a block, and their parts, made and judged as a tile asks for them.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "envmap/prefilter/border.h"
#include "envmap/prefilter/clip.h"
#include "envmap/prefilter/tree.h"

namespace envmap::prefiltering {

/// @tparam P the projection of the source. @tparam Add is called with each node that is good enough.
template <class P, class Add>
class Subdivision {
 public:
  Subdivision(const Tree& tree, const Lobe& lobe, Criterion& criterion, Traversal& found, Add& add)
      : tree_(tree), lobe_(lobe), criterion_(criterion), found_(found), add_(add), clips_(clips(lobe, criterion)) {}

  void open(const OpenBlock& block) {
    const Level& source = tree_.source();
    const int side = 1 << tree_.first(), left = block.i * side, top = block.j * side;
    open(block.face, {left, top, std::min(source.width(), left + side), std::min(source.height(), top + side)});
  }

 private:
  static constexpr int deepest = 24;  // Of halvings of a texel.

  // Of one texel, evenly lit.
  struct Texel {
    int face;
    Flux radiance;
    double error = 0;   // Of all its parts: they are lit alike and lie in one place, and may all be wrong the same way.
    bool bent = false;  // See Judged.
  };

  // The lobe, where pieces are clipped: for a single direction.
  static const Phong* clips(const Lobe& lobe, const Criterion& criterion) {
    const Phong* phong = std::get_if<Phong>(&lobe);
    return phong && phong->breaks_off() && criterion.radius == 0 && !criterion.surveying ? phong : nullptr;
  }

  bool enough() const { return found_.count > criterion_.max_nodes; }

  // Four smaller blocks, or the texels.
  void open(int face, const Span& in) {
    const std::optional<std::array<Node, 4>> nodes = tree_.quarters(face, in);
    if (!nodes) return texels(face, in);
    judge_all(
        *nodes,
        [&](std::size_t k) {
          open(face, in.quarters()[k]);
          return true;
        },
        [&](float error, bool bent) { found_.add_error(error, bent); });
  }
  void texels(int face, const Span& in) {
    const Level& source = tree_.source();
    Cells cells;
    for (int j = in.top; j < in.bottom; ++j)
      for (int i = in.left; i < in.right; ++i) {
        const Rect rect = texel_rect(i, j, source.width(), source.height());
        const Flux radiance = tree_.beyond(*source.texel(face, i, j));
        if (radiance == Flux(0)) continue;
        if (Texel lit{face, radiance}; clip(lit, rect))
          found_.add_error(lit.error, lit.bent);
        else if (const std::optional<Moments> area = small_cell<P>(face, rect))
          cells.add(rect, node_of(*area, radiance), radiance);
        else
          texel({face, radiance}, rect);
        if (cells.count == cells.nodes.size()) judge_texels(face, cells);
      }
    judge_texels(face, cells);
  }

  // Up to sixteen texels, judged at once.
  struct Cells {
    std::size_t count = 0;
    std::array<Rect, 16> rects;
    std::array<Node, 16> nodes;
    std::array<Flux, 16> radiance;
    void add(const Rect& rect, const Node& node, const Flux& light) {
      rects[count] = rect, nodes[count] = node, radiance[count++] = light;
    }
  };
  void judge_texels(int face, Cells& cells) {
    if (cells.count == 0) return;
    judge_all(
        std::span(cells.nodes).first(cells.count),
        [&](std::size_t k) {
          Texel part{face, cells.radiance[k]};
          if (!go_round(part, cells.rects[k], cells.nodes[k])) cut(part, cells.rects[k], 0);
          found_.add_error(part.error, part.bent);
          return true;
        },
        [&](float error, bool bent) { found_.add_error(error, bent); });
    cells.count = 0;
  }
  void texel(Texel part, const Rect& rect) {
    cut(part, rect, 0);
    found_.add_error(part.error, part.bent);
  }
  // Adds a piece as what the horizon leaves of it. @return false where that is not good enough.
  bool clip(Texel& texel, const Rect& rect) {
    if (!clips_) return false;
    const ClippedMean mean = clipped_mean(*clips_, flat_piece<P>(criterion_.middle, texel.face, rect));
    const double whole = P::solid_angle(rect), off = whole * mean.error * weight(texel.radiance);
    if (!(off <= criterion_.limit)) return false;
    texel.bent = true;
    add(texel, whole * mean.value, off);
    return true;
  }
  // Adds a piece of which the lobe is but a small part: round its border. @return false where there is more of it.
  bool go_round(Texel& texel, const Rect& rect, const Node& node) {
    if (criterion_.radius > 0) return false;
    return std::visit([&](const auto& lobe) { return go_round(lobe, texel, rect, node); }, lobe_);
  }
  template <class L>
  bool go_round(const L& lobe, Texel& texel, const Rect& rect, const Node& node) {
    constexpr double worth = 2;  // e-folds of the lobe over half a piece, from which cutting takes longer.
    const double d = glm::length(criterion_.middle - node.centre), near = std::max(0.0, d - node.reach),
                 far = d + node.reach;
    const double nearest = 0.5 * near * near, farthest = 0.5 * far * far;
    if (farthest >= 1 || std::max(lobe.rate(nearest), lobe.rate(farthest)) * far * node.reach < worth) return false;
    const double each = weight(texel.radiance);
    const Integral found = integral_round(recent_border<P>(texel.face, rect), lobe, criterion_.middle, texel.face, rect,
                                          P::solid_angle(rect), node.reach, nearest, 0.1 * criterion_.limit / each);
    if (criterion_.surveying) {
      const Flux& l = texel.radiance;
      found_.add_least(criterion_, {float(l.x), float(l.y), float(l.z)},
                       float(std::max(0.0, found.value - found.error)));
    } else {
      add(texel, found.value, found.error * each);
    }
    return true;
  }
  // What a part of the lobe counts for, in such light.
  [[nodiscard]] double weight(const Flux& radiance) const {
    double most = 0;
    for (int c = 0; c < 3; ++c) most = std::max(most, radiance[c] * criterion_.most[std::size_t(c)]);
    return most;
  }
  // A piece as its integral.
  void add(Texel& texel, double integral, double off) {
    ++found_.count;
    texel.error += off;
    for (int c = 0; c < 3; ++c) found_.integrated[std::size_t(c)] += integral * texel.radiance[c];
  }
  // What is too large for simple moments is cut without a look at it.
  void cut(Texel& texel, const Rect& rect, int depth) {
    if (enough()) return;
    const std::array<Rect, 4> parts = quarters(rect);
    const bool last = depth + 1 >= deepest;
    std::array<Node, 4> nodes;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const std::optional<Moments> area = small_cell<P>(texel.face, parts[k], last);
      if (!area) {
        for (const Rect& part : parts)
          if (!clip(texel, part)) cut(texel, part, depth + 1);
        return;
      }
      nodes[k] = node_of(*area, texel.radiance);
    }
    judge_all(
        nodes,
        [&](std::size_t k) {
          if (clip(texel, parts[k]) || go_round(texel, parts[k], nodes[k])) return true;
          if (!last) cut(texel, parts[k], depth + 1);
          return !last;
        },
        [&](float error, bool bent) { texel.error += error, texel.bent |= bent; });
  }

  // Of nodes that are not good enough worse(k) says whether it did something about them.
  template <class Worse, class AddError>
  void judge_all(std::span<const Node> nodes, Worse&& worse, AddError&& add_error) {
    NodeGroup group = NodeGroup::none();
    for (std::size_t k = 0; k < nodes.size(); ++k) group.set(k, nodes[k], criterion_.middle);
    const Judged v = judge(lobe_, criterion_, group, nodes.size());
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (!(v.visible >> k & 1) || (!(v.good >> k & 1) && worse(k))) continue;
      if (criterion_.surveying) {
        found_.add_least(criterion_, nodes[k].flux, v.least[k]);
      } else {
        if (is_uneven(v, k, criterion_) && (add_channels(lobe_, criterion_, nodes[k], found_) || worse(k))) continue;
        ++found_.count;
        add_error(v.error[k], v.bent >> k & 1);
        found_.uneven += v.uneven[k];
        if (v.crossed >> k & 1) found_.add_crossed(nodes[k], criterion_.middle, v.error[k]);
        add_(nodes[k]);
      }
    }
  }

  const Tree& tree_;
  const Lobe& lobe_;
  Criterion& criterion_;
  Traversal& found_;
  Add& add_;
  const Phong* clips_;
};

}  // namespace envmap::prefiltering

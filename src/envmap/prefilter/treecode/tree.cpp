// Builds the quadtree from its lowest blocks up, parts of the map in parallel. Moments of texels are shared along rows
// of latlong maps and by the faces of cubes.
#include "envmap/prefilter/treecode/tree.h"

#include <algorithm>
#include <utility>

#include "envmap/base/parallel.h"
#include "envmap/prefilter/cell_moments.h"

namespace envmap::prefiltering {

namespace {

// The most blocks of the lowest level. A block takes 230 bytes, 310 with its part of all levels above: 40 MB in all, or
// a little more than a large source itself.
std::int64_t most_stored(std::int64_t texels) { return std::clamp<std::int64_t>(texels / 16, 1 << 17, 1 << 19); }

int halves(int n) { return (n + 1) / 2; }

// The moments of texels. All blocks of a row of a latlong map share them but for a rotation about the poles, and so do
// all faces of a cube: they are kept in the frame of the map's west border, or of face 0.
class TexelPatches {
 public:
  TexelPatches(const Level& source, int side) : source_(source), side_(side) {
    if (source.projection() != Projection::latlong) return;
    rows_.resize(std::size_t(source.height() * side));
    parallel_for(source.height(), [&](int j) {
      for (int i = 0; i < side; ++i) rows_[std::size_t(j * side + i)] = patch(i, j);
    });
  }
  // Texel (i, j), i counted from the left of its block.
  [[nodiscard]] Patch at(int left, int i, int j) const {
    return rows_.empty() ? patch(left + i, j) : rows_[std::size_t(j * side_ + i)];
  }
  // The rotation from the frame of at() to that of the map.
  [[nodiscard]] Rotation frame(int face, int left) const {
    if (rows_.empty()) {
      const auto axes = [](int f) {
        const Cube::Axes& a = Cube::axes[std::size_t(f)];
        return Rotation(a.right, a.up, a.forward);
      };
      return axes(face) * glm::transpose(axes(0));
    }
    const double over_pi = 2.0 * left / source_.width(), c = portable::cos_pi(over_pi), s = portable::sin_pi(over_pi);
    return {{c, 0, s}, {0, 1, 0}, {-s, 0, c}};
  }

 private:
  [[nodiscard]] Patch patch(int i, int j) const {
    return visit_source(source_.projection(), [&](auto p) {
      return patch_of<decltype(p)>(0, texel_rect(i, j, source_.width(), source_.height()));
    });
  }
  const Level& source_;
  int side_;
  std::vector<Patch> rows_;
};

// Builds the levels of a tree from its lowest blocks up, depth first, so that the moments of few blocks are kept at
// once.
class Builder {
 public:
  using Faces = std::array<Light, 6>;

  Builder(const Tree& tree, std::vector<Tree::Blocks>& levels, const ChannelWeights& weights)
      : tree_(tree), levels_(levels), weights_(weights), side_(1 << tree.first()), patches_(tree.source(), side_) {}

  // Sets block (i, j) of a level and all blocks in it, on all faces. @return its light on each face.
  Faces build(std::size_t level, int i, int j) {
    if (level == 0) return store(level, i, j, lowest(i, j));
    return unite(level, i, j, [&](int x, int y) { return build(level - 1, x, y); });
  }
  // Sets a block from its parts, part(x, y).
  template <class Part>
  Faces unite(std::size_t level, int i, int j, Part&& part) {
    const Tree::Blocks& fine = levels_[level - 1];
    std::array<Faces, 4> parts;
    std::size_t count = 0;
    for (int y = 2 * j; y < std::min(fine.height, 2 * j + 2); ++y)
      for (int x = 2 * i; x < std::min(fine.width, 2 * i + 2); ++x) parts[count++] = part(x, y);
    Faces whole{};
    for (int face = 0; face < faces(); ++face) {
      Light& light = whole[std::size_t(face)];
      for (std::size_t k = 0; k < count; ++k) add(parts[k][std::size_t(face)], light);
      set_centre(light, weights_);
      for (std::size_t k = 0; k < count; ++k) reach_to(parts[k][std::size_t(face)], light);
    }
    return store(level, i, j, std::move(whole));
  }

 private:
  [[nodiscard]] int faces() const { return tree_.source().faces(); }

  static void add(const Light& part, Light& whole) {
    for (std::size_t c = 0; c < channels; ++c)
      for (std::size_t k = 0; k < part.moments[c].size(); ++k) whole.moments[c][k] += part.moments[c][k];
  }
  static void reach_to(const Light& part, Light& whole) {
    if (part.lit())
      whole.bounding_radius =
          std::max(whole.bounding_radius, glm::length(part.centre - whole.centre) + part.bounding_radius);
  }

  // A block of texels: the sum of their moments, each times its radiance.
  Faces lowest(int i, int j) {
    const Level& source = tree_.source();
    const int left = i * side_, top = j * side_;
    const int right = std::min(source.width(), left + side_), bottom = std::min(source.height(), top + side_);
    thread_local std::vector<Patch> patches;
    patches.clear();
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) patches.push_back(patches_.at(left, x - left, y));
    Faces whole{};
    for (int face = 0; face < faces(); ++face) {
      Light& light = whole[std::size_t(face)];
      const Patch* patch = patches.data();
      for (int y = top; y < bottom; ++y) {
        std::array<Moments3, channels> row{};
        for (int x = left; x < right; ++x, ++patch) {
          const Flux radiance = tree_.excess(*source.texel(face, x, y));
          for (std::size_t c = 0; c < channels; ++c)
            for (std::size_t k = 0; k < row[c].size(); ++k) row[c][k] += radiance[int(c)] * patch->moments[k];
        }
        for (std::size_t c = 0; c < channels; ++c)
          for (std::size_t k = 0; k < row[c].size(); ++k) light.moments[c][k] += row[c][k];
      }
      set_centre(light, weights_);
      patch = patches.data();
      for (int y = top; y < bottom; ++y)
        for (int x = left; x < right; ++x, ++patch)
          if (tree_.excess(*source.texel(face, x, y)) != Flux(0))
            light.bounding_radius =
                std::max(light.bounding_radius, glm::length(patch->centre - light.centre) + patch->bounding_radius);
      const Rotation frame = patches_.frame(face, left);
      for (Moments3& m : light.moments)
        if (m[0] > 0) m = turned(m, frame);
      light.centre = frame * light.centre;
    }
    source.trim();
    return whole;
  }

  Faces store(std::size_t level, int i, int j, Faces&& whole) {
    for (int face = 0; face < faces(); ++face)
      if (const Light& light = whole[std::size_t(face)]; light.lit()) levels_[level].set(face, i, j, finished(light));
    return std::move(whole);
  }

  const Tree& tree_;
  std::vector<Tree::Blocks>& levels_;
  const ChannelWeights& weights_;
  int side_;
  TexelPatches patches_;
};

// 1 over the excess of each channel. @param flux of the source.
ChannelWeights weights_of(const Flux& flux, const Tree& tree) {
  const Flux mean = flux / (4 * pi);
  ChannelWeights weights{};
  for (int c = 0; c < 3; ++c) {
    const double excess = tree.mean() > 0 ? mean[c] / tree.mean() - tree.min_radiance()[c] : 0;
    weights[std::size_t(c)] = excess > 1e-12 ? 1 / excess : 0;
  }
  return weights;
}

}  // namespace

Tree::Blocks::Blocks(int of_faces, int across, int down)
    : faces(of_faces),
      width(across),
      height(down),
      nodes(std::make_unique<TreeNode[]>(place(across, down, of_faces, 0))),
      quads(std::make_unique<NodeQuad[]>(place(halves(across), halves(down), of_faces, 0))) {}

void Tree::Blocks::set(int face, int i, int j, const TreeNode& node) {
  nodes[place(width, height, face, j) + std::size_t(i)] = node;
  quads[place(halves(width), halves(height), face, j / 2) + std::size_t(i / 2)].set(std::size_t(2 * (j % 2) + i % 2),
                                                                                    node);
}

Tree::Tree(const Level& source, double mean, const Flux& flux, const Colour& min_radiance)
    : source_(source), mean_(mean), min_radiance_(mean > 0 ? Flux(min_radiance) / mean : Flux(0)) {
  const int faces = source.faces();
  const auto stored = [&] { return std::int64_t(faces) * (source.width() >> first_) * (source.height() >> first_); };
  for (const std::int64_t most = most_stored(stored()); stored() > most;) ++first_;
  const int side = 1 << first_;
  for (int w = (source.width() + side - 1) / side, h = (source.height() + side - 1) / side;;
       w = halves(w), h = halves(h)) {
    blocks_.emplace_back(faces, w, h);
    if (w == 1 && h == 1) break;
  }
  const ChannelWeights weights = weights_of(flux, *this);
  Builder builder(*this, blocks_, weights);
  // Some hundred parts in parallel, and the few blocks above them one by one.
  std::size_t level = 0;
  while (level + 1 < blocks_.size() && blocks_[level].width * blocks_[level].height > 512) ++level;
  const auto count = [&](std::size_t k) { return std::size_t(blocks_[k].width * blocks_[k].height); };
  std::vector<Builder::Faces> parts(count(level));
  parallel_for(int(parts.size()), [&](int k) {
    parts[std::size_t(k)] = builder.build(level, k % blocks_[level].width, k / blocks_[level].width);
  });
  for (; level + 1 < blocks_.size(); ++level) {
    const int across = blocks_[level + 1].width;
    std::vector<Builder::Faces> whole(count(level + 1));
    for (std::size_t k = 0; k < whole.size(); ++k)
      whole[k] = builder.unite(level + 1, int(k) % across, int(k) / across,
                               [&](int x, int y) { return parts[std::size_t(y * blocks_[level].width + x)]; });
    parts = std::move(whole);
  }
}

}  // namespace envmap::prefiltering

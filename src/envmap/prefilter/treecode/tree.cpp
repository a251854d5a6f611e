#include "envmap/prefilter/treecode/tree.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "envmap/base/parallel.h"
#include "envmap/operate/measure.h"
#include "envmap/prefilter/cell_moments.h"

namespace envmap::prefiltering {

Colour darkest_of(const Level& source) {
  Colour least(std::numeric_limits<float>::max());
  for (const Colour& row : map_rows<Colour>(source.height(), [&](int j) {
         Colour c(std::numeric_limits<float>::max());
         for (int face = 0; face < source.faces(); ++face)
           for (const Colour& texel : source.row(face, j)) c = glm::min(c, texel);
         source.trim();
         return c;
       }))
    least = glm::min(least, row);
  return least;
}

namespace {

// Blocks of the lowest level, 230 bytes each, 310 with all above: 40 MB, or a little more than a large source itself
// takes.
std::int64_t most_stored(std::int64_t texels) { return std::clamp<std::int64_t>(texels / 16, 1 << 17, 1 << 19); }

int halves(int n) { return (n + 1) / 2; }

// The moments of texels, which all blocks of a row of a latlong map share but for a turn about the poles, and all faces
// of a cube: in the frame of the map's west border, or of face 0.
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
  // From the frame of at() to that of the map.
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

// Builds the levels of a tree from its lowest blocks up, each part of it depth first, so that the moments of few blocks
// are kept at once.
class Builder {
 public:
  using Faces = std::array<Light, 6>;

  Builder(const Tree& tree, std::vector<Tree::Blocks>& levels, const ChannelWeights& weights)
      : tree_(tree), levels_(levels), weights_(weights), side_(1 << tree.first()), patches_(tree.source(), side_) {}

  // Sets block (i, j) of a level, on all faces, and all below it. @return its light, of each face.
  Faces build(std::size_t level, int i, int j) {
    if (level == 0) return store(level, i, j, lowest(i, j));
    return unite(level, i, j, [&](int x, int y) { return build(level - 1, x, y); });
  }
  // The same of a block whose parts are made: part(x, y).
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
    if (part.lit()) whole.reach = std::max(whole.reach, glm::length(part.centre - whole.centre) + part.reach);
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
          const Flux radiance = tree_.beyond(*source.texel(face, x, y));
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
          if (tree_.beyond(*source.texel(face, x, y)) != Flux(0))
            light.reach = std::max(light.reach, glm::length(patch->centre - light.centre) + patch->reach);
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

// 1 over the flux of each channel.
ChannelWeights weights_of(const Level& source, const Tree& tree) {
  const Flux mean = totals(source).flux / (4 * pi);
  ChannelWeights weights{};
  for (int c = 0; c < 3; ++c) {
    const double beyond = tree.mean() > 0 ? mean[c] / tree.mean() - tree.darkest()[c] : 0;
    weights[std::size_t(c)] = beyond > 1e-12 ? 1 / beyond : 0;
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

Tree::Tree(const Level& source, double mean) : source_(source), mean_(mean), darkest_(0) {
  if (mean_ > 0) darkest_ = Flux(darkest_of(source)) / mean_;
  const int faces = source.faces();
  const auto stored = [&] { return std::int64_t(faces) * (source.width() >> first_) * (source.height() >> first_); };
  for (const std::int64_t most = most_stored(stored()); stored() > most;) ++first_;
  const int side = 1 << first_;
  for (int w = (source.width() + side - 1) / side, h = (source.height() + side - 1) / side;;
       w = halves(w), h = halves(h)) {
    blocks_.emplace_back(faces, w, h);
    if (w == 1 && h == 1) break;
  }
  const ChannelWeights weights = weights_of(source, *this);
  Builder builder(*this, blocks_, weights);
  // Some hundred parts at once, and what is above them one by one.
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

#include "envmap/prefilter/light_tree.h"

#include "envmap/operate/measure.h"
#include "envmap/operate/parallel.h"
#include "envmap/prefilter/cell.h"
#include "envmap/sample/target.h"

namespace envmap {
namespace {

constexpr std::int64_t most_stored = 1 << 19;  // Blocks of the lowest level: 100 MB with all above.

LightTree::Blocks empty(int width, int height, int faces) {
  return {width, height,
          std::vector<Light>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                             static_cast<std::size_t>(faces))};
}

int halves(int n) { return (n + 1) / 2; }

// f(face, i, j) -> Light for all blocks of a level.
template <class F>
void fill(LightTree::Blocks& blocks, int faces, F&& f) {
  for_each_row(faces, blocks.height, {}, [&](int face, int j) {
    for (int i = 0; i < blocks.width; ++i)
      blocks.lights[(static_cast<std::size_t>(face) * static_cast<std::size_t>(blocks.height) + static_cast<std::size_t>(j)) *
                        static_cast<std::size_t>(blocks.width) +
                    static_cast<std::size_t>(i)] = f(face, i, j);
  });
}

// Texels of a block: columns from left to right - 1, rows from top to bottom - 1.
struct Span {
  int left, top, right, bottom;
};

// Whether no rim cuts or stretches a rectangle.
template <class P>
bool is_plain(const Rect& r) {
  if (coverage<P>(r) != Coverage::inside) return false;
  if (!has_wedges<P>) return true;
  const double s = std::max(std::abs(2 * r.u0 - 1), std::abs(2 * r.u1 - 1));
  const double t = std::max(std::abs(2 * r.v0 - 1), std::abs(2 * r.v1 - 1));
  return s * s + t * t < 0.875;
}

// Texels by their middles; how each of a row spreads is taken from the one in its middle, which it is like.
template <class P>
Light plain_block(const Level& source, int face, const Span& in, double scale) {
  thread_local std::vector<Direction> directions;
  thread_local std::vector<Light> texels;
  texels.clear();
  const auto count = static_cast<std::size_t>(in.right - in.left);
  directions.resize(count);
  const double w = source.width(), h = source.height();
  for (int j = in.top; j < in.bottom; ++j) {
    texel_directions(source.projection(), source.height(), face, j, in.left, directions);
    const int middle = (in.left + in.right) / 2;
    const Patch one = patch<P>(face, Rect{middle / w, j / h, (middle + 1) / w, (j + 1) / h});
    const double density = one.solid_angle / P::density((middle + 0.5) / w, (j + 0.5) / h);
    const double inside = glm::length(one.centre);
    for (std::size_t k = 0; k < count; ++k) {
      Patch area = one;
      area.solid_angle = density * P::density((in.left + static_cast<int>(k) + 0.5) / w, (j + 0.5) / h);
      area.centre = inside * directions[k];
      texels.push_back(light_of(area, scale * Flux(*source.texel(face, in.left + static_cast<int>(k), j))));
    }
  }
  return united(texels);
}

}  // namespace

LightTree::LightTree(const Level& source) : source_(source), mean_(mean_radiance(source)) {
  const int width = source.width(), height = source.height(), faces = source.faces();
  while (static_cast<std::int64_t>(faces) * (width >> first_) * (height >> first_) > most_stored) ++first_;
  const int side = 1 << first_;
  const double scale = mean_ > 0 ? 1 / mean_ : 0;
  Blocks& lowest = blocks_.emplace_back(empty((width + side - 1) / side, (height + side - 1) / side, faces));
  visit(source.projection(), [&](auto p) {
    using P = decltype(p);
    fill(lowest, faces, [&](int face, int bi, int bj) {
      const double w = width, h = height;
      const Span in{bi * side, bj * side, std::min(width, (bi + 1) * side), std::min(height, (bj + 1) * side)};
      if (side > 1 && is_plain<P>({in.left / w, in.top / h, in.right / w, in.bottom / h}))
        return plain_block<P>(source, face, in, scale);
      thread_local std::vector<Light> texels;
      texels.clear();
      for (int j = in.top; j < in.bottom; ++j)
        for (int i = in.left; i < in.right; ++i) {
          const Patch area = patch<P>(face, Rect{i / w, j / h, (i + 1) / w, (j + 1) / h});
          if (area.solid_angle > 0) texels.push_back(light_of(area, scale * Flux(*source.texel(face, i, j))));
        }
      return united(texels);
    });
  });
  while (blocks_.back().width > 1 || blocks_.back().height > 1) {
    const Blocks& fine = blocks_.back();
    Blocks coarse = empty(halves(fine.width), halves(fine.height), faces);
    fill(coarse, faces, [&](int face, int i, int j) {
      std::array<Light, 4> parts;
      std::size_t count = 0;
      for (int y = 2 * j; y < std::min(fine.height, 2 * j + 2); ++y)
        for (int x = 2 * i; x < std::min(fine.width, 2 * i + 2); ++x) {
          const Light& part = light(last(), face, x, y);
          if (part.flux[3] > 0) parts[count++] = part;
        }
      return united(std::span(parts).first(count));
    });
    blocks_.push_back(std::move(coarse));
  }
}

}  // namespace envmap

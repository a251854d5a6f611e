#include "envmap/prefilter/light_tree.h"

#include <tuple>
#include <type_traits>

#include "envmap/operate/parallel.h"
#include "envmap/prefilter/cell.h"
#include "envmap/sample/target.h"

namespace envmap {
namespace {

constexpr std::int64_t most_stored = 1 << 17;  // Blocks of the lowest level: 25 MB with all above.

LightTree::Blocks empty(int width, int height, int faces) {
  return {width,
          height,
          std::vector<Light>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                             static_cast<std::size_t>(faces)),
          {}};
}

int halves(int n) { return (n + 1) / 2; }

// The unit of fluxes; texels of other than finite radiance were refused before.
double mean_of(const Level& source) {
  struct Row {
    Flux flux{0};
    double weight = 0;
  };
  Row all;
  for (const Row& row : map_rows<Row>(source.height(), [&](int j) {
         Row sum;
         std::vector<double> omega(static_cast<std::size_t>(source.width()));
         solid_angles(source.projection(), source.height(), j, omega);
         for (int face = 0; face < source.faces(); ++face) {
           const std::span<const Colour> texels = source.row(face, j);
           for (std::size_t k = 0; k < texels.size(); ++k) {
             sum.flux += omega[k] * Flux(texels[k]);
             sum.weight += omega[k];
           }
         }
         return sum;
       }))
    all.flux += row.flux, all.weight += row.weight;
  return all.weight > 0 ? (all.flux.x + all.flux.y + all.flux.z) / (3 * all.weight) : 0;
}

Rect rect_of(const Span& in, const Level& source) {
  const double w = source.width(), h = source.height();
  return {in.left / w, in.top / h, in.right / w, in.bottom / h};
}

// Whether no rim cuts or stretches a block of several texels.
template <class P>
bool is_plain(const Span& in, const Rect& r) {
  if (in.width() < 2 || in.height() < 2 || coverage<P>(r) != Coverage::inside) return false;
  if (!has_wedges<P>) return true;
  const double s = std::max(std::abs(2 * r.u0 - 1), std::abs(2 * r.u1 - 1));
  const double t = std::max(std::abs(2 * r.v0 - 1), std::abs(2 * r.v1 - 1));
  return s * s + t * t < 0.875;
}

// Directions of the texels of some rows, from a column on.
struct Strip {
  int left = 0, top = 0, width = 0;
  std::vector<Direction> directions;

  void set(const Level& source, int face, const Span& in) {
    left = in.left, top = in.top, width = in.width();
    directions.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(in.height()));
    for (int j = in.top; j < in.bottom; ++j)
      texel_directions(source.projection(), source.height(), face, j, left,
                       std::span(directions).subspan(index(left, j), static_cast<std::size_t>(width)));
  }
  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j - top) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i - left);
  }
  [[nodiscard]] const Direction& at(int i, int j) const { return directions[index(i, j)]; }
};

// A texel as a parallelogram between its neighbours: of sides a and b it has the covariance (a a^T + b b^T) / 12.
Patch parallelogram(const Direction& a, const Direction& b) {
  Patch p;
  p.covariance.add_square(a, 1.0 / 12);
  p.covariance.add_square(b, 1.0 / 12);
  p.spread = 0.31 * std::sqrt(glm::dot(a, a) + glm::dot(b, b));
  p.reach = 0.51 * std::max(glm::length(a + b), glm::length(a - b));
  return p;
}

// A block of texels that are all much alike: their moments about the block's middle at once.
template <class P>
Light plain_block(const Level& source, int face, const Span& in, const Strip& strip, double scale) {
  const double w = source.width(), h = source.height();
  thread_local std::vector<double> omega;
  omega.clear();
  double whole = 0;
  for (int j = in.top; j < in.bottom; ++j)
    for (int i = in.left; i < in.right; ++i) {
      const bool same = std::is_same_v<P, Latlong> && i > in.left;
      omega.push_back(same ? omega.back() : P::density((i + 0.5) / w, (j + 0.5) / h));
      whole += omega.back();
    }
  const double part = P::solid_angle(rect_of(in, source)) / whole;

  thread_local LightSum sum;
  sum.clear();
  const int middle = (in.left + in.right - 1) / 2;
  std::size_t k = 0;
  for (int j = in.top; j < in.bottom; ++j) {
    const int other = j + 1 < in.bottom ? j + 1 : j - 1;
    sum.start(parallelogram(strip.at(middle + 1, j) - strip.at(middle, j), strip.at(middle, other) - strip.at(middle, j)));
    for (int i = in.left; i < in.right; ++i, ++k)
      sum.add(strip.at(i, j), part * omega[k], scale * Flux(*source.texel(face, i, j)));
  }
  return sum.light();
}

template <class P>
Light rim_block(const Level& source, int face, const Span& in, double scale) {
  thread_local std::vector<Light> texels;
  texels.clear();
  for (int j = in.top; j < in.bottom; ++j)
    for (int i = in.left; i < in.right; ++i) {
      const Patch area = patch<P>(face, rect_of({i, j, i + 1, j + 1}, source));
      if (area.solid_angle > 0) texels.push_back(light_of(area, scale * Flux(*source.texel(face, i, j))));
    }
  return united(texels);
}

}  // namespace

std::optional<Light> LightTree::block(int face, const Span& in) const {
  return visit(source_.projection(), [&](auto p) -> std::optional<Light> {
    using P = decltype(p);
    if (!is_plain<P>(in, rect_of(in, source_))) return std::nullopt;
    thread_local Strip strip;
    strip.set(source_, face, in);
    return plain_block<P>(source_, face, in, strip, mean_ > 0 ? 1 / mean_ : 0);
  });
}

void LightTree::Blocks::set_quads(int faces) {
  const int across = halves(width), down = halves(height);
  quads.resize(static_cast<std::size_t>(faces) * static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
  for_each_row(faces, down, {}, [&](int face, int row) {
    Quad* to = &quads[static_cast<std::size_t>(face * down + row) * static_cast<std::size_t>(across)];
    for (int j = 2 * row; j < std::min(height, 2 * row + 2); ++j)
      for (int i = 0; i < width; ++i)
        if (const Light& one = light(face, i, j); one.flux[3] > 0)
          to[i / 2].set(static_cast<std::size_t>(2 * (j % 2) + i % 2), one);
  });
}

LightTree::LightTree(const Level& source) : source_(source), mean_(mean_of(source)) {
  const int width = source.width(), height = source.height(), faces = source.faces();
  while (static_cast<std::int64_t>(faces) * (width >> first_) * (height >> first_) > most_stored) ++first_;
  const int side = 1 << first_;
  const double scale = mean_ > 0 ? 1 / mean_ : 0;
  Blocks& lowest = blocks_.emplace_back(empty((width + side - 1) / side, (height + side - 1) / side, faces));
  visit(source.projection(), [&](auto p) {
    using P = decltype(p);
    for_each_row(faces, lowest.height, {}, [&](int face, int bj) {
      constexpr int at_once = 256;  // Texels of a row.
      const int top = bj * side, bottom = std::min(height, top + side);
      for (int start = 0; start < width; start += std::max(at_once, side)) {
        const int end = std::min(width, start + std::max(at_once, side));
        thread_local Strip strip;
        if (side > 1) strip.set(source, face, {start, top, end, bottom});
        for (int left = start; left < end; left += side) {
          const Span in{left, top, std::min(width, left + side), bottom};
          lowest.light(face, left / side, bj) = is_plain<P>(in, rect_of(in, source))
                                                    ? plain_block<P>(source, face, in, strip, scale)
                                                    : rim_block<P>(source, face, in, scale);
        }
      }
    });
  });
  lowest.set_quads(faces);
  while (blocks_.back().width > 1 || blocks_.back().height > 1) {
    const Blocks& fine = blocks_.back();
    Blocks coarse = empty(halves(fine.width), halves(fine.height), faces);
    for_each_row(faces, coarse.height, {}, [&](int face, int j) {
      for (int i = 0; i < coarse.width; ++i) {
        std::array<Light, 4> parts;
        std::size_t count = 0;
        for (int y = 2 * j; y < std::min(fine.height, 2 * j + 2); ++y)
          for (int x = 2 * i; x < std::min(fine.width, 2 * i + 2); ++x)
            if (const Light& part = fine.light(face, x, y); part.flux[3] > 0) parts[count++] = part;
        coarse.light(face, i, j) = united(std::span(parts).first(count));
      }
    });
    coarse.set_quads(faces);
    blocks_.push_back(std::move(coarse));
  }
}

}  // namespace envmap

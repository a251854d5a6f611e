#include "envmap/prefilter/light_tree.h"

#include <algorithm>
#include <limits>

#include "envmap/operate/measure.h"
#include "envmap/base/parallel.h"
#include "envmap/prefilter/cell.h"
#include "envmap/projection/visit.h"
#include "envmap/sample/target.h"

namespace envmap {
namespace {

constexpr std::int64_t most_stored = 1 << 17;  // Blocks of the lowest level: 25 MB with all above.

int halves(int n) { return (n + 1) / 2; }

Colour darkest_of(const Level& source) {
  Colour least(std::numeric_limits<float>::max());
  for (const Colour& row : map_rows<Colour>(source.height(), [&](int j) {
         const Columns in = columns(source.projection(), source.height(), j);
         Colour c(std::numeric_limits<float>::max());
         for (int face = 0; face < source.faces(); ++face)
           for (int i = in.first; i < in.end; ++i) c = glm::min(c, *source.texel(face, i, j));
         return c;
       }))
    least = glm::min(least, row);
  return least;
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

// Steradians of the texels of a block, which every face has the same.
struct SolidAngles {
  Span in;
  std::vector<double> texels;

  SolidAngles(const Level& source, const Span& block) : in(block), texels(in.count()) {
    std::vector<double> edges;
    for (int i = in.left; i <= in.right; ++i) edges.push_back(i / static_cast<double>(source.width()));
    const double h = source.height();
    for (int j = in.top; j < in.bottom; ++j)
      solid_angles(source.projection(), edges, j / h, (j + 1) / h,
                   std::span(texels).subspan(in.index(in.left, j), edges.size() - 1));
  }
};

// Directions of the texels of a block.
std::vector<Direction>& directions_of(const Level& source, int face, const Span& in) {
  thread_local std::vector<Direction> found;
  found.resize(in.count());
  for (int j = in.top; j < in.bottom; ++j)
    texel_directions(source.projection(), source.height(), face, j, in.left,
                     std::span(found).subspan(in.index(in.left, j), static_cast<std::size_t>(in.width())));
  return found;
}

// A texel as a parallelogram between its neighbours: of sides a and b it has the covariance (a a^T + b b^T) / 12.
Patch parallelogram(const Direction& a, const Direction& b) {
  Patch p;
  p.covariance.add_square(a, 1.0 / 12);
  p.covariance.add_square(b, 1.0 / 12);
  p.spread = 0.31 * std::sqrt(glm::dot(a, a) + glm::dot(b, b));
  p.reach = 0.51 * std::max(glm::length(a + b), glm::length(a - b));
  return p;
}

// How far the mean directions of texels lie beside those of their middles, of a texel in the middle of each block: by the
// curve of the projection and what its density gains from side to side, (h^2 / 24) (d_uu + 2 d_u rho_u / rho) and the same
// of v. What the mean is shorter by is not counted.
void set_shifts(const Level& source, int face, std::span<const Span> blocks, std::span<Direction> out) {
  constexpr std::size_t each = 5;
  std::array<Vec2<double>, each * most_lanes> at;
  std::array<Direction, at.size()> d;
  std::array<double, at.size()> density;
  const double w = source.width(), h = source.height(), g = 0.28867513459481287;  // 1 / (2 sqrt(3)): Gauss points.
  for (std::size_t n = 0; n < blocks.size(); ++n) {
    const double u = 0.5 * (blocks[n].left + blocks[n].right), v = 0.5 * (blocks[n].top + blocks[n].bottom);
    const std::array<Vec2<double>, each> from{{{u, v}, {u - g, v - g}, {u + g, v - g}, {u - g, v + g}, {u + g, v + g}}};
    for (std::size_t k = 0; k < each; ++k) at[each * n + k] = {from[k].x / w, from[k].y / h};
  }
  const std::size_t count = each * blocks.size();
  directions(source.projection(), face, std::span(at).first(count), std::span(d).first(count));
  densities(source.projection(), std::span(at).first(count), std::span(density).first(count));
  for (std::size_t n = 0; n < blocks.size(); ++n) {
    Direction sum(0);
    double weight = 0;
    for (std::size_t k = each * n + 1; k < each * (n + 1); ++k) sum += density[k] * d[k], weight += density[k];
    const Direction mean = sum / weight, &middle = d[each * n];
    out[n] = mean - glm::dot(mean, middle) * middle;
  }
}

// Up to sixteen blocks, of two rows and columns or more, of texels that are all much alike. @param omega of a block that
// they all lie in.
void plain_blocks(const Level& source, int face, const SolidAngles& omega, std::span<const Span> blocks, double scale,
                  Light* out) {
  if (blocks.empty()) return;
  const Span& in = omega.in;
  const std::vector<Direction>& directions = directions_of(source, face, in);
  int width = 0, height = 0;
  for (const Span& b : blocks) width = std::max(width, b.width()), height = std::max(height, b.height());
  thread_local std::vector<Shapes> rows;
  thread_local std::vector<Texels> parts;
  const auto across = static_cast<std::size_t>(width);
  rows.resize(static_cast<std::size_t>(height)), parts.resize(across * rows.size());
  for (std::size_t k = 0; k < parts.size(); ++k) parts[k] = {.row = &rows[k / across]};

  std::array<Direction, most_lanes> origins, shifts;
  set_shifts(source, face, blocks, shifts);
  for (std::size_t lane = 0; lane < blocks.size(); ++lane) {
    const Span& b = blocks[lane];
    const int middle = (b.left + b.right - 1) / 2;
    origins[lane] = directions[in.index(middle, (b.top + b.bottom - 1) / 2)];
    for (int j = b.top; j < b.bottom; ++j) {
      const auto at = [&](int i, int row) { return directions[in.index(i, row)]; };
      const int other = j + 1 < b.bottom ? j + 1 : j - 1;
      const Patch alike = parallelogram(at(middle + 1, j) - at(middle, j), at(middle, other) - at(middle, j));
      const auto& m = alike.covariance.m;
      const double inside = 1 - 0.5 * (m[0] + m[3] + m[5]);  // Length of a texel's mean direction.
      const auto row = static_cast<std::size_t>(j - b.top);
      rows[row].set(lane, alike);
      const Colour* colours = source.texel(face, b.left, j);
      std::size_t from = in.index(b.left, j), to = row * across;
      for (int i = b.left; i < b.right; ++i, ++from, ++to, ++colours)
        parts[to].set(lane, inside * directions[from] + shifts[lane] - origins[lane], omega.texels[from],
                      scale * Flux(*colours));
    }
  }
  Lights whole;
  unite(parts, whole);
  for (std::size_t lane = 0; lane < blocks.size(); ++lane) out[lane] = whole.light(lane, origins[lane]);
}

// A block that may be of one texel, and may lie at a rim.
template <class P>
Light any_block(const Level& source, int face, const Span& in, double scale) {
  thread_local std::vector<Light> texels;
  texels.clear();
  for (int j = in.top; j < in.bottom; ++j)
    for (int i = in.left; i < in.right; ++i) {
      const Patch area = patch<P>(face, rect_of({i, j, i + 1, j + 1}, source));
      if (area.solid_angle > 0) texels.push_back(light_of(area, scale * Flux(*source.texel(face, i, j))));
    }
  return united(texels);
}

// Sixteen blocks of `side` texels across, or what there is of them.
void set_blocks(const Level& source, int face, int side, const SolidAngles& omega, double scale, Light* out) {
  const Span& in = omega.in;
  std::array<Span, most_lanes> plain;
  std::array<Light, most_lanes> found;
  std::array<Light*, most_lanes> to;
  std::size_t count = 0;
  visit(source.projection(), [&](auto p) {
    using P = decltype(p);
    for (int left = in.left; left < in.right; left += side, ++out) {
      const Span block{left, in.top, std::min(in.right, left + side), in.bottom};
      if (is_plain<P>(block, rect_of(block, source)))
        plain[count] = block, to[count++] = out;
      else
        *out = any_block<P>(source, face, block, scale);
    }
  });
  plain_blocks(source, face, omega, std::span(plain).first(count), scale, found.data());
  for (std::size_t k = 0; k < count; ++k) *to[k] = found[k];
}

// Lights of two rows in fours. @param lower of as many as the upper one, or none.
void unite_rows(std::span<const Light> upper, std::span<const Light> lower, Light* out) {
  const std::size_t count = (upper.size() + 1) / 2;
  std::array<Lights, 4> parts;
  std::array<Direction, most_lanes> origins;
  Lights whole;
  for (std::size_t start = 0; start < count; start += most_lanes) {
    const std::size_t lanes = std::min(most_lanes, count - start);
    for (Lights& p : parts) p = {};
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::size_t first = 2 * (start + lane);
      const Light* origin = nullptr;
      for (std::size_t k = 0; k < 4; ++k) {
        const std::span<const Light> row = k < 2 ? upper : lower;
        const std::size_t from = first + k % 2;
        if (from >= row.size() || row[from].flux[3] <= 0) continue;
        if (!origin) origin = &row[from];
        parts[k].set(lane, row[from], origin->centre);
      }
      origins[lane] = origin ? origin->centre : Direction(0);
    }
    unite(parts, whole);
    for (std::size_t lane = 0; lane < lanes; ++lane) out[start + lane] = whole.light(lane, origins[lane]);
  }
}

}  // namespace

std::optional<std::array<Light, 4>> LightTree::quarters(int face, const Span& in) const {
  const std::array<Span, 4> parts = in.quarters();
  const bool plain = visit(source_.projection(), [&](auto p) {
    return std::ranges::all_of(parts, [&](const Span& s) { return is_plain<decltype(p)>(s, rect_of(s, source_)); });
  });
  if (!plain) return std::nullopt;
  std::array<Light, 4> found;
  plain_blocks(source_, face, {source_, in}, parts, mean_ > 0 ? 1 / mean_ : 0, found.data());
  return found;
}

LightTree::Blocks::Blocks(int count, int across, int down)
    : faces(count),
      width(across),
      height(down),
      lights(std::make_unique_for_overwrite<Light[]>(place(across, down, count, 0))),
      quads(std::make_unique_for_overwrite<Quad[]>(place(halves(across), halves(down), count, 0))) {}

void LightTree::Blocks::set_quads(int face, int j) {
  Quad* to = &quads[place(halves(width), halves(height), face, j)];
  std::fill_n(to, halves(width), Quad::none());
  for (int y = 2 * j; y < std::min(height, 2 * j + 2); ++y)
    for (int i = 0; i < width; ++i)
      if (const Light& one = light(face, i, y); one.flux[3] > 0)
        to[i / 2].set(static_cast<std::size_t>(2 * (y % 2) + i % 2), one);
}

LightTree::LightTree(const Level& source) : source_(source), mean_(mean_radiance(source)), darkest_(0) {
  if (mean_ > 0) darkest_ = Colour(Flux(darkest_of(source)) / mean_);
  const int width = source.width(), height = source.height(), faces = source.faces();
  while (static_cast<std::int64_t>(faces) * (width >> first_) * (height >> first_) > most_stored) ++first_;
  const int side = 1 << first_, at_once = static_cast<int>(most_lanes) * side;
  const double scale = mean_ > 0 ? 1 / mean_ : 0;
  Blocks lowest(faces, (width + side - 1) / side, (height + side - 1) / side);
  for_each_row(1, lowest.height, {}, [&](int, int j) {
    for (int left = 0; left < width; left += at_once) {
      const SolidAngles omega(source, {left, j * side, std::min(width, left + at_once), std::min(height, (j + 1) * side)});
      for (int face = 0; face < faces; ++face)
        set_blocks(source, face, side, omega, scale, lowest.row(face, j) + left / side);
    }
  });
  for_each_row(faces, halves(lowest.height), {}, [&](int face, int j) { lowest.set_quads(face, j); });
  blocks_.push_back(std::move(lowest));
  while (blocks_.back().width > 1 || blocks_.back().height > 1) {
    const Blocks& fine = blocks_.back();
    const auto row_of = [&](int face, int j) {
      return j < fine.height ? std::span<const Light>(fine.row(face, j), static_cast<std::size_t>(fine.width))
                             : std::span<const Light>{};
    };
    Blocks coarse(faces, halves(fine.width), halves(fine.height));
    for_each_row(faces, coarse.height, {},
                 [&](int face, int j) { unite_rows(row_of(face, 2 * j), row_of(face, 2 * j + 1), coarse.row(face, j)); });
    for_each_row(faces, halves(coarse.height), {}, [&](int face, int j) { coarse.set_quads(face, j); });
    blocks_.push_back(std::move(coarse));
  }
}

}  // namespace envmap

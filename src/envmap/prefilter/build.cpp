#include <algorithm>
#include <limits>

#include "envmap/base/parallel.h"
#include "envmap/operate/measure.h"
#include "envmap/prefilter/cell.h"
#include "envmap/prefilter/tree.h"
#include "envmap/projection/visit.h"
#include "envmap/sample/target.h"

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

// Blocks of the lowest level, 220 bytes each with all above: 30 MB, or a little more than a large source itself takes.
std::int64_t most_stored(std::int64_t texels) { return std::clamp<std::int64_t>(texels / 16, 1 << 17, 1 << 19); }

int halves(int n) { return (n + 1) / 2; }

// Whether the texels of a block are all much alike: there are several each way, and none ends in a pole.
template <class P>
bool is_plain(const Span& in, const Level& source) {
  if (in.width() < 2 || in.height() < 2) return false;
  return !std::is_same_v<P, Latlong> || (in.top > 0 && in.bottom < source.height());
}

// Steradians of the texels of a block, which every face has the same.
struct SolidAngles {
  Span in;
  std::vector<double> texels;

  SolidAngles(const Level& source, const Span& block) : in(block), texels(in.count()) {
    std::vector<double> edges;
    for (int i = in.left; i <= in.right; ++i) edges.push_back(i / double(source.width()));
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
                     std::span(found).subspan(in.index(in.left, j), std::size_t(in.width())));
  return found;
}

// A texel as a parallelogram between its neighbours: of sides a and b it has the covariance (a a^T + b b^T) / 12.
Moments parallelogram(const Direction& a, const Direction& b) {
  Moments p;
  p.covariance.add_square(a, 1.0 / 12);
  p.covariance.add_square(b, 1.0 / 12);
  p.spread = 0.32 * std::sqrt(glm::dot(a, a) + glm::dot(b, b));
  p.reach = 0.51 * std::max(glm::length(a + b), glm::length(a - b));
  return p;
}

// How far the mean directions of texels lie beside those of their middles, of a texel in the middle of each block: by
// the curve of the projection and what its density gains from side to side, (h^2 / 24) (d_uu + 2 d_u rho_u / rho) and
// the same of v. What the mean is shorter by is not counted.
void set_shifts(const Level& source, int face, std::span<const Span> blocks, std::span<Direction> out) {
  constexpr std::size_t each = 5;
  std::array<Vec2<double>, each * batch_size> at;
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

// Up to sixteen blocks, of two rows and columns or more, of texels that are all much alike. @param omega of a block
// that they all lie in.
void plain_blocks(const Tree& tree, int face, const SolidAngles& omega, std::span<const Span> blocks, Node* out) {
  if (blocks.empty()) return;
  const Level& source = tree.source();
  const Span& in = omega.in;
  const std::vector<Direction>& directions = directions_of(source, face, in);
  int width = 0, height = 0;
  for (const Span& b : blocks) width = std::max(width, b.width()), height = std::max(height, b.height());
  thread_local std::vector<ShapeBatch> rows;
  thread_local std::vector<TexelBatch> parts;
  const auto across = std::size_t(width);
  rows.resize(std::size_t(height)), parts.resize(across * rows.size());
  for (std::size_t k = 0; k < parts.size(); ++k) parts[k] = {.row = &rows[k / across]};

  std::array<Direction, batch_size> origins, shifts;
  set_shifts(source, face, blocks, shifts);
  for (std::size_t lane = 0; lane < blocks.size(); ++lane) {
    const Span& b = blocks[lane];
    const int middle = (b.left + b.right - 1) / 2;
    origins[lane] = directions[in.index(middle, (b.top + b.bottom - 1) / 2)];
    for (int j = b.top; j < b.bottom; ++j) {
      const auto at = [&](int i, int row) { return directions[in.index(i, row)]; };
      const int other = j + 1 < b.bottom ? j + 1 : j - 1;
      const Moments alike = parallelogram(at(middle + 1, j) - at(middle, j), at(middle, other) - at(middle, j));
      const auto& m = alike.covariance.m;
      const double inside = 1 - 0.5 * (m[0] + m[3] + m[5]);  // Length of a texel's mean direction.
      const auto row = std::size_t(j - b.top);
      rows[row].set(lane, alike);
      const Colour* colours = source.texel(face, b.left, j);
      std::size_t from = in.index(b.left, j), to = row * across;
      for (int i = b.left; i < b.right; ++i, ++from, ++to, ++colours)
        parts[to].set(lane, inside * directions[from] + shifts[lane] - origins[lane], omega.texels[from],
                      tree.beyond(*colours));
    }
  }
  NodeBatch whole;
  unite(parts, whole);
  for (std::size_t lane = 0; lane < blocks.size(); ++lane) out[lane] = whole.node(lane, origins[lane]);
}

// Any block, texel by texel.
template <class P>
Node any_block(const Tree& tree, int face, const Span& in) {
  const Level& source = tree.source();
  thread_local std::vector<Node> texels;
  texels.clear();
  for (int j = in.top; j < in.bottom; ++j)
    for (int i = in.left; i < in.right; ++i) {
      const Moments area = moments<P>(face, texel_rect(i, j, source.width(), source.height()));
      texels.push_back(node_of(area, tree.beyond(*source.texel(face, i, j))));
    }
  return united(texels);
}

// Sixteen blocks of `side` texels across, or what there is of them.
void set_blocks(const Tree& tree, int face, int side, const SolidAngles& omega, Node* out) {
  const Level& source = tree.source();
  const Span& in = omega.in;
  std::array<Span, batch_size> plain;
  std::array<Node, batch_size> found;
  std::array<Node*, batch_size> to;
  std::size_t count = 0;
  visit_source(source.projection(), [&](auto p) {
    using P = decltype(p);
    for (int left = in.left; left < in.right; left += side, ++out) {
      const Span block{left, in.top, std::min(in.right, left + side), in.bottom};
      if (is_plain<P>(block, source))
        plain[count] = block, to[count++] = out;
      else
        *out = any_block<P>(tree, face, block);
    }
  });
  plain_blocks(tree, face, omega, std::span(plain).first(count), found.data());
  for (std::size_t k = 0; k < count; ++k) *to[k] = found[k];
}

// NodeBatch of two rows in fours. @param lower of as many as the upper one, or none.
void unite_rows(std::span<const Node> upper, std::span<const Node> lower, Node* out) {
  const std::size_t count = (upper.size() + 1) / 2;
  std::array<NodeBatch, 4> parts;
  std::array<Direction, batch_size> origins;
  NodeBatch whole;
  for (std::size_t start = 0; start < count; start += batch_size) {
    const std::size_t lanes = std::min(batch_size, count - start);
    for (NodeBatch& p : parts) p = {};
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::size_t first = 2 * (start + lane);
      const Node* origin = nullptr;
      for (std::size_t k = 0; k < 4; ++k) {
        const std::span<const Node> row = k < 2 ? upper : lower;
        const std::size_t from = first + k % 2;
        if (from >= row.size() || !is_lit(row[from])) continue;
        if (!origin) origin = &row[from];
        parts[k].set(lane, row[from], origin->centre);
      }
      origins[lane] = origin ? origin->centre : Direction(0);
    }
    unite(parts, whole);
    for (std::size_t lane = 0; lane < lanes; ++lane) out[start + lane] = whole.node(lane, origins[lane]);
  }
}

}  // namespace

std::optional<std::array<Node, 4>> Tree::quarters(int face, const Span& in) const {
  const std::array<Span, 4> parts = in.quarters();
  const bool plain = visit_source(source_.projection(), [&](auto p) {
    return std::ranges::all_of(parts, [&](const Span& s) { return is_plain<decltype(p)>(s, source_); });
  });
  if (!plain) return std::nullopt;
  std::array<Node, 4> found;
  plain_blocks(*this, face, {source_, in}, parts, found.data());
  return found;
}

Tree::Blocks::Blocks(int count, int across, int down)
    : faces(count),
      width(across),
      height(down),
      nodes(std::make_unique_for_overwrite<Node[]>(place(across, down, count, 0))),
      quads(std::make_unique_for_overwrite<NodeQuad[]>(place(halves(across), halves(down), count, 0))) {}

void Tree::Blocks::set_quads(int face, int j) {
  NodeQuad* to = &quads[place(halves(width), halves(height), face, j)];
  std::fill_n(to, halves(width), NodeQuad::none());
  for (int y = 2 * j; y < std::min(height, 2 * j + 2); ++y)
    for (int i = 0; i < width; ++i)
      if (const Node& one = node(face, i, y); is_lit(one)) to[i / 2].set(std::size_t(2 * (y % 2) + i % 2), one);
}

Tree::Tree(const Level& source, double mean, int parts) : source_(source), parts_(parts), mean_(mean), darkest_(0) {
  if (mean_ > 0) darkest_ = Flux(darkest_of(source)) / mean_;
  const int width = source.width(), height = source.height(), faces = source.faces();
  const auto blocks = [&] { return std::int64_t(faces) * (width >> first_) * (height >> first_); };
  for (const std::int64_t most = most_stored(blocks()); blocks() > most;) ++first_;
  const int side = 1 << first_, at_once = int(batch_size) * side;
  Blocks lowest(faces, (width + side - 1) / side, (height + side - 1) / side);
  for_each_row(1, lowest.height, {}, [&](int, int j) {
    for (int left = 0; left < width; left += at_once) {
      const SolidAngles omega(source,
                              {left, j * side, std::min(width, left + at_once), std::min(height, (j + 1) * side)});
      for (int face = 0; face < faces; ++face) set_blocks(*this, face, side, omega, lowest.row(face, j) + left / side);
    }
    source.trim();
  });
  for_each_row(faces, halves(lowest.height), {}, [&](int face, int j) { lowest.set_quads(face, j); });
  blocks_.push_back(std::move(lowest));
  while (blocks_.back().width > 1 || blocks_.back().height > 1) {
    const Blocks& fine = blocks_.back();
    const auto row_of = [&](int face, int j) {
      return j < fine.height ? std::span<const Node>(fine.row(face, j), std::size_t(fine.width))
                             : std::span<const Node>{};
    };
    Blocks coarse(faces, halves(fine.width), halves(fine.height));
    for_each_row(faces, coarse.height, {}, [&](int face, int j) {
      unite_rows(row_of(face, 2 * j), row_of(face, 2 * j + 1), coarse.row(face, j));
    });
    for_each_row(faces, halves(coarse.height), {}, [&](int face, int j) { coarse.set_quads(face, j); });
    blocks_.push_back(std::move(coarse));
  }
}

}  // namespace envmap::prefiltering

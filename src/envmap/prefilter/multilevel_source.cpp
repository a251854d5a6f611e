#include "envmap/prefilter/multilevel_source.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

#include "envmap/maths/portable.h"
#include "envmap/maths/quadrature.h"
#include "envmap/prefilter/multilevel_kernels.h"
#include "envmap/projection/cube.h"
#include "envmap/projection/projection.h"

namespace envmap::prefiltering {

namespace {

constexpr int half_nodes = nodes_across / 2;
using Weights = std::array<double, nodes_across>;

// Of each node i, the product of 1 / (i - k) over all others.
constexpr Weights inverse_gaps = [] {
  Weights all{};
  for (int i = 0; i < nodes_across; ++i) {
    double gaps = 1;
    for (int k = 0; k < nodes_across; ++k)
      if (k != i) gaps *= i - k;
    all[std::size_t(i)] = 1 / gaps;
  }
  return all;
}();

// Of nodes floor(u) - 5 to floor(u) + 6. @return the first node.
int lagrange(double u, Weights& w) {
  const int first = int(std::floor(u)) - half_nodes + 1;
  const double at = u - first;
  double before = 1, after = 1;
  for (std::size_t i = 0; i < w.size(); ++i) w[i] = before * inverse_gaps[i], before *= at - double(i);
  for (std::size_t i = w.size(); i-- > 0;) w[i] *= after, after *= at - double(i);
  return first;
}

struct Term {
  int from;
  bool turned;  // By half a turn: beyond a pole.
  float weight;
};
using Terms = std::vector<std::vector<Term>>;

// What `parts` equal parts of a line of `nodes` nodes add to each: integrals of density(position in 0 to 1) x the
// basis.
// @param wraps from the last to the first; else it goes on mirrored, half a turn away.
template <class Density>
Terms adjoint(int parts, int nodes, bool wraps, Density&& density) {
  std::vector<std::map<std::pair<int, bool>, double>> sums(std::size_t(nodes),
                                                           std::map<std::pair<int, bool>, double>{});
  const auto& gauss = quadrature::rule<3>();
  const int panels = (nodes + parts - 1) / parts;
  const double width = 1.0 / parts / panels;
  Weights w;
  for (int k = 0; k < parts * panels; ++k)
    for (std::size_t g = 0; g < 3; ++g) {
      const double at = (k + 0.5 + 0.5 * gauss.node[g]) * width, part = 0.5 * width * gauss.weight[g] * density(at);
      const int first = lagrange(at * nodes - 0.5, w);
      for (int i = 0; i < nodes_across; ++i) {
        int node = first + i;
        const bool outside = node < 0 || node >= nodes;
        if (outside) node = wraps ? (node + nodes) % nodes : node < 0 ? -1 - node : 2 * nodes - 1 - node;
        sums[std::size_t(node)][{k / panels, outside && !wraps}] += part * w[std::size_t(i)];
      }
    }
  Terms terms(static_cast<std::size_t>(nodes));
  for (std::size_t n = 0; n < terms.size(); ++n)
    for (const auto& [key, weight] : sums[n]) terms[n].push_back({key.first, key.second, float(weight)});
  return terms;
}

// Every row with all columns; three channels, one after another.
struct Planes {
  int rows, columns;
  std::vector<float> light;
  Planes(int of_rows, int of_columns)
      : rows(of_rows), columns(of_columns), light(3 * std::size_t(of_rows) * std::size_t(of_columns)) {}
  [[nodiscard]] std::span<float> row(int row, int channel) {
    return std::span(light).subspan((std::size_t(row) * 3 + std::size_t(channel)) * std::size_t(columns),
                                    std::size_t(columns));
  }
  [[nodiscard]] std::span<const float> row(int r, int channel) const {
    return const_cast<Planes*>(this)->row(r, channel);
  }
};

// out += weight x in, `in` turned by half of its columns if wanted.
void add_row(std::span<const float> in, const Term& term, std::span<float> out) {
  if (!term.turned) return add_scaled(in, term.weight, out);
  const std::size_t half = in.size() / 2;
  add_scaled(in.subspan(half), term.weight, out.first(in.size() - half));
  add_scaled(in.first(half), term.weight, out.last(half));
}

// A periodic row with room on both sides, so that shifted copies are spans of it.
class Wrapped {
 public:
  static constexpr int room = 2 * nodes_across;
  void set(std::span<const float> row, std::size_t step, std::size_t offset) {
    const std::size_t count = row.size() / step;
    padded_.resize(count + 2 * room);
    for (std::size_t k = 0; k < count; ++k) padded_[room + k] = row[k * step + offset];
    for (std::size_t k = 0; k < room; ++k) {
      padded_[room + count + k] = padded_[room + k % count];
      padded_[room - 1 - k] = padded_[room + count - 1 - k % count];
    }
  }
  [[nodiscard]] std::span<const float> from(int shift, std::size_t count) const {
    return std::span(padded_).subspan(std::size_t(room + shift), count);
  }

 private:
  std::vector<float> padded_;
};

// Of the adjoint of interpolation at -1/4 and +1/4 of a cell: fine 2 k - 1/4, 2 k + 1 + 1/4.
struct Halving {
  Weights low, high;  // Of a fine cell left and right of its coarse one, from nodes -6 and -5 on.
  Halving() { lagrange(-0.25, low), lagrange(0.25, high); }
};
const Halving& halving() {
  static const Halving h;
  return h;
}

// Half as many columns.
void halve(std::span<const float> in, std::span<float> out) {
  thread_local Wrapped even, odd;
  even.set(in, 2, 0), odd.set(in, 2, 1);
  std::ranges::fill(out, 0.F);
  for (int i = 0; i < nodes_across; ++i) {
    // Coarse k has the fine 2 (k - node) and 2 (k - node) + 1.
    add_scaled(even.from(half_nodes - i, out.size()), float(halving().low[std::size_t(i)]), out);
    add_scaled(odd.from(half_nodes - 1 - i, out.size()), float(halving().high[std::size_t(i)]), out);
  }
}

Planes coarser(const Planes& fine) {
  Planes narrow(fine.rows, fine.columns / 2), out(fine.rows / 2, fine.columns / 2);
  tbb::parallel_for(0, fine.rows, [&](int r) {
    for (int c = 0; c < 3; ++c) halve(fine.row(r, c), narrow.row(r, c));
  });
  tbb::parallel_for(0, out.rows, [&](int k) {
    for (int i = 0; i < nodes_across; ++i)
      for (int side = 0; side < 2; ++side) {
        const int node = i - half_nodes + side;
        int r = 2 * (k - node) + side;
        const bool turned = r < 0 || r >= fine.rows;
        if (turned) r = r < 0 ? -1 - r : 2 * fine.rows - 1 - r;
        const double w = side == 0 ? halving().low[std::size_t(i)] : halving().high[std::size_t(i)];
        for (int c = 0; c < 3; ++c) add_row(narrow.row(r, c), {r, turned, float(w)}, out.row(k, c));
      }
  });
  return out;
}

// Rows near poles in fewer columns, at least 64.
SourceGrid thinned(const Planes& full) {
  SourceGrid grid;
  grid.rows = full.rows;
  std::size_t size = 0;
  for (int r = 0; r < full.rows; ++r) {
    const double angle = (r + 0.5) / full.rows, sine = portable::sin_pi(angle);
    int columns = full.columns;
    for (double s = 2 * sine; s <= 1 && columns > 64; s *= 2) columns /= 2;
    grid.columns.push_back(columns), grid.first.push_back(size);
    grid.sine.push_back(float(sine));
    grid.half_sine.push_back(portable::sin_pi(0.5 * angle)), grid.half_cosine.push_back(portable::cos_pi(0.5 * angle));
    size += 3 * grid.stride(r);
  }
  grid.light.resize(size);
  tbb::parallel_for(0, full.rows, [&](int r) {
    std::vector<float> row, next;
    for (int c = 0; c < 3; ++c) {
      const auto all = full.row(r, c);
      row.assign(all.begin(), all.end());
      while (int(row.size()) > grid.columns[std::size_t(r)]) {
        next.resize(row.size() / 2);
        halve(row, next);
        std::swap(row, next);
      }
      float* to = &grid.light[grid.first[std::size_t(r)] + std::size_t(c) * grid.stride(r)];
      std::ranges::copy(row, to);
      std::copy_n(row.begin(), SourceGrid::padding, to + row.size());
    }
  });
  return grid;
}

// ---- the finest grid ------------------------------------------------------------------------------------------------

// One row of texels as its share in the columns of a grid.
class Across {
 public:
  Across(int width, int columns)
      : step_(width % columns == 0 ? width / columns : 0),
        terms_(adjoint(width, columns, true, [](double) { return 2 * pi; })) {
    if (step_ == 0) return;
    // All columns have the weights of column 0, a step on. Weights of texels left of it lie at the end.
    const auto place = [&](const Term& t) { return t.from < width / 2 ? t.from : t.from - width; };
    const auto by_place = [&](const Term& a, const Term& b) { return place(a) < place(b); };
    first_ = place(*std::ranges::min_element(terms_[0], by_place));
    const int count = place(*std::ranges::max_element(terms_[0], by_place)) - first_ + 1;
    weights_.resize(std::size_t(count + 7) / 8 * 8);
    for (const Term& t : terms_[0]) weights_[std::size_t(place(t) - first_)] = t.weight;
    terms_.clear();
  }

  void apply(std::span<const float> texels, std::span<float> out) const {
    if (step_ > 0) {
      thread_local std::vector<float> padded;
      const int width = int(texels.size()), size = width + int(weights_.size());
      padded.resize(std::size_t(size));
      for (int k = 0; k < size; ++k) padded[std::size_t(k)] = texels[std::size_t((k + first_ + 4 * width) % width)];
      return dot_products(padded, std::size_t(step_), weights_, out);
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] = 0;
      for (const Term& t : terms_[i]) out[i] += t.weight * texels[std::size_t(t.from)];
    }
  }

 private:
  int step_, first_ = 0;
  Terms terms_;
  std::vector<float> weights_;
};

// Bands of rows read the rows of the source that they need, each once, in one order whatever the number of threads.
Planes of_latlong(const Level& source, double unit, const Colour& darkest, int rows) {
  Planes out(rows, 2 * rows);
  const Terms down = adjoint(source.height(), rows, false, [](double v) { return pi * portable::sin_pi(v); });
  const Across across(source.width(), 2 * rows);
  const double scale = 1 / unit;  // Beyond floats where light is subnormal.
  const int band = std::max(16, rows / 16);
  tbb::parallel_for(0, (rows + band - 1) / band, [&](int b) {
    const int low = b * band, high = std::min(rows, low + band);
    std::vector<std::pair<Term, int>> terms;  // And the row they add to.
    for (int r = low; r < high; ++r)
      for (const Term& t : down[std::size_t(r)]) terms.emplace_back(t, r);
    std::ranges::stable_sort(terms, {}, [](const auto& t) { return t.first.from; });
    std::vector<float> texels(std::size_t(source.width()));
    std::array<std::vector<float>, 3> narrow;
    int read = -1;
    for (const auto& [term, to] : terms) {
      if (term.from != read) {
        read = term.from;
        const auto row = source.row(0, read);
        for (int c = 0; c < 3; ++c) {
          for (std::size_t i = 0; i < texels.size(); ++i) texels[i] = float(double(row[i][c] - darkest[c]) * scale);
          narrow[std::size_t(c)].resize(std::size_t(out.columns));
          across.apply(texels, narrow[std::size_t(c)]);
        }
        source.trim();
      }
      for (int c = 0; c < 3; ++c) add_row(narrow[std::size_t(c)], term, out.row(to, c));
    }
  });
  return out;
}

// ---- of a cube ------------------------------------------------------------------------------------------------------
// Each face is laid on a grid of equal angles first, column by column and row by row. The nodes are points then.

struct LightPoint {
  float light[3];
  double u, v;  // Of the latlong image.
};

// Gauss points a side of a texel, enough for a kernel that is a few steps of the grid wide.
int points_a_side(int size, int rows) {
  return rows < 0.69 * size ? 2 : 3 * std::max(1, (rows + 2 * size - 1) / (2 * size));
}

// Along one side of a face: Gauss points of its texels, and what each adds to the nodes of the grid.
struct FaceSide {
  struct Point {
    double at, weight;  // From -1 to 1, and its part of the side.
    int first;          // Node.
    std::array<float, nodes_across> basis;
  };
  int texels, nodes;
  std::vector<Point> points;     // As many a texel.
  std::vector<double> tangents;  // Of nodes.

  FaceSide(int size, int rows) : texels(size), nodes(rows / 2 + nodes_across) {
    const double step = pi / rows, edge = -0.25 * pi - half_nodes * step;
    for (int k = 0; k < nodes; ++k) {
      const double turn = (edge + (k + 0.5) * step) / pi;
      tangents.push_back(portable::sin_pi(turn) / portable::cos_pi(turn));
    }
    std::vector<double> weights;
    const std::vector<double> places = gauss(points_a_side(size, rows), weights);
    Weights basis;
    for (int i = 0; i < size; ++i)
      for (std::size_t k = 0; k < places.size(); ++k) {
        Point p{.at = 2 * (i + places[k]) / size - 1, .weight = 2 * weights[k] / size};
        p.first = lagrange((portable::atan2(p.at, 1) - edge) / step - 0.5, basis);
        std::ranges::transform(basis, p.basis.begin(), [](double x) { return float(x); });
        points.push_back(p);
      }
  }
  [[nodiscard]] int points_a_texel() const { return int(points.size()) / texels; }

 private:
  // Places from 0 to 1.
  static std::vector<double> gauss(int count, std::vector<double>& weights) {
    std::vector<double> all;
    const auto add = [&](const auto& rule, int panels) {
      for (int p = 0; p < panels; ++p)
        for (std::size_t k = 0; k < rule.node.size(); ++k)
          all.push_back((p + 0.5 + 0.5 * rule.node[k]) / panels), weights.push_back(0.5 * rule.weight[k] / panels);
    };
    if (count == 2)
      add(quadrature::rule<2>(), 1);
    else
      add(quadrature::rule<3>(), count / 3);
    return all;
  }
};

// A row of points of a face, on the columns of its grid.
void add_columns(const FaceSide& side, std::span<const Colour> texels, double down, double unit, const Colour& darkest,
                 std::size_t channel, std::span<float> out) {
  const std::size_t many = std::size_t(side.points_a_texel());
  for (std::size_t k = 0; k < side.points.size(); ++k) {
    const FaceSide::Point& p = side.points[k];
    const double light = double(texels[k / many][int(channel)] - darkest[int(channel)]);
    if (light == 0) continue;
    const double square = 1 + p.at * p.at + down * down;
    const float part = float(light * unit * p.weight / (square * std::sqrt(square)));
    float* to = &out[std::size_t(p.first)];
    for (std::size_t i = 0; i < p.basis.size(); ++i) to[i] += part * p.basis[i];
  }
}

// All nodes of a face.
Planes face_nodes(const Level& source, int face, const FaceSide& side, double unit, const Colour& darkest) {
  const int many = side.points_a_texel();
  Planes narrow(int(side.points.size()), side.nodes), out(side.nodes, side.nodes);
  tbb::parallel_for(0, narrow.rows, [&](int r) {
    const FaceSide::Point& down = side.points[std::size_t(r)];
    for (std::size_t c = 0; c < 3; ++c)
      add_columns(side, source.row(face, r / many), down.at, unit * down.weight, darkest, c, narrow.row(r, int(c)));
    source.trim();
  });
  tbb::parallel_for(0, out.rows, [&](int node) {
    for (int r = 0; r < narrow.rows; ++r) {
      const FaceSide::Point& p = side.points[std::size_t(r)];
      if (node < p.first || node >= p.first + nodes_across) continue;
      for (int c = 0; c < 3; ++c) add_scaled(narrow.row(r, c), p.basis[std::size_t(node - p.first)], out.row(node, c));
    }
  });
  return out;
}

// A row of nodes as points.
std::vector<LightPoint> points_of(const Planes& nodes, int face, const FaceSide& side, int row) {
  std::vector<Direction> seen(std::size_t(nodes.columns));
  std::vector<Location<double>> places(seen.size());
  const Cube::Axes& a = Cube::axes[std::size_t(face)];
  for (std::size_t k = 0; k < seen.size(); ++k)
    seen[k] = unit(a.forward + side.tangents[k] * a.right - side.tangents[std::size_t(row)] * a.up);
  locate(Projection::latlong, seen, places);
  std::vector<LightPoint> out;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const LightPoint p{{nodes.row(row, 0)[k], nodes.row(row, 1)[k], nodes.row(row, 2)[k]}, places[k].u, places[k].v};
    if (p.light[0] != 0 || p.light[1] != 0 || p.light[2] != 0) out.push_back(p);
  }
  return out;
}

// Adds a point to those of its rows that lie in [low, high).
void add_point(const LightPoint& p, int low, int high, Planes& out) {
  Weights down, wide;
  const int row = lagrange(p.v * out.rows - 0.5, down);
  const int column = lagrange(p.u * out.columns - 0.5, wide);
  std::array<float, nodes_across> across;
  std::ranges::transform(wide, across.begin(), [](double x) { return float(x); });
  for (int j = 0; j < nodes_across; ++j) {
    int r = row + j, first = column + out.columns;
    if (r < 0 || r >= out.rows) r = r < 0 ? -1 - r : 2 * out.rows - 1 - r, first += out.columns / 2;
    if (r < low || r >= high) continue;
    first %= out.columns;
    for (int c = 0; c < 3; ++c) {
      const float weight = float(down[std::size_t(j)]) * p.light[c];
      float* to = out.row(r, c).data();
      if (first + nodes_across <= out.columns)
        for (int i = 0; i < nodes_across; ++i) to[first + i] += weight * across[std::size_t(i)];
      else
        for (int i = 0; i < nodes_across; ++i) to[(first + i) % out.columns] += weight * across[std::size_t(i)];
    }
  }
}

// Bands of rows take the points in one order, whatever the number of threads.
Planes of_cube(const Level& source, double mean, const Colour& darkest, int rows) {
  Planes out(rows, 2 * rows);
  const FaceSide side(source.height(), rows);
  const int band = std::max(16, rows / 32);
  for (int face = 0; face < source.faces(); ++face) {
    const Planes nodes = face_nodes(source, face, side, 1 / mean, darkest);
    std::vector<std::vector<LightPoint>> found(std::size_t(side.nodes));
    tbb::parallel_for(0, side.nodes, [&](int row) { found[std::size_t(row)] = points_of(nodes, face, side, row); });
    tbb::parallel_for(0, (rows + band - 1) / band, [&](int b) {
      const int low = b * band, high = std::min(rows, low + band);
      const double near = (low - nodes_across) / double(rows), far = (high + nodes_across) / double(rows);
      for (const auto& row : found)
        for (const LightPoint& p : row)
          if (p.v >= near && p.v <= far) add_point(p, low, high, out);
    });
  }
  return out;
}

}  // namespace

SourceGrids::SourceGrids(const Level& source, double unit, const Colour& darkest, int finest) {
  const bool latlong = source.projection() == Projection::latlong;
  Planes planes = latlong ? of_latlong(source, unit, darkest, finest) : of_cube(source, unit, darkest, finest);
  grids_.push_back(thinned(planes));
  while (planes.rows > least_rows) {
    planes = coarser(planes);
    grids_.push_back(thinned(planes));
  }
}

}  // namespace envmap::prefiltering

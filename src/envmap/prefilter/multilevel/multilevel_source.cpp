// The light of a source on its finest grid, for cubes and for latlong maps, and the coarser grids by the adjoint of
// interpolation.
#include "envmap/prefilter/multilevel/multilevel_source.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

#include "envmap/base/large_pages.h"
#include "envmap/base/parallel.h"
#include "envmap/base/stop_point.h"
#include "envmap/map/environment_map.h"
#include "envmap/maths/portable.h"
#include "envmap/maths/quadrature.h"
#include "envmap/prefilter/multilevel/lagrange.h"
#include "envmap/prefilter/multilevel/multilevel_kernels.h"
#include "envmap/projection/cube.h"
#include "envmap/projection/projection.h"

namespace envmap::prefiltering {

// The finest grid of a source before its rows are thinned.

namespace {

/// A grid whose rows all have the same number of columns. The three channels of a row follow each other.
struct LightPlanes {
  int rows, columns;
  std::vector<float, LargePages<float>> light;
  LightPlanes(int of_rows, int of_columns)
      : rows(of_rows), columns(of_columns), light(3 * std::size_t(of_rows) * std::size_t(of_columns)) {}
  [[nodiscard]] std::span<float> row(int row, int channel) {
    return std::span(light).subspan((std::size_t(row) * 3 + std::size_t(channel)) * std::size_t(columns),
                                    std::size_t(columns));
  }
  [[nodiscard]] std::span<const float> row(int r, int channel) const {
    return const_cast<LightPlanes*>(this)->row(r, channel);
  }
};

/// out += weight x in. Beyond a pole `in` is turned by half of its columns.
inline void add_row(std::span<const float> in, const Term& term, std::span<float> out) {
  if (!term.turned) return add_scaled(in, term.weight, out);
  const std::size_t half = in.size() / 2;
  add_scaled(in.subspan(half), term.weight, out.first(in.size() - half));
  add_scaled(in.first(half), term.weight, out.last(half));
}

LightPlanes cube_planes(const Level& source, double unit, const Colour& min_radiance, int rows);

}  // namespace

// The light of a cube on its finest grid. Each face is first laid on a grid of equal angles, column by column and row
// by row. The nodes of that grid are then points of the latlong grid.

namespace {

struct LightPoint {
  float light[3];
  double u, v;  // Place in the latlong image.
};

// Gauss points a side of a texel, enough for a kernel that is a few steps of the grid wide.
int points_a_side(int size, int rows) {
  return rows < 0.69 * size ? 2 : 3 * std::max(1, (rows + 2 * size - 1) / (2 * size));
}

// Gauss points of the texels along one side of a face, with their weights at the nodes of the grid.
struct FaceSide {
  struct Point {
    double at, weight;  // Place from -1 to 1; part of the side that the point stands for.
    int first;          // The first of its nodes.
    std::array<float, nodes_across> basis;
  };
  int texels, nodes;
  std::vector<Point> points;     // Each texel has the same number.
  std::vector<double> tangents;  // Tangents of the nodes' angles.

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

// The light of a row of Gauss points of a face.
std::array<std::vector<float>, 3> light_of_row(const FaceSide& side, std::span<const Colour> texels, double down,
                                               double unit, const Colour& min_radiance) {
  const std::size_t count = side.points.size(), many = std::size_t(side.points_a_texel());
  std::array<std::vector<float>, 3> light;
  for (std::vector<float>& channel : light) channel.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    const FaceSide::Point& p = side.points[k];
    const double square = 1 + p.at * p.at + down * down, weight = unit * p.weight / (square * std::sqrt(square));
    const Colour texel = texels[k / many] - min_radiance;
    for (std::size_t c = 0; c < 3; ++c) light[c][k] = float(double(texel[int(c)]) * weight);
  }
  return light;
}

// Lays a row of points on the columns of its grid. Neighbouring points mostly share their nodes.
void add_columns(const FaceSide& side, std::span<const float> light, std::span<float> out) {
  std::array<float, nodes_across> sum{};
  int first = side.points.front().first;
  const auto put = [&] {
    for (std::size_t i = 0; i < sum.size(); ++i) out[std::size_t(first) + i] += sum[i];
  };
  for (std::size_t k = 0; k < light.size(); ++k) {
    const FaceSide::Point& p = side.points[k];
    if (p.first != first) put(), sum = {}, first = p.first;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += light[k] * p.basis[i];
  }
  put();
}

// The grid of a face.
LightPlanes face_nodes(const Level& source, int face, const FaceSide& side, double unit, const Colour& min_radiance) {
  const int many = side.points_a_texel();
  LightPlanes narrow(int(side.points.size()), side.nodes), out(side.nodes, side.nodes);
  parallel_for(narrow.rows, [&](int r) {
    const FaceSide::Point& down = side.points[std::size_t(r)];
    const auto light = light_of_row(side, source.row(face, r / many), down.at, unit * down.weight, min_radiance);
    for (std::size_t c = 0; c < 3; ++c) add_columns(side, light[c], narrow.row(r, int(c)));
    source.trim();
  });
  parallel_for(out.rows, [&](int node) {
    for (int r = 0; r < narrow.rows; ++r) {
      const FaceSide::Point& p = side.points[std::size_t(r)];
      if (node < p.first || node >= p.first + nodes_across) continue;
      for (int c = 0; c < 3; ++c) add_scaled(narrow.row(r, c), p.basis[std::size_t(node - p.first)], out.row(node, c));
    }
  });
  return out;
}

// A row of nodes as points of the latlong image.
std::vector<LightPoint> points_of(const LightPlanes& nodes, int face, const FaceSide& side, int row) {
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
void add_point(const LightPoint& p, int low, int high, LightPlanes& out) {
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
      const std::span<float> to = out.row(r, c);
      const std::size_t before = std::min(across.size(), to.size() - std::size_t(first));
      add_scaled(std::span(across).first(before), weight, to.subspan(std::size_t(first), before));
      if (before < across.size())
        add_scaled(std::span(across).subspan(before), weight, to.first(across.size() - before));
    }
  }
}

// Bands of rows take the points in one order, whatever the number of threads.
LightPlanes cube_planes(const Level& source, double mean, const Colour& min_radiance, int rows) {
  LightPlanes out(rows, 2 * rows);
  const FaceSide side(source.height(), rows);
  const int band = std::max(16, rows / 32);
  for (int face = 0; face < source.faces(); ++face) {
    const LightPlanes nodes = face_nodes(source, face, side, 1 / mean, min_radiance);
    std::vector<std::vector<LightPoint>> found(std::size_t(side.nodes));
    parallel_for(side.nodes, [&](int row) { found[std::size_t(row)] = points_of(nodes, face, side, row); });
    parallel_for((rows + band - 1) / band, [&](int b) {
      const int low = b * band, high = std::min(rows, low + band);
      const double near = (low - nodes_across) / double(rows), far = (high + nodes_across) / double(rows);
      for (const auto& row : found) {
        stop_point();
        for (const LightPoint& p : row)
          if (p.v >= near && p.v <= far) add_point(p, low, high, out);
      }
    });
  }
  return out;
}

}  // namespace

// The light of a latlong map on its finest grid.

namespace {

// Lays a row of texels on the columns of a grid. Columns a period apart have the same weights, a number of texels on.
class Across {
 public:
  Across(int width, int columns) : period_(columns / std::gcd(width, columns)), step_(width / (columns / period_)) {
    const Terms terms = adjoint(width, columns, true, [](double) { return 2 * pi; });
    int first = width, last = -width;
    const auto place = [&](int k, const Term& t) {  // Beside the column, not a turn away.
      const int middle = int((k + 0.5) * width / columns), offset = (t.from - middle + width + width / 2) % width;
      return middle + offset - width / 2;
    };
    for (int k = 0; k < period_; ++k)
      for (const Term& t : terms[std::size_t(k)])
        first = std::min(first, place(k, t)), last = std::max(last, place(k, t));
    first_ = first;
    for (int k = 0; k < period_; ++k) {
      int from = last, to = first;
      for (const Term& t : terms[std::size_t(k)]) from = std::min(from, place(k, t)), to = std::max(to, place(k, t));
      Phase& phase = phases_.emplace_back();
      phase.first = from - first;
      phase.weights.resize(std::size_t(to - from + 8) / 8 * 8);
      for (const Term& t : terms[std::size_t(k)]) phase.weights[std::size_t(place(k, t) - from)] = t.weight;
      reach_ = std::max(reach_, phase.first + int(phase.weights.size()));
    }
  }

  void apply(std::span<const float> texels, std::span<float> out) const {
    thread_local std::vector<float> padded, some;
    const int width = int(texels.size()), size = width + reach_;
    padded.resize(std::size_t(size));
    for (int k = 0, at = (first_ % width + width) % width, run = 0; k < size; k += run, at = 0) {
      run = std::min(size - k, width - at);
      std::copy_n(&texels[std::size_t(at)], run, &padded[std::size_t(k)]);
    }
    some.resize(out.size() / std::size_t(period_));
    for (std::size_t n = 0; n < phases_.size(); ++n) {
      const std::span to = period_ == 1 ? out : std::span(some);
      dot_products(std::span(padded).subspan(std::size_t(phases_[n].first)), std::size_t(step_), phases_[n].weights,
                   to);
      if (period_ > 1)
        for (std::size_t k = 0; k < to.size(); ++k) out[k * std::size_t(period_) + n] = to[k];
    }
  }

 private:
  struct Phase {
    int first = 0;
    std::vector<float> weights;
  };
  int period_, step_, first_ = 0, reach_ = 0;
  std::vector<Phase> phases_;
};

// The finest grid of a map twice as wide as high. Bands of rows read the rows of the source that they need, each once,
// in one order whatever the number of threads. @param unit of radiance.
LightPlanes latlong_planes(const Level& source, double unit, const Colour& min_radiance, int rows) {
  LightPlanes out(rows, 2 * rows);
  const Terms down = adjoint(source.height(), rows, false, [](double v) { return pi * portable::sin_pi(v); });
  const Across across(source.width(), 2 * rows);
  const double scale = 1 / unit;  // Beyond floats where light is subnormal.
  const int band = std::max(16, rows / 16);
  parallel_for((rows + band - 1) / band, [&](int b) {
    const int low = b * band, high = std::min(rows, low + band);
    std::vector<std::pair<Term, int>> terms;  // With the row that each adds to.
    for (int r = low; r < high; ++r)
      for (const Term& t : down[std::size_t(r)]) terms.emplace_back(t, r);
    std::ranges::stable_sort(terms, {}, [](const auto& t) { return t.first.from; });
    std::vector<float> texels(std::size_t(source.width()));
    std::array<std::vector<float>, 3> narrow;
    int read = -1;
    for (const auto& [term, to] : terms) {
      if (term.from != read) {
        stop_point();
        read = term.from;
        const auto row = source.row(0, read);
        for (int c = 0; c < 3; ++c) {
          for (std::size_t i = 0; i < texels.size(); ++i)
            texels[i] = float(double(row[i][c] - min_radiance[c]) * scale);
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

}  // namespace

// Levels of a source for multilevel summation.

namespace {

// A periodic row, padded on both sides, so that shifted rows are spans of it.
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

// The adjoint of interpolation from a grid to one twice as fine, whose nodes lie at -1/4 and +1/4 of a step.
struct Halving {
  Weights low, high;  // For the fine node left and right of a coarse node, from nodes -6 and -5 on.
  Halving() { lagrange(-0.25, low), lagrange(0.25, high); }
};
const Halving& halving() {
  static const Halving h;
  return h;
}

// Halves the columns of a row.
void halve(std::span<const float> in, std::span<float> out) {
  thread_local Wrapped even, odd;
  even.set(in, 2, 0), odd.set(in, 2, 1);
  std::ranges::fill(out, 0.F);
  for (int i = 0; i < nodes_across; ++i) {
    // Coarse node k takes from the fine nodes 2 (k - node) and 2 (k - node) + 1.
    add_scaled(even.from(half_nodes - i, out.size()), float(halving().low[std::size_t(i)]), out);
    add_scaled(odd.from(half_nodes - 1 - i, out.size()), float(halving().high[std::size_t(i)]), out);
  }
}

LightPlanes coarser(const LightPlanes& fine) {
  LightPlanes narrow(fine.rows, fine.columns / 2), out(fine.rows / 2, fine.columns / 2);
  parallel_for(fine.rows, [&](int r) {
    for (int c = 0; c < 3; ++c) halve(fine.row(r, c), narrow.row(r, c));
  });
  parallel_for(out.rows, [&](int k) {
    for (int i = 0; i < nodes_across; ++i)
      for (int side = 0; side < 2; ++side) {
        const int node = i - half_nodes + side;
        const int from = 2 * (k - node) + side, r = folded(from, fine.rows);
        const double w = side == 0 ? halving().low[std::size_t(i)] : halving().high[std::size_t(i)];
        for (int c = 0; c < 3; ++c) add_row(narrow.row(r, c), {r, r != from, float(w)}, out.row(k, c));
      }
  });
  return out;
}

// Takes rows near poles to fewer columns.
NodeGrid thinned(const LightPlanes& full) {
  NodeGrid grid(full.rows);
  parallel_for(full.rows, [&](int r) {
    std::vector<float> row, next;
    for (int c = 0; c < 3; ++c) {
      const auto all = full.row(r, c);
      row.assign(all.begin(), all.end());
      while (int(row.size()) > grid.columns[std::size_t(r)]) {
        next.resize(row.size() / 2);
        halve(row, next);
        std::swap(row, next);
      }
      std::ranges::copy(row, grid.channel(r, c));
    }
    grid.repeat_columns(r);
  });
  return grid;
}

}  // namespace

SourceGrids::SourceGrids(const Level& source, double unit, const Colour& min_radiance, int finest) {
  const bool latlong = source.projection() == Projection::latlong;
  LightPlanes planes =
      latlong ? latlong_planes(source, unit, min_radiance, finest) : cube_planes(source, unit, min_radiance, finest);
  grids_.push_back(thinned(planes));
  while (planes.rows > least_rows) {
    planes = coarser(planes);
    grids_.push_back(thinned(planes));
  }
}

}  // namespace envmap::prefiltering

// The light of a cube on its finest grid. Each face is laid on a grid of equal angles first, column by column and row
// by row. The nodes are points then.

#include <algorithm>

#include "envmap/base/parallel.h"
#include "envmap/maths/portable.h"
#include "envmap/maths/quadrature.h"
#include "envmap/prefilter/light_planes.h"
#include "envmap/projection/cube.h"
#include "envmap/projection/projection.h"

namespace envmap::prefiltering {

namespace {

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

// The light of a row of points of a face.
std::array<std::vector<float>, 3> light_of_row(const FaceSide& side, std::span<const Colour> texels, double down,
                                               double unit, const Colour& darkest) {
  const std::size_t count = side.points.size(), many = std::size_t(side.points_a_texel());
  std::array<std::vector<float>, 3> light;
  for (std::vector<float>& channel : light) channel.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    const FaceSide::Point& p = side.points[k];
    const double square = 1 + p.at * p.at + down * down, weight = unit * p.weight / (square * std::sqrt(square));
    const Colour texel = texels[k / many] - darkest;
    for (std::size_t c = 0; c < 3; ++c) light[c][k] = float(double(texel[int(c)]) * weight);
  }
  return light;
}

// A row of points on the columns of its grid. Points next to each other mostly share their nodes.
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

// All nodes of a face.
LightPlanes face_nodes(const Level& source, int face, const FaceSide& side, double unit, const Colour& darkest) {
  const int many = side.points_a_texel();
  LightPlanes narrow(int(side.points.size()), side.nodes), out(side.nodes, side.nodes);
  parallel_for(narrow.rows, [&](int r) {
    const FaceSide::Point& down = side.points[std::size_t(r)];
    const auto light = light_of_row(side, source.row(face, r / many), down.at, unit * down.weight, darkest);
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

// A row of nodes as points.
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

}  // namespace

// Bands of rows take the points in one order, whatever the number of threads.
LightPlanes cube_planes(const Level& source, double mean, const Colour& darkest, int rows) {
  LightPlanes out(rows, 2 * rows);
  const FaceSide side(source.height(), rows);
  const int band = std::max(16, rows / 32);
  for (int face = 0; face < source.faces(); ++face) {
    const LightPlanes nodes = face_nodes(source, face, side, 1 / mean, darkest);
    std::vector<std::vector<LightPoint>> found(std::size_t(side.nodes));
    parallel_for(side.nodes, [&](int row) { found[std::size_t(row)] = points_of(nodes, face, side, row); });
    parallel_for((rows + band - 1) / band, [&](int b) {
      const int low = b * band, high = std::min(rows, low + band);
      const double near = (low - nodes_across) / double(rows), far = (high + nodes_across) / double(rows);
      for (const auto& row : found)
        for (const LightPoint& p : row)
          if (p.v >= near && p.v <= far) add_point(p, low, high, out);
    });
  }
  return out;
}

}  // namespace envmap::prefiltering

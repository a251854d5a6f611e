#include "envmap/sample/area.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "envmap/sample/sample.h"
#include "envmap/sample/settle.h"

namespace envmap {
namespace {

constexpr int max_cells = 64;  // Along a side of a texel at the start.
constexpr int max_rounds = 9;

// A rectangle of the texel: its centre, its measure, and the radiance found at its centre.
struct Cell {
  Vec2<double> centre;
  double weight;
  Direction radiance;
};

// What one thread needs to sample many points at once; kept between texels so that nothing is allocated in the loop.
struct Workspace {
  std::vector<Vec2<double>> points;
  std::vector<Direction> directions;
  std::vector<Location<double>> locations;
  std::vector<double> densities;
  std::vector<Colour> radiance;
  std::vector<Cell> cells, fine, next;

  // Fills `out` with cells of one measure centred at `points`.
  void sample(const Area& task, int face, bool weigh, double measure, std::vector<Cell>& out) {
    const std::size_t n = points.size();
    directions.resize(n);
    locations.resize(n);
    densities.assign(n, 1);
    radiance.resize(n);
    envmap::directions(task.to, face, points, directions);
    for (Direction& d : directions) d = task.to_source * d;
    locate_for_bilinear(task.source.projection(), task.source.height(), directions, locations);
    sample_bilinear(task.source, locations, radiance);
    if (weigh) envmap::densities(task.to, points, densities);
    out.resize(n);
    for (std::size_t k = 0; k < n; ++k) out[k] = {points[k], densities[k] * measure, Direction(radiance[k])};
  }
};

double largest(const Direction& d) { return std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}); }

// How many source texels one texel of the result covers along its u and its v. The chain rule on the two direction
// maps: the source's derivative is inverted in its tangent plane by the normal equations.
Vec2<double> footprint(const Area& task, int face, const Vec2<double>& centre) {
  const double w = task.size * aspect(task.to), h = task.size;
  const Derivative out = derivative(task.to, {face, centre.x, centre.y}, 0.25 / h);
  Direction d[1];
  Location<double> at[1];
  directions(task.to, face, std::span(&centre, 1), d);
  d[0] = task.to_source * d[0];
  locate(task.source.projection(), d, at);
  const Derivative in = derivative(task.source.projection(), at[0], 0.25 / task.source.height());
  const Direction a = in.du / double(task.source.width()), b = in.dv / double(task.source.height());
  const double aa = glm::dot(a, a), ab = glm::dot(a, b), bb = glm::dot(b, b);
  const double det = std::max(aa * bb - ab * ab, 1e-6 * std::max(aa, bb) * std::max(aa, bb));
  const auto length = [&](const Direction& move) {
    const Direction m = task.to_source * move;
    const double ma = glm::dot(a, m), mb = glm::dot(b, m);
    return std::hypot(bb * ma - ab * mb, aa * mb - ab * ma) / std::max(det, 1e-300);
  };
  return {length(out.du / w), length(out.dv / h)};
}

void make_grid(std::vector<Vec2<double>>& points, const Rect& texel, int nu, int nv) {
  points.clear();
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nu; ++i)
      points.emplace_back(texel.u0 + (texel.u1 - texel.u0) * (i + 0.5) / nu,
                          texel.v0 + (texel.v1 - texel.v0) * (j + 0.5) / nv);
}

struct Total {
  double weight = 0;
  Direction radiance{0};
  void add(const Cell& c) {
    weight += c.weight;
    radiance += c.weight * c.radiance;
  }
  [[nodiscard]] Direction mean() const { return weight > 0 ? radiance / weight : Direction(0); }
};

Colour texel_mean(const Area& task, int face, const Rect& texel, const Direction& fallback, bool weigh, Workspace& ws) {
  const Vec2<double> covers = footprint(task, face, {0.5 * (texel.u0 + texel.u1), 0.5 * (texel.v0 + texel.v1)});
  const int nu = std::clamp(static_cast<int>(std::ceil(covers.x)), 1, max_cells);
  const int nv = std::clamp(static_cast<int>(std::ceil(covers.y)), 1, max_cells);
  Vec2<double> side{(texel.u1 - texel.u0) / nu, (texel.v1 - texel.v0) / nv};
  make_grid(ws.points, texel, nu, nv);
  ws.sample(task, face, weigh, side.x * side.y, ws.cells);

  Total accepted;
  Direction mean{0};
  double whole = 0;
  for (int round = 0; round < max_rounds; ++round) {
    ws.points.clear();
    for (const Cell& c : ws.cells)
      for (int quarter = 0; quarter < 4; ++quarter)
        ws.points.emplace_back(c.centre.x + (quarter & 1 ? 0.25 : -0.25) * side.x,
                               c.centre.y + (quarter & 2 ? 0.25 : -0.25) * side.y);
    side *= 0.5;
    ws.sample(task, face, weigh, side.x * side.y, ws.fine);

    Total now = accepted;
    for (const Cell& c : ws.fine) now.add(c);
    mean = now.mean();
    whole = now.weight;

    // The mean is a ratio, so what counts is the error of weight x (radiance - mean).
    const double allowed = 2 * task.tolerance * std::max(largest(mean), task.floor) * whole;
    const double each = allowed / std::sqrt(static_cast<double>(ws.cells.size()));
    ws.next.clear();
    for (std::size_t k = 0; k < ws.cells.size(); ++k) {
      const Cell* quarters = &ws.fine[4 * k];
      Direction difference = -ws.cells[k].weight * (ws.cells[k].radiance - mean);
      for (int q = 0; q < 4; ++q) difference += quarters[q].weight * (quarters[q].radiance - mean);
      const bool done = whole > 0 && largest(difference) <= each;
      for (int q = 0; q < 4; ++q) done ? accepted.add(quarters[q]) : ws.next.push_back(quarters[q]);
    }
    if (ws.next.empty()) break;
    std::swap(ws.cells, ws.next);
  }
  if (whole > 0) return Colour(mean);
  // A sliver inside the rim that no sample met.
  Location<double> at[1];
  const Direction d = task.to_source * fallback;
  locate(task.source.projection(), std::span(&d, 1), at);
  return bilinear(task.source, at[0]);
}

}  // namespace

void sample_area(const Area& task, int face, int row, int first, std::span<Colour> out) {
  static thread_local Workspace ws;
  const double w = task.size * aspect(task.to), h = task.size;
  std::vector<Direction> centres(out.size());
  texel_directions(task.to, task.size, face, row, first, centres);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double i = first + static_cast<double>(k);
    const Rect texel{i / w, row / h, (i + 1) / w, (row + 1) / h};
    // Corners of a paraboloid's square lie outside the disc: they have no solid angle, and any even weight will do.
    const double s = std::clamp(0.5, texel.u0, texel.u1) - 0.5, t = std::clamp(0.5, texel.v0, texel.v1) - 0.5;
    const bool weigh = !on_disc(task.to) || s * s + t * t < 0.25;
    out[k] = texel_mean(task, face, texel, centres[k], weigh, ws);
  }
}

}  // namespace envmap

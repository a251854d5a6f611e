// Means over texels by cells of four Gauss points each, quartered where their bound is above what the texel allows: the
// cells of one texel share its tolerance as if their errors were independent.
#include "envmap/sample/adaptive.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "envmap/maths/quadrature.h"
#include "envmap/sample/footprint.h"
#include "envmap/sample/inverse_bilinear.h"
#include "envmap/sample/point.h"

namespace envmap {
namespace {

constexpr int max_cells = 64;               // Along a side of a texel at the start.
constexpr std::size_t max_samples = 65536;  // In one texel.
// Near -Z of a sphere map, where texels span tens of degrees, some never settle; four times as many change 6e-7 in rms.
constexpr std::size_t max_samples_of_sphere = 8192;
constexpr int max_rounds = 12;  // A cell round a pole stays wide however often it is quartered.

struct Area {
  const PaddedLevel& source;
  Target target;
  double tolerance, floor;
};

// A cell of the texel by its centre, what its samples add, and how far off that may be for every unit of its size.
struct Cell {
  Point2 centre;
  double weight;
  Rgb<double> sum;              // Weight x radiance.
  double kink = 0, smooth = 0;  // Ranges of radiance over kinks and over smooth stretches, times weight.
  double rim = 0;               // Weight that the disc's rim may have cut wrongly.
  double size;                  // In source texels, if all on one face; else 0.
  Rgb<double> low, high;        // Of the radiance it may hold.
};

double largest(const Rgb<double>& d) { return std::max({d.x, d.y, d.z}); }

// What one thread needs to evaluate many cells at once; kept between texels so that nothing is allocated in the loop.
struct Workspace {
  std::vector<Point2> points;
  std::vector<Direction> directions;
  std::vector<Location<double>> locations;
  std::vector<double> densities;
  std::vector<Colour> colours;
  std::vector<Cell> cells, next;

  // Samples cells of one size, given by their centres.
  void evaluate(const Area& task, int face, bool weigh, const Point2& side) {
    constexpr double gauss = 0.5 * 0.57735026918962576;  // 1 / sqrt(3) of half a side.
    points.clear();
    for (const Cell& c : cells)
      for (int k = 0; k < 4; ++k)
        points.emplace_back(c.centre.x + (k & 1 ? gauss : -gauss) * side.x,
                            c.centre.y + (k & 2 ? gauss : -gauss) * side.y);
    directions.resize(points.size());
    locations.resize(points.size());
    colours.resize(points.size());
    densities.resize(points.size());
    envmap::directions(task.target.to, face, points, directions);
    task.target.bring_to_source(directions);
    locate_for_bilinear(task.source.projection(), task.source.height(), directions, locations);
    sample_bilinear(task.source, locations, colours);
    if (weigh)
      envmap::densities(task.target.to, points, densities);
    else
      for (std::size_t k = 0; k < points.size(); ++k) {
        const Derivative d = derivative(task.target.to, {face, points[k].x, points[k].y}, 0.25 / task.target.size);
        densities[k] = glm::length(glm::cross(d.du, d.dv));
      }
    for (std::size_t k = 0; k < cells.size(); ++k) {
      gather(task.source, &locations[4 * k], &colours[4 * k], &densities[4 * k], side.x * side.y, cells[k]);
      cells[k].rim =
          weigh && on_disc(task.target.to) ? side.x * side.y * rim_density(task.target.to, cells[k].centre, side) : 0;
    }
  }

  // Of a cell that the rim cuts, the density at its corner nearest the middle: there it is largest. Else 0.
  static double rim_density(Projection p, const Point2& centre, const Point2& side) {
    const Point2 c = glm::abs(centre - 0.5), nearest = glm::max(c - 0.5 * side, Point2(0));
    if (glm::length(nearest) >= 0.5 || glm::length(c + 0.5 * side) <= 0.5) return 0;
    return density_at(p, 0.5 + nearest);
  }

  static void gather(const PaddedLevel& source, const Location<double>* at, const Colour* colour, const double* density,
                     double measure, Cell& cell) {
    cell.weight = 0;
    cell.sum = Rgb<double>(0);
    bool one_face = true;
    Rect box{1e300, 1e300, -1e300, -1e300};
    double round0 = 1e300, round1 = -1e300;  // The same about the seam of a latlong map.
    for (int k = 0; k < 4; ++k) {
      const double x = at[k].u * source.width() - 0.5, y = at[k].v * source.height() - 0.5;
      box = {std::min(box.u0, x), std::min(box.v0, y), std::max(box.u1, x), std::max(box.v1, y)};
      const double round = at[k].u < 0.5 ? x + source.width() : x;
      round0 = std::min(round0, round), round1 = std::max(round1, round);
      one_face &= facet(source.projection(), at[k]) == facet(source.projection(), at[0]);
      const double w = 0.25 * measure * density[k];
      cell.weight += w;
      cell.sum += w * Rgb<double>(colour[k]);
    }

    // The whole cell reaches sqrt(3) as far from its centre as its samples do.
    const double mx = 0.5 * (std::numbers::sqrt3 - 1) * (box.u1 - box.u0),
                 my = 0.5 * (std::numbers::sqrt3 - 1) * (box.v1 - box.v0);
    box = {box.u0 - mx, box.v0 - my, box.u1 + mx, box.v1 + my};
    Colour low(std::numeric_limits<float>::max()), high(0);
    const bool seam = source.projection() == Projection::latlong;
    const double across = (seam ? std::min(box.u1 - box.u0, std::numbers::sqrt3 * (round1 - round0)) : box.u1 - box.u0);
    cell.size = one_face ? std::max(across, box.v1 - box.v0) : 0;
    if (one_face && box.u1 - box.u0 < 4 && box.v1 - box.v0 < 4) {
      add_range(source, at[0].face, box, low, high);
    } else {  // Over an edge or round the seam: about each sample.
      for (int k = 0; k < 4; ++k) {
        const double x = at[k].u * source.width() - 0.5, y = at[k].v * source.height() - 0.5;
        add_range(source, at[k].face, {x - 1, y - 1, x + 1, y + 1}, low, high);
      }
    }
    const bool one_patch =
        one_face && std::floor(box.u0) == std::floor(box.u1) && std::floor(box.v0) == std::floor(box.v1);
    cell.low = low;
    cell.high = high;
    (one_patch ? cell.smooth : cell.kink) = largest(cell.high - cell.low) * cell.weight;
  }

  // Least and largest of the texels that the reconstruction uses in a box.
  static void add_range(const PaddedLevel& source, int face, const Rect& box, Colour& low, Colour& high) {
    constexpr int g = Level::padding;
    const auto whole = [](double x, int n) { return std::clamp(int(std::floor(x)), -g, n + g - 1); };
    const int i0 = whole(box.u0, source.width()), i1 = whole(box.u1 + 1, source.width());
    for (int j = whole(box.v0, source.height()); j <= whole(box.v1 + 1, source.height()); ++j)
      for (const Colour* c = source.texel(face, i0, j); c <= source.texel(face, i1, j); ++c) {
        low = glm::min(low, *c);
        high = glm::max(high, *c);
      }
  }
};

// Bound of a cell's error: the range of the values times the cell's size in source texels, times what the rule misses
// of a kink (0.04 of its height at worst, which is twice the slope), or of a smooth stretch, or of the rim. A cell that
// spans many source texels has none; but the whole rim of a sphere map is one direction, where neighbours in the result
// are found far apart with much the same radiance: small cells are judged by what that is about their samples.
double error_bound(const Cell& c, const Rgb<double>& mean, double cell_size, bool sphere) {
  const double size = std::max(c.size, cell_size),
               off = largest(glm::max(glm::abs(c.high - mean), glm::abs(c.low - mean)));
  const double rim = 0.25 * c.rim * off;
  if (size <= 1) return size * (c.kink / 13 + c.smooth / 1000) + rim;
  if (c.weight == 0 && c.rim == 0) return 0;
  return sphere && cell_size < 0.125 ? c.weight * off + rim : std::numeric_limits<double>::infinity();
}

// The cells that a texel begins with: as many as it covers source texels.
struct CellGrid {
  Point2 side;
  double size;  // In source texels.

  CellGrid(const Area& task, int face, const Rect& texel, std::vector<Cell>& cells) {
    const Jacobian moved = jacobian(task.target, task.source.projection(), task.source.height(), face,
                                    {0.5 * (texel.u0 + texel.u1), 0.5 * (texel.v0 + texel.v1)});
    const Point2 covers{glm::length(moved.du), glm::length(moved.dv)};
    const int nu = std::clamp(int(std::ceil(covers.x)), 1, max_cells);
    const int nv = std::clamp(int(std::ceil(covers.y)), 1, max_cells);
    side = {(texel.u1 - texel.u0) / nu, (texel.v1 - texel.v0) / nv};
    size = std::max(covers.x / nu, covers.y / nv);
    cells.clear();
    for (int j = 0; j < nv; ++j)
      for (int i = 0; i < nu; ++i)
        cells.push_back({.centre = {texel.u0 + (i + 0.5) * side.x, texel.v0 + (j + 0.5) * side.y}});
  }
  void halve() { side *= 0.5, size *= 0.5; }
};

struct Mean {
  Rgb<double> sum{0};
  double weight = 0;

  void add(const Cell& c) { sum += c.sum, weight += c.weight; }
  [[nodiscard]] Rgb<double> value() const { return weight > 0 ? sum / weight : Rgb<double>(0); }
};

// Adds the cells that are accurate enough to `done`, and leaves the quarters of the others.
void quarter(const Area& task, const CellGrid& grid, const Mean& whole, Workspace& ws, Mean& done) {
  const Rgb<double> mean = whole.value();
  const bool sphere = task.source.projection() == Projection::sphere;
  const double allowed = task.tolerance * std::max(largest(mean), task.floor) * whole.weight;
  const double each = allowed / std::sqrt(double(ws.cells.size()));
  ws.next.clear();
  for (const Cell& c : ws.cells) {
    if (error_bound(c, mean, grid.size, sphere) <= each) {
      done.add(c);
      continue;
    }
    for (int k = 0; k < 4; ++k)
      ws.next.push_back({.centre = {c.centre.x + (k & 1 ? 0.25 : -0.25) * grid.side.x,
                                    c.centre.y + (k & 2 ? 0.25 : -0.25) * grid.side.y}});
  }
}

Colour texel_mean(const Area& task, int face, const Rect& texel, const Direction& centre, bool weigh, Workspace& ws) {
  const std::size_t most = task.source.projection() == Projection::sphere ? max_samples_of_sphere : max_samples;
  CellGrid grid(task, face, texel, ws.cells);
  Mean done, whole;
  std::size_t samples = 0;
  for (int round = 0; round < max_rounds; ++round) {
    ws.evaluate(task, face, weigh, grid.side);
    samples += ws.points.size();
    whole = done;
    for (const Cell& c : ws.cells) whole.add(c);
    quarter(task, grid, whole, ws, done);
    if (ws.next.empty() || samples + 4 * ws.next.size() > most) break;
    std::swap(ws.cells, ws.next);
    grid.halve();
  }
  if (whole.weight > 0) return Colour(whole.value());
  // A sliver inside the rim that no sample met.
  Direction d = centre;
  task.target.bring_to_source({&d, 1});
  return bilinear(task.source, locate(task.source.projection(), d));
}

void sample_area(const Area& task, int face, int row, int first, std::span<Colour> out) {
  static thread_local Workspace ws;
  const double w = task.target.size * aspect(task.target.to), h = task.target.size;
  std::vector<Direction> centres(out.size());
  texel_directions(task.target.to, task.target.size, face, row, first, centres);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double i = first + double(k);
    const Rect texel{i / w, row / h, (i + 1) / w, (row + 1) / h};
    // Corners of a paraboloid's square lie outside the disc: no solid angle, but what the projection continues to has.
    const double s = std::clamp(0.5, texel.u0, texel.u1) - 0.5, t = std::clamp(0.5, texel.v0, texel.v1) - 0.5;
    const bool weigh = !on_disc(task.target.to) || s * s + t * t < 0.25;
    out[k] = texel_mean(task, face, texel, centres[k], weigh, ws);
  }
}

}  // namespace

Sampler adaptive_sampler(const PaddedLevel& source, const Target& target, double tolerance, double floor) {
  const Area task{source, target, tolerance, floor};
  return [task](int face, int row, int first, std::span<Colour> out) { sample_area(task, face, row, first, out); };
}

Colour adaptive_mean(const PaddedLevel& source, const Target& target, double tolerance, double floor, int face,
                     const Point2& low, const Point2& high) {
  static thread_local Workspace ws;
  const Area task{source, target, tolerance, floor};
  return texel_mean(task, face, {low.x, low.y, high.x, high.y}, direction_at(target.to, face, 0.5 * (low + high)), true,
                    ws);
}

}  // namespace envmap

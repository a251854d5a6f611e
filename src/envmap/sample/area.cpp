#include "envmap/sample/area.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "envmap/base/parallel.h"
#include "envmap/maths/polygon.h"
#include "envmap/maths/portable.h"
#include "envmap/projection/visit.h"
#include "envmap/sample/adaptive.h"
#include "envmap/sample/coverage.h"
#include "envmap/sample/outline.h"
#include "envmap/sample/point.h"

namespace envmap {
namespace {

constexpr std::size_t most_pieces = 4096;  // That a side of a texel is followed by.
constexpr std::size_t rim_pieces = 64;    // Of a texel that a disc's rim cuts, at the least.

// A side that bends by half the tolerance puts that much of a sun into the wrong one of two texels; what else there
// is goes wrong by a tenth of it.
constexpr double bend_for_error = 0.5;

struct Task {
  const PaddedLevel& source;
  Target target;
  double tolerance;
  int division;  // Of the source's texels, along a side.

  void find(Sides& sides, int face, int row, int first, std::size_t texels, std::size_t pieces, bool inside) const {
    sides.face = face, sides.row = row, sides.first = first, sides.texels = texels, sides.pieces = pieces;
    sides.find(target, source.projection(), inside);
  }
};

// What one thread works with; kept, so that nothing is allocated for a texel.
struct Workspace {
  Sides sides;
  Outline outline;
  std::vector<Point2> centres, cut;
  std::vector<double> densities;
  Coverage coverage;
  std::vector<std::size_t> open, again;
};

struct Mean {
  Rgb<double> light{0};
  double weight = 0;
};

void integrate(const PaddedLevel& source, int face, std::span<const Point2> polygon, Workspace& ws, Mean& mean) {
  Coverage& c = ws.coverage;
  c.cover(polygon);
  ws.centres.clear();
  for (int j = c.top(); j < c.top() + c.rows(); ++j)
    for (int i = c.left(); i < c.left() + c.columns(); ++i)
      ws.centres.emplace_back((i + 0.5) / source.width(), (j + 0.5) / source.height());
  ws.densities.resize(ws.centres.size());
  densities(source.projection(), ws.centres, ws.densities);
  const double* weight = c.weights(ws.densities).data();
  const int w = source.width();
  const bool over_seam = source.projection() == Projection::latlong && (c.left() < 0 || c.left() + c.columns() > w);
  for (int j = c.top(); j < c.top() + c.rows(); ++j) {
    const Colour* texels = source.texel(face, 0, j);
    for (int i = c.left(); i < c.left() + c.columns(); ++i, ++weight) {
      mean.light += *weight * Rgb<double>(texels[over_seam ? (i % w + w) % w : i]);
      mean.weight += *weight;
    }
  }
}

// Over the edges of a cube, face by face: great circles are straight on all of them. False where the outline passes behind
// the plane of a face.
bool integrate_over_edges(const PaddedLevel& source, std::size_t texel, Workspace& ws, Mean& mean) {
  const double size = source.height();
  unsigned faces = 0;
  ws.sides.around(texel, [&](std::size_t k) { faces |= 1U << ws.sides.places[k].face; });
  for (int face = 0; face < Cube::faces; ++face) {
    if ((faces >> face & 1) == 0) continue;
    bool before = true;
    ws.outline.points.clear();
    ws.sides.around(texel, [&](std::size_t k) {
      const Direction& d = ws.sides.directions[k];
      before &= glm::dot(d, Cube::axes[face].forward) > 0.1;
      if (before) ws.outline.points.push_back(in_texels(source, Cube::continued(face, d)));
    });
    if (!before) return false;
    const Direction edges[] = {{1, 0, 0.5}, {-1, 0, size - 0.5}, {0, 1, 0.5}, {0, -1, size - 0.5}};
    for (const Direction& edge : edges) {
      cut(ws.outline.points, edge.x, edge.y, edge.z, ws.cut);
      std::swap(ws.cut, ws.outline.points);
    }
    if (ws.outline.points.size() > 2) integrate(source, face, ws.outline.points, ws, mean);
  }
  return true;
}

enum class Outcome { done, bent, unsuitable };

Outcome texel_mean(const Task& task, std::size_t texel, Workspace& ws, Colour& out) {
  Mean mean;
  if (ws.outline.follow(task.source, task.target, ws.sides, texel)) {
    if (ws.outline.bend(task.tolerance, task.division) > 1) return Outcome::bent;
    integrate(task.source, ws.outline.face, ws.outline.points, ws, mean);
  } else if (task.source.projection() == Projection::cube) {
    if (ws.sides.pieces < 8) return Outcome::bent;
    if (!integrate_over_edges(task.source, texel, ws, mean)) return Outcome::unsuitable;
  }
  if (!(mean.weight > 0)) return Outcome::unsuitable;
  out = Colour(mean.light / mean.weight);
  return Outcome::done;
}

// Whether the rim of a disc cuts the texel.
bool on_rim(const Target& target, int row, int i) {
  if (!on_disc(target.to)) return false;
  const double n = target.size, x0 = i / n - 0.5, y0 = row / n - 0.5, x1 = x0 + 1 / n, y1 = y0 + 1 / n;
  return portable::hypot(std::clamp(0.0, x0, x1), std::clamp(0.0, y0, y1)) < 0.5 &&
         portable::hypot(std::max(-x0, x1), std::max(-y0, y1)) > 0.5;
}

constexpr int block = 32;  // Texels of a row that get as many pieces a side. Blocks begin at multiples of this, or the
                           // result would depend on how a row is taken apart.

// Pieces a side for the tolerance, by the texels at the ends and in the middle of a block. With one piece there is nothing
// to see a bend by: it must be far from one.
std::size_t pieces_for(const Task& task, int face, int row, int any_of_block, Workspace& ws) {
  const Columns in = columns(task.target.to, task.target.size, row);
  const int begin = any_of_block / block * block, first = std::max(in.first, begin),
            last = std::min(in.end, begin + block) - 1;
  double most = 0;
  for (const int column : {first, (first + last) / 2, last}) {
    task.find(ws.sides, face, row, column, 1, 4, false);
    const bool outline = ws.outline.follow(task.source, task.target, ws.sides, 0);
    most = std::max(most, outline ? ws.outline.bend(task.tolerance, task.division) : 1);
  }
  const double pieces = 4 * std::sqrt(1.2 * most);
  return pieces < 0.5 ? 1 : std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(pieces)), 2, 16);
}

// Texels of one block; those that need more pieces one by one, with four times as many each time.
void sample_block(const Task& task, const Sampler& otherwise, int face, int row, int first, std::span<Colour> out) {
  static thread_local Workspace ws;
  const auto column = [&](std::size_t k) { return first + static_cast<int>(k); };
  std::size_t pieces = pieces_for(task, face, row, first, ws);
  task.find(ws.sides, face, row, first, out.size(), pieces, false);
  ws.open.clear();
  for (std::size_t k = 0; k < out.size(); ++k)
    if (on_rim(task.target, row, column(k)) || texel_mean(task, k, ws, out[k]) != Outcome::done) ws.open.push_back(k);
  for (pieces = std::max<std::size_t>(8, 4 * pieces); !ws.open.empty(); pieces *= 4) {
    std::swap(ws.open, ws.again);
    ws.open.clear();
    for (const std::size_t k : ws.again) {
      const bool rim = on_rim(task.target, row, column(k));
      task.find(ws.sides, face, row, column(k), 1, rim ? std::max(pieces, rim_pieces) : pieces, rim);
      const Outcome outcome = texel_mean(task, 0, ws, out[k]);
      if (outcome == Outcome::bent && 4 * pieces <= most_pieces)
        ws.open.push_back(k);
      else if (outcome != Outcome::done)
        otherwise(face, row, column(k), out.subspan(k, 1));
    }
  }
}

// By what odd factor the texels of a source must be divided for a tolerance: densities are taken as linear over a texel,
// which leaves an eighth of their second derivative. 0 where the finer source would be too large.
int division_for(const PaddedLevel& source, double tolerance) {
  constexpr double most_texels = 4096.0 * 4096;
  const double texel = visit(source.projection(), [](auto q) { return decltype(q)::span; }) * pi / 180 / source.height();
  int times = 1;
  while (0.2 * texel * texel > tolerance * times * times) times += 2;
  return times == 1 || static_cast<double>(source.faces()) * source.width() * source.height() * times * times < most_texels ? times : 0;
}

// The same reconstruction from texels an odd number of times as small: their centres meet those of the source's, and a
// part of a bilinear patch is bilinear.
PaddedLevel divided(const PaddedLevel& source, int times) {
  Level fine(source.projection(), source.height() * times, source.width() * times, source.max_memory());
  for_each_row(fine.faces(), fine.height(), {}, [&](int face, int row) {
    const std::span<Colour> out = fine.row(face, row);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = bilinear(source, {face, (static_cast<double>(i) + 0.5) / fine.width(), (row + 0.5) / fine.height()});
    fine.trim();
  });
  return PaddedLevel(std::move(fine));
}

}  // namespace

Sampler area_sampler(const PaddedLevel& source, const Target& target, double tolerance, double floor) {
  const Sampler otherwise = adaptive_sampler(source, target, tolerance, floor);
  const int times = division_for(source, tolerance);
  if (times == 0) return otherwise;
  const auto finer = times > 1 ? std::make_shared<const PaddedLevel>(divided(source, times)) : nullptr;
  const Task task{finer ? *finer : source, target, bend_for_error * tolerance, times};
  return [finer, task, otherwise](int face, int row, int first, std::span<Colour> out) {
    while (!out.empty()) {
      const auto count = std::min(out.size(), static_cast<std::size_t>(block - first % block));
      sample_block(task, otherwise, face, row, first, out.first(count));
      first += static_cast<int>(count);
      out = out.subspan(count);
    }
  };
}

}  // namespace envmap

#include "envmap/sample/area.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "envmap/base/parallel.h"
#include "envmap/maths/portable.h"
#include "envmap/projection/visit.h"
#include "envmap/sample/adaptive.h"
#include "envmap/sample/coverage.h"
#include "envmap/sample/outline.h"
#include "envmap/sample/point.h"

namespace envmap {
namespace {

constexpr std::size_t max_pieces = 4096;  // That a side of a texel is followed by.
constexpr std::size_t rim_pieces = 64;    // Of a texel that a disc's rim cuts, at the least.

// A side that bends by half the tolerance puts that much of a sun into the wrong one of two texels, and moves other
// light by a tenth of it.
constexpr double bend_for_error = 0.5;
// Limits of an estimated mean: the bend of its sides over the texel's thickness, and the error by a sun over the
// tolerance.
constexpr double most_bend = 1.0 / 16, most_over = 16;
constexpr Colour unknown(std::numeric_limits<float>::quiet_NaN());

// What became of a texel's mean.
enum class Outcome {
  done,        // Its sides are within the tolerance.
  estimated,   // Its sides are not, and pieces twice as long gave nearly the same mean.
  bent,        // Its sides bend too much: shorter pieces are needed.
  unsuitable,  // It has no outline.
};

struct Task {
  const PaddedLevel& source;
  Target target;
  double tolerance;
  int division;    // Of the source's texels, along a side.
  double floor;    // Radiance below which errors are absolute.
  bool estimates;  // Takes means that hardly change with shorter pieces, too.

  void find(Sides& sides, int face, int row, int first, std::size_t texels, std::size_t pieces, bool inside) const {
    sides.face = face, sides.row = row, sides.first = first, sides.texels = texels, sides.pieces = pieces;
    sides.find(target, source.projection(), inside);
  }

  // The error of a texel's sides over what the tolerance allows.
  [[nodiscard]] double relative_error(const Outline::Shape& shape, double off) const {
    return off / (tolerance * std::min<double>(division, shape.thickness));
  }
  // Whether sides of such a relative error are within the tolerance, or may be tried for an estimate.
  [[nodiscard]] Outcome outcome_of(double off) const {
    return off <= 1 ? Outcome::done : estimates && off * tolerance < most_bend ? Outcome::estimated : Outcome::bent;
  }
  // Whether a mean hardly differs from that of pieces twice as long: its error is less than the difference.
  [[nodiscard]] bool has_converged(const Colour& before, const Colour& now) const {
    for (int c = 0; c < 3; ++c)
      if (!(std::abs(now[c] - before[c]) <= tolerance * std::max<double>(now[c], floor))) return false;
    return true;
  }
  // Whether a texel as bright as `high` could matter if it lay where sides are off.
  [[nodiscard]] bool may_cut_sun(double off, const Colour& high, const Colour& mean) const {
    for (int c = 0; c < 3; ++c)
      if (off * high[c] > most_over * std::max<double>(mean[c], floor)) return true;
    return false;
  }
};

// A corner of a texel's outline cut by planes: a direction, and whether the outline may turn there.
struct Corner {
  Direction direction;
  bool turns;
};

// The part where dot(side, d) >= 0 (Sutherland and Hodgman 1974, as in polygon.h). A corner that lies on the plane but
// for rounding is the cut itself: a second one beside it would make a piece of which rounding is the direction.
void cut(const std::vector<Corner>& corners, const Direction& side, std::vector<Corner>& out) {
  constexpr double rounding = 1e-10;
  const auto above = [&side](const Corner& c) {
    const double d = glm::dot(side, c.direction);
    return std::abs(d) < rounding ? 0 : d;
  };
  out.clear();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Corner &p = corners[k], &q = corners[k + 1 < corners.size() ? k + 1 : 0];
    const double dp = above(p), dq = above(q);
    if (dp >= 0) out.push_back({p.direction, p.turns || dp == 0});
    if (dp * dq < 0) out.push_back({glm::normalize(glm::mix(p.direction, q.direction, dp / (dp - dq))), true});
  }
}

// What one thread works with; kept, so that nothing is allocated for a texel.
struct Workspace {
  Sides sides;
  Outline outline;
  std::vector<Corner> around, piece, cut;
  std::array<Outline, 8> parts;  // By facet.
  std::vector<Point2> centres;
  std::vector<double> densities;
  Coverage coverage;
  std::vector<std::size_t> open, again;
};

struct Mean {
  Rgb<double> light{0};
  double weight = 0;
  Colour high{0};  // The brightest below.
  double off = 0;  // What the sides are off by, over what they may be.
};

void integrate(const PaddedLevel& source, int facet, std::span<const Point2> polygon, Workspace& ws, Mean& mean) {
  Coverage& c = ws.coverage;
  c.cover(polygon);
  ws.centres.clear();
  for (const Coverage::Run& run : c.runs())
    for (int i = run.first; i < run.first + run.count; ++i)
      ws.centres.emplace_back((i + 0.5) / source.width(), (run.row + 0.5) / source.height());
  ws.densities.resize(ws.centres.size());
  facet_densities(source.projection(), facet, ws.centres, ws.densities);
  const int face = facet % source.faces();
  const double* weight = c.weights(ws.densities).data();
  const int w = source.width();
  for (const Coverage::Run& run : c.runs()) {
    const Colour* texels = source.texel(face, 0, run.row);
    const bool over_seam = source.projection() == Projection::latlong && (run.first < 0 || run.first + run.count > w);
    for (int i = run.first; i < run.first + run.count; ++i, ++weight) {
      const Colour& texel = texels[over_seam ? (i % w + w) % w : i];
      mean.light += *weight * Rgb<double>(texel);
      mean.high = glm::max(mean.high, texel);
      mean.weight += *weight;
    }
  }
}

// The part of a texel's outline on each facet, cut out by the facet's planes. Great circles through the middle of the
// sphere are straight on all facets' sides.
template <Faceted P>
void cut_by_facet(const PaddedLevel& source, int facet, std::span<const Corner> around, Workspace& ws, Outline& out) {
  ws.piece.assign(around.begin(), around.end());
  for (const Direction& side : P::sides(facet)) {
    cut(ws.piece, side, ws.cut);
    std::swap(ws.piece, ws.cut);
  }
  out.begin(facet, 0);
  for (const Corner& c : ws.piece) out.add(in_texels(source, P::continued(facet, c.direction)), c.turns);
  if (!ws.piece.empty()) out.add(out.points.front(), true);
}

// Over the edges of a cube or the creases of an octahedral map, facet by facet. Texels wider than 160 degrees are not
// clipped, because inside and outside become ambiguous.
template <Faceted P>
Outcome integrate_by_facets(const Task& task, std::size_t texel, Workspace& ws, Mean& mean) {
  constexpr double cosine_of_most = 0.17;
  if (ws.sides.pieces < 8) return Outcome::bent;
  Direction middle(0);
  std::size_t n = 0;
  ws.around.clear();
  ws.sides.around(texel, [&](std::size_t k) {
    ws.around.push_back({ws.sides.directions[k], ws.sides.is_corner(k, n++)});
    middle += ws.around.back().direction;
  });
  ws.around.pop_back();  // The first again.
  middle = glm::normalize(middle);
  for (const Corner& c : ws.around)
    if (!(glm::dot(c.direction, middle) > cosine_of_most)) return Outcome::unsuitable;

  Outline::Shape shape{0, 0, 0};
  for (int facet = 0; facet < P::facets; ++facet) {
    Outline& part = ws.parts[std::size_t(facet)];
    cut_by_facet<P>(task.source, facet, ws.around, ws, part);
    if (part.points.size() < 4) continue;
    const Outline::Shape s = part.shape();
    shape = {std::max(shape.bend, s.bend), std::max(shape.error, s.error), std::max(shape.thickness, s.thickness)};
    part.move_out();
  }
  mean.off = task.relative_error(shape, shape.error);
  const Outcome outcome = task.outcome_of(mean.off);
  if (outcome == Outcome::bent) return outcome;
  for (const Outline& part : std::span(ws.parts).first(P::facets))
    if (part.points.size() >= 4) integrate(task.source, part.facet, part.points, ws, mean);
  return outcome;
}

Outcome texel_mean(const Task& task, std::size_t texel, Workspace& ws, Colour& out) {
  Mean mean;
  Outcome outcome;
  if (ws.outline.follow(task.source, task.target, ws.sides, texel)) {
    const Outline::Shape shape = ws.outline.shape();
    mean.off = task.relative_error(shape, shape.error);
    outcome = task.outcome_of(mean.off);
    if (outcome == Outcome::bent) return outcome;
    ws.outline.move_out();
    integrate(task.source, ws.outline.facet, ws.outline.points, ws, mean);
  } else {
    outcome = visit(task.source.projection(), [&](auto q) {
      if constexpr (Faceted<decltype(q)>)
        return integrate_by_facets<decltype(q)>(task, texel, ws, mean);
      else
        return Outcome::unsuitable;
    });
    if (outcome >= Outcome::bent) return outcome;
  }
  if (!(mean.weight > 0)) return Outcome::unsuitable;
  out = Colour(mean.light / mean.weight);
  if (task.estimates && task.may_cut_sun(mean.off, mean.high, out))
    return outcome == Outcome::done ? Outcome::estimated : Outcome::bent;
  return outcome;
}

constexpr int block = 32;  // Texels of a row that get as many pieces a side. Blocks begin at multiples of this, or the
                           // result would depend on how a row is taken apart.

// Pieces a side for the tolerance, by the texels at the ends and in the middle of a block. With one piece there is
// nothing to see a bend by: it must be far from one.
std::size_t pieces_for(const Task& task, int face, int row, int any_of_block, Workspace& ws) {
  const Columns in = columns(task.target.to, task.target.size, row);
  const int begin = any_of_block / block * block, first = std::max(in.first, begin),
            last = std::min(in.end, begin + block) - 1;
  double bend = 0, error = 0;
  for (const int column : {first, (first + last) / 2, last}) {
    task.find(ws.sides, face, row, column, 1, 4, false);
    const bool outline = ws.outline.follow(task.source, task.target, ws.sides, 0);
    const Outline::Shape shape = outline ? ws.outline.shape() : Outline::Shape{task.tolerance, task.tolerance, 1};
    bend = std::max(bend, task.relative_error(shape, shape.bend)),
    error = std::max(error, task.relative_error(shape, shape.error));
  }
  // The bend falls with the square of the pieces, the error with their fourth power once they are shorter than a texel.
  const double root = std::sqrt(1.2 * error), pieces = 4 * (error < bend ? std::sqrt(root) : root);
  const auto whole =
      4 * std::sqrt(1.2 * bend) < 0.5 ? 1 : std::clamp<std::size_t>(std::size_t(std::ceil(pieces)), 2, 16);
  // An octahedral map of odd size has creases in the middles of sides.
  return is_octahedral(task.target.to) ? whole + whole % 2 : whole;
}

// Texels of one block; those that need more pieces one by one, with four times as many each time, or twice as many
// where the means themselves tell when to end.
void sample_block(const Task& task, const Sampler& otherwise, int face, int row, int first, std::span<Colour> out) {
  static thread_local Workspace ws;
  const auto column = [&](std::size_t k) { return first + int(k); };
  const std::size_t times = task.estimates ? 2 : 4;
  std::size_t pieces = std::min<std::size_t>(pieces_for(task, face, row, first, ws), task.estimates ? 2 : max_pieces);
  task.find(ws.sides, face, row, first, out.size(), pieces, false);
  ws.open.clear();
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k] = unknown;
    if (is_cut_by_rim(task.target, row, column(k)) || texel_mean(task, k, ws, out[k]) != Outcome::done)
      ws.open.push_back(k);
  }
  for (pieces = std::max(2 * times, times * pieces); !ws.open.empty(); pieces *= times) {
    std::swap(ws.open, ws.again);
    ws.open.clear();
    for (const std::size_t k : ws.again) {
      const bool rim = is_cut_by_rim(task.target, row, column(k));
      const std::size_t n = !rim ? pieces : task.estimates ? rim_pieces / 16 * pieces : std::max(pieces, rim_pieces);
      const Colour before = out[k];
      task.find(ws.sides, face, row, column(k), 1, n, rim);
      const Outcome outcome = texel_mean(task, 0, ws, out[k]);
      if (outcome == Outcome::done || (outcome == Outcome::estimated && task.has_converged(before, out[k]))) continue;
      if (outcome != Outcome::unsuitable && times * n <= max_pieces)
        ws.open.push_back(k);
      else
        otherwise(face, row, column(k), out.subspan(k, 1));
    }
  }
}

// By what odd factor the texels of a source must be divided for a tolerance: densities are taken as linear over a
// texel, which leaves an eighth of their second derivative. 0 where the finer source would be too large.
int division_for(const PaddedLevel& source, double tolerance) {
  constexpr double max_texels = 4096.0 * 4096;
  if (source.projection() == Projection::equal_area) return 1;
  const double curvature = is_octahedral(source.projection()) ? 0.5 : 0.2;
  const double texel =
      visit(source.projection(), [](auto q) { return decltype(q)::span; }) * pi / 180 / source.height();
  int times = 1;
  while (curvature * texel * texel > tolerance * times * times) times += 2;
  return times == 1 || double(source.faces()) * source.width() * source.height() * times * times < max_texels ? times
                                                                                                              : 0;
}

// The same reconstruction from texels an odd number of times as small: their centres meet those of the source's, and a
// part of a bilinear patch is bilinear.
PaddedLevel divided(const PaddedLevel& source, int times) {
  Level fine(source.projection(), source.height() * times, source.width() * times, source.max_memory());
  for_each_row(fine.faces(), fine.height(), {}, [&](int face, int row) {
    const std::span<Colour> out = fine.row(face, row);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = bilinear(source, {face, (double(i) + 0.5) / fine.width(), (row + 0.5) / fine.height()});
    fine.trim();
  });
  return PaddedLevel(std::move(fine));
}

}  // namespace

Sampler area_sampler(const PaddedLevel& source, const Target& target, double tolerance, double floor, bool estimates) {
  const Sampler otherwise = adaptive_sampler(source, target, tolerance, floor);
  const int times = division_for(source, tolerance);
  // A camera near the ball spreads solid angles over its photo otherwise than the projection.
  if (times == 0 || target.ball) return otherwise;
  const auto finer = times > 1 ? std::make_shared<const PaddedLevel>(divided(source, times)) : nullptr;
  const Task task{finer ? *finer : source, target, bend_for_error * tolerance, times, floor, estimates};
  return [finer, task, otherwise](int face, int row, int first, std::span<Colour> out) {
    while (!out.empty()) {
      const auto count = std::min(out.size(), std::size_t(block - first % block));
      sample_block(task, otherwise, face, row, first, out.first(count));
      first += int(count);
      out = out.subspan(count);
    }
  };
}

}  // namespace envmap

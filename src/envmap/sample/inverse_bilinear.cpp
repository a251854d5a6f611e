#include "envmap/sample/inverse_bilinear.h"

#include "envmap/maths/portable.h"
#include "envmap/projection/visit.h"

#include <algorithm>
#include <cmath>

namespace envmap {
namespace {

// The bilinear patch between four texel centres, its height and slopes at a point, in texels.
struct Patch {
  Direction value, dx, dy;
};

// The directions of four texels. Kept from one call to the next:
// steps and neighbours mostly stay between the same ones.
struct Corners {
  double left = -1e9, top = -1e9;
  Direction a, b, c, d;
};

Patch patch(double x, double y, int size, Corners& corners) {
  const double left = std::floor(x), top = std::floor(y), fx = x - left, fy = y - top;
  if (left != corners.left || top != corners.top) {
    const auto at = [&](double i, double j) { return Sphere::direction(0, (i + 0.5) / size, (j + 0.5) / size); };
    corners = {left, top, at(left, top), at(left + 1, top), at(left, top + 1), at(left + 1, top + 1)};
  }
  const auto& [x0, y0, a, b, c, d] = corners;
  return {glm::mix(glm::mix(a, b, fx), glm::mix(c, d, fx), fy), glm::mix(b - a, d - c, fy), glm::mix(c - a, d - b, fx)};
}

// A place in texels and how far, squared, interpolation there is from the direction wanted.
struct Candidate {
  double x, y, miss;
};

Candidate newton(const Direction& wanted, double x, double y, int size, int rounds, double good, Corners& corners) {
  // In the tangent plane of the direction; behind, where all this happens, X is never along it.
  const Direction e1 = glm::normalize(glm::cross(wanted, Direction(1, 0, 0))), e2 = glm::cross(wanted, e1);
  const double x0 = x, y0 = y;
  Candidate best{x, y, 1e300};
  for (int round = 0; round < rounds; ++round) {
    const Patch p = patch(x, y, size, corners);
    const double r1 = glm::dot(p.value, e1), r2 = glm::dot(p.value, e2), miss = r1 * r1 + r2 * r2;
    if (miss < best.miss) best = {x, y, miss};
    if (miss < good) break;
    // Least squares with a little damping: at -Z itself the direction does not change along the rim.
    const double a1 = glm::dot(p.dx, e1), a2 = glm::dot(p.dx, e2), b1 = glm::dot(p.dy, e1), b2 = glm::dot(p.dy, e2);
    const double damping = 1e-6 * (a1 * a1 + a2 * a2 + b1 * b1 + b2 * b2) + 1e-300;
    const double aa = a1 * a1 + a2 * a2 + damping, bb = b1 * b1 + b2 * b2 + damping, ab = a1 * b1 + a2 * b2;
    const double ar = a1 * r1 + a2 * r2, br = b1 * r1 + b2 * r2, det = aa * bb - ab * ab;
    x = std::clamp(x - (bb * ar - ab * br) / det, x0 - 1, x0 + 1);
    y = std::clamp(y - (aa * br - ab * ar) / det, y0 - 1, y0 + 1);
  }
  return best;
}

Location<double> settled(const Direction& wanted, const Location<double>& start, int size, Corners& corners) {
  const double x = start.u * size - 0.5, y = start.v * size - 0.5, good = 1e-8 / (1.0 * size * size);
  Candidate best = newton(wanted, x, y, size, 5, good, corners);
  // The patches meet in kinks, on which Newton's method may bounce: a few texels at the rim start again around.
  for (int k = 0; k < 8 && best.miss > good; ++k) {
    const double angle = 0.25 * pi * k;
    const Candidate c =
        newton(wanted, x + 0.6 * portable::cos(angle), y + 0.6 * portable::sin(angle), size, 8, good, corners);
    if (c.miss < best.miss) best = c;
  }
  return {0, (best.x + 0.5) / size, (best.y + 0.5) / size};
}

}  // namespace

double bilinear_bends_below(Projection p, int size) {
  // With q = sqrt((1 + z) / 2) the curvature of the map grows as q^-3: before this, interpolation is off by less than
  // 0.04 of the angle that a texel spans at the middle.
  return p == Projection::sphere ? 2 * portable::pow(4.0 / size, 2.0 / 3) - 1 : -2;
}

void locate_for_bilinear(Projection p, int size, std::span<const Direction> directions,
                         std::span<Location<double>> out) {
  locate(p, directions, out);
  if (p != Projection::sphere) return;
  const double behind = bilinear_bends_below(p, size);
  Corners corners;
  for (std::size_t k = 0; k < directions.size(); ++k)
    if (directions[k].z < behind) out[k] = settled(directions[k], out[k], size, corners);
}

}  // namespace envmap

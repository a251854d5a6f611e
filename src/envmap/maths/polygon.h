/// @file
/// Convex polygons and what a line cuts off them.
#pragma once

#include <array>

#include "envmap/maths/vector.h"

namespace envmap {

/// A square cut by up to four lines.
struct Polygon {
  std::array<Vec2<double>, 8> points;  // Four corners, and one more for each of four cuts.
  std::size_t count = 0;

  void add(const Vec2<double>& p) {
    if (count < points.size()) points[count++] = p;
  }
  /// The side of a line where a x + b y + c >= 0 (Sutherland and Hodgman 1974, "Reentrant polygon clipping").
  [[nodiscard]] Polygon cut(double a, double b, double c) const {
    Polygon out;
    for (std::size_t k = 0; k < count; ++k) {
      const Vec2<double>&p = points[k], &q = points[(k + 1) % count];
      const double dp = a * p.x + b * p.y + c, dq = a * q.x + b * q.y + c;
      if (dp >= 0) out.add(p);
      if ((dp >= 0) != (dq >= 0)) out.add(glm::mix(p, q, dp / (dp - dq)));
    }
    return out;
  }
};

}  // namespace envmap

/// @file
/// What a line cuts off a polygon.
#pragma once

#include <vector>

#include "envmap/maths/vector.h"

namespace envmap {

/// The side of a line where a x + b y + c >= 0 (Sutherland and Hodgman 1974, "Reentrant polygon clipping").
/// @param out overwritten; not `points` itself.
inline void cut(const std::vector<Point2>& points, double a, double b, double c, std::vector<Point2>& out) {
  out.clear();
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Point2&p = points[k], &q = points[k + 1 < points.size() ? k + 1 : 0];
    const double dp = a * p.x + b * p.y + c, dq = a * q.x + b * q.y + c;
    if (dp >= 0) out.push_back(p);
    if ((dp >= 0) != (dq >= 0)) out.push_back(glm::mix(p, q, dp / (dp - dq)));
  }
}

}  // namespace envmap

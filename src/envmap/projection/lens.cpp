#include "envmap/projection/lens.h"

#include <algorithm>

#include "envmap/maths/portable.h"

namespace envmap {

double Fisheye::radius(double angle) const {
  if (model == LensModel::equidistant) return circle.radius * angle / half;
  return circle.radius * portable::sin(0.5 * angle) / portable::sin(0.5 * half);
}

double Fisheye::pixels_per_radian() const {
  return model == LensModel::equidistant ? circle.radius / half : 0.5 * circle.radius / portable::sin(0.5 * half);
}

double Fisheye::depth(const Point2& place) const {
  const double inside = circle.radius - portable::hypot(place.x - circle.x, place.y - circle.y);
  return std::min({inside, place.x, place.y, width - place.x, height - place.y});
}

}  // namespace envmap

#include "envmap/maths/primaries.h"

#include <algorithm>
#include <cmath>

#include "envmap/base/bounds.h"

namespace envmap {
namespace {

Flux xyz_of(const Point2& xy) { return {xy.x / xy.y, 1, (1 - xy.x - xy.y) / xy.y}; }

// x, y and z: also of blue lights without any Y.
Flux xyz_direction(const Point2& xy) { return {xy.x, xy.y, 1 - xy.x - xy.y}; }

ColourMatrix diagonal(const Flux& d) { return {{d.x, 0, 0}, {0, d.y, 0}, {0, 0, d.z}}; }

}  // namespace

bool same(const Primaries& a, const Primaries& b) {
  constexpr double rounding = 6e-4;
  const auto near = [](const Point2& p, const Point2& q) {
    return std::max(std::abs(p.x - q.x), std::abs(p.y - q.y)) < rounding;
  };
  return near(a.red, b.red) && near(a.green, b.green) && near(a.blue, b.blue) && near(a.white, b.white);
}

bool is_possible(const Primaries& p) {
  const Point2 side = p.green - p.red, other = p.blue - p.red;
  const double area = side.x * other.y - side.y * other.x;
  return std::abs(area) > 1e-6 && std::abs(area) < 1e3 && p.white.y > 1e-6;
}

ColourMatrix to_xyz(const Primaries& p) {
  if (same(p, cie_xyz)) return ColourMatrix(1);
  const ColourMatrix directions(xyz_direction(p.red), xyz_direction(p.green), xyz_direction(p.blue));
  return directions * diagonal(glm::inverse(directions) * xyz_of(p.white));
}

ColourMatrix adaptation(const Point2& from_white, const Point2& to_white) {
  const ColourMatrix bradford({0.8951, -0.7502, 0.0389}, {0.2664, 1.7135, -0.0685}, {-0.1614, 0.0367, 1.0296});
  const Flux from = bradford * xyz_of(from_white), to = bradford * xyz_of(to_white);
  return glm::inverse(bradford) * diagonal(to / from) * bradford;
}

ColourMatrix conversion(const Primaries& from, const Primaries& to) {
  const bool any_white = same(from, cie_xyz) || same(to, cie_xyz) || from.white == to.white;
  const ColourMatrix adapt = any_white ? ColourMatrix(1) : adaptation(from.white, to.white);
  return glm::inverse(to_xyz(to)) * adapt * to_xyz(from);
}

Flux luminance_weights(const Primaries& p) {
  const ColourMatrix m = to_xyz(p);
  return {m[0].y, m[1].y, m[2].y};
}

Point2 black_body(double kelvin) {
  check_range(limits::kelvin, kelvin);
  const double t = kelvin, t2 = t * t;
  const double u =
      (0.860117757 + 1.54118254e-4 * t + 1.28641212e-7 * t2) / (1 + 8.42420235e-4 * t + 7.08145163e-7 * t2);
  const double v =
      (0.317398726 + 4.22806245e-5 * t + 4.20481691e-8 * t2) / (1 - 2.89741816e-5 * t + 1.61456053e-7 * t2);
  return Point2(3 * u, 2 * v) / (2 * u - 8 * v + 4);  // CIE 1960 to 1931.
}

}  // namespace envmap

// The projections once more, straight from the table of the conventions, in long double and without any care for
// speed or cancellation: what the library is tested against.
#pragma once

#include <cmath>

#include "envmap/projection/projection.h"

namespace formulae {

using Real = long double;
struct Vector {
  Real x, y, z;
};

inline const Real pi = std::acos(Real(-1));

inline Vector unit(Vector v) {
  const Real n = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
  return {v.x / n, v.y / n, v.z / n};
}

// Image -> direction, inside the face and the disc.
inline Vector direction(envmap::Projection p, int face, Real u, Real v) {
  const Real s = 2 * u - 1, t = 1 - 2 * v, rr = s * s + t * t;
  switch (p) {
    case envmap::Projection::latlong: {
      const Real longitude = (Real(0.5) - u) * 2 * pi, latitude = (Real(0.5) - v) * pi;
      return {std::cos(latitude) * std::sin(longitude), std::sin(latitude), std::cos(latitude) * std::cos(longitude)};
    }
    case envmap::Projection::cube:
      // forward + s right + t up, face by face.
      switch (face) {
        case 0: return unit({1, t, s});
        case 1: return unit({-1, t, -s});
        case 2: return unit({s, 1, t});
        case 3: return unit({s, -1, -t});
        case 4: return unit({-s, t, 1});
        default: return unit({s, t, -1});
      }
    case envmap::Projection::sphere: {
      const Real k = std::sqrt(std::max(Real(0), 1 - rr));
      return {2 * k * s, 2 * k * t, 1 - 2 * rr};
    }
    case envmap::Projection::paraboloid:
      return {2 * s / (1 + rr), 2 * t / (1 + rr), (face == 0 ? 1 : -1) * (1 - rr) / (1 + rr)};
    case envmap::Projection::octahedral: {
      // A point of the octahedron |x| + |y| + |z| = 1 above the diamond; what lies beyond is mirrored at its sides.
      const Real y = 1 - std::abs(s) - std::abs(t);
      if (y >= 0) return unit({s, y, t});
      return unit({std::copysign(1 - std::abs(t), s), y, std::copysign(1 - std::abs(s), t)});
    }
    case envmap::Projection::equal_area: {
      // Clarberg's equations 1 to 3, with the signed distance d from the diamond, and Y up where he has Z.
      const Real d = 1 - (std::abs(s) + std::abs(t)), r = 1 - std::abs(d);
      const Real angle = (r == 0 ? 1 : (std::abs(t) - std::abs(s)) / r + 1) * pi / 4;
      const Real level = r * std::sqrt(2 - r * r);
      return {std::copysign(level * std::cos(angle), s), std::copysign(1 - r * r, d),
              std::copysign(level * std::sin(angle), t)};
    }
    case envmap::Projection::angular: break;
  }
  const Real r = std::sqrt(rr), k = r > 0 ? std::sin(pi * r) / r : pi;
  return {-s * k, t * k, std::cos(pi * r)};
}

inline double angle(const Vector& a, const envmap::Direction& b) {
  const Real x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
  return double(2 * std::asin(std::min(Real(1), std::sqrt(x * x + y * y + z * z) / 2)));
}

inline envmap::Direction rounded(const Vector& a) {
  return {double(a.x), double(a.y), double(a.z)};
}

// Is the centre of the texel part of the image?
inline bool in_image(envmap::Projection p, int size, int i, int j) {
  if (!envmap::on_disc(p)) return true;
  const Real s = (2 * i + 1) / Real(size) - 1, t = 1 - (2 * j + 1) / Real(size);
  return s * s + t * t <= 1;
}

}  // namespace formulae

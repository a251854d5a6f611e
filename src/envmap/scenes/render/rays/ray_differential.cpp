#include "envmap/scenes/render/rays/ray_differential.h"

#include <algorithm>
#include <cmath>

namespace envmap {

RayDifferential RayDifferential::scaled(double part) const {
  return {{part * origin[0], part * origin[1]}, {part * along[0], part * along[1]}};
}

RayDifferential RayDifferential::turned(const Rotation& by) const {
  return {{by * origin[0], by * origin[1]}, {by * along[0], by * along[1]}};
}

RayDifferential RayDifferential::moved(const Direction& d, double distance, const Direction& normal) const {
  RayDifferential there{.origin = {}, .along = along};
  const double slope = glm::dot(d, normal);
  for (std::size_t k = 0; k < 2; ++k) {
    const Direction across = origin[k] + distance * along[k];
    there.origin[k] = across - glm::dot(across, normal) / slope * d;
  }
  return there;
}

Direction normalised_derivative(const Direction& v, const Direction& by) {
  const double square = glm::dot(v, v);
  return square > 0 ? (by - glm::dot(v, by) / square * v) / std::sqrt(square) : Direction(0);
}

RayDifferential after_reflection(const RayDifferential& arriving, const Direction& d, const Direction& n,
                                 const std::array<Direction, 2>& normals) {
  RayDifferential out = arriving;
  for (std::size_t k = 0; k < 2; ++k) {
    const double slope = glm::dot(arriving.along[k], n) + glm::dot(d, normals[k]);
    out.along[k] -= 2.0 * (glm::dot(d, n) * normals[k] + slope * n);
  }
  return out;
}

// The refracted ray is ratio d - mu n with mu = ratio (d n) + sqrt(1 - ratio^2 (1 - (d n)^2)).
RayDifferential after_refraction(const RayDifferential& arriving, const Direction& d, const Direction& n,
                                 const std::array<Direction, 2>& normals, double ratio) {
  RayDifferential out = arriving;
  const double dn = glm::dot(d, n), root = std::sqrt(std::max(1e-12, 1 - ratio * ratio * (1 - dn * dn)));
  const double mu = ratio * dn + root, by_slope = ratio + ratio * ratio * dn / root;
  for (std::size_t k = 0; k < 2; ++k) {
    const double slope = glm::dot(arriving.along[k], n) + glm::dot(d, normals[k]);
    out.along[k] = ratio * arriving.along[k] - (mu * normals[k] + by_slope * slope * n);
  }
  return out;
}

}  // namespace envmap

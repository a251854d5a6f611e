#include "envmap/scenes/render/shading/sampled_reflection.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "envmap/operate/convert.h"
#include "envmap/operate/levels.h"
#include "envmap/projection/matching_size.h"
#include "envmap/projection/visit.h"
#include "envmap/sample/point.h"
#include "envmap/scenes/render/shading/microfacet.h"

namespace envmap {
namespace {

constexpr int largest_cube = 512;

Level smoothed(const PaddedLevel& level) {
  const int n = level.height();
  Level out(Projection::cube, n);
  const auto along = [&](int face, int i, int j) {
    return 0.25F * *level.texel(face, i - 1, j) + 0.5F * *level.texel(face, i, j) +
           0.25F * *level.texel(face, i + 1, j);
  };
  for (int face = 0; face < out.faces(); ++face)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        *out.texel(face, i, j) =
            0.25F * along(face, i, j - 1) + 0.5F * along(face, i, j) + 0.25F * along(face, i, j + 1);
  return out;
}

// Between the two levels beside it.
Flux at_level(const std::vector<PaddedLevel>& levels, const Direction& from, double level) {
  const double clamped = std::clamp(level, 0.0, double(levels.size() - 1));
  const auto finer = std::size_t(clamped);
  const Location<double> at = Cube::locate(from);
  const Flux found(bilinear(levels[finer], at));
  const double part = clamped - double(finer);
  return part > 0 ? glm::mix(found, Flux(bilinear(levels[finer + 1], at)), part) : found;
}

// Of the unit disc by Vogel's spiral (1979), whose points lie more evenly than Hammersley's.
const std::vector<Point2>& disc_points() {
  static const std::vector<Point2> points = [] {
    constexpr double golden_angle = 2.3999632297286533;
    std::vector<Point2> all;
    for (int k = 0; k < reflection_samples; ++k)
      all.push_back(std::sqrt((k + 0.5) / reflection_samples) *
                    Point2(std::cos(golden_angle * k), std::sin(golden_angle * k)));
    return all;
  }();
  return points;
}

}  // namespace

std::vector<PaddedLevel> sampled_levels(const EnvironmentMap& map) {
  const int dense = matching_size(map.projection(), map.base().height(), Projection::cube);
  const int size = std::min(largest_cube, int(std::bit_ceil(unsigned(dense))));
  EnvironmentMap cube = convert(map, {.to = {Projection::cube}, .size = size});
  add_levels(cube);
  std::vector<PaddedLevel> levels;
  for (Level& level : cube.levels) {
    PaddedLevel plain(std::move(level));
    levels.push_back(levels.empty() ? std::move(plain) : PaddedLevel(smoothed(plain)));
  }
  return levels;
}

Flux sampled_mean(const std::vector<PaddedLevel>& levels, const Direction& n, const Direction& v, double alpha,
                  const Flux& f0, double f90) {
  const double nv = std::clamp(glm::dot(n, v), 1e-3, 1.0), a2 = alpha * alpha;
  const auto masked = [a2](double cosine) { return std::sqrt(a2 + (1 - a2) * cosine * cosine); };
  // The view lies over t.
  const Direction aside = v - glm::dot(n, v) * n, local(std::sqrt(1 - nv * nv), 0, nv);
  const double length = glm::length(aside), face = levels[0].height();
  const Direction t = length > 1e-4 ? aside / length : upright_about(n)[0], b = glm::cross(n, t);
  const Direction stretched = glm::normalize(Direction(alpha * local.x, 0, local.z));
  Flux sum(0), weights(0);
  for (const Point2& at : disc_points()) {
    const double x = at.x, y = glm::mix(std::sqrt(1 - x * x), at.y, 0.5 * (1 + stretched.z));
    const double z = std::sqrt(std::max(0.0, 1 - x * x - y * y));
    const Direction m(z * stretched.x - y * stretched.z, x, z * stretched.z + y * stretched.x);
    const Direction h = glm::normalize(Direction(alpha * m.x, alpha * m.y, std::max(0.0, m.z)));
    const double vh = glm::dot(local, h), nl = 2 * vh * h.z - nv;
    if (nl <= 0) continue;
    // F G2 / G1, and the density D G1 / (4 nv).
    const double g = nl * (nv + masked(nv)) / (nl * masked(nv) + nv * masked(nl));
    const double q = h.x * h.x + h.y * h.y + a2 * h.z * h.z, density = a2 / (2 * pi * q * q * (nv + masked(nv)));
    const Direction l = (2 * vh * h.x - local.x) * t + 2 * vh * h.y * b + nl * n;
    // A texel of a cube has 4 c^3 / face^2 steradians, c the cosine to its face's axis.
    const double c = std::max({std::abs(l.x), std::abs(l.y), std::abs(l.z)});
    const double texels = face * face * reflection_texel / (4 * c * c * c * reflection_samples * density);
    const Flux weight = g * (f0 + (f90 - f0) * schlick_weight(vh));
    sum += weight * at_level(levels, l, 0.5 * std::log2(texels));
    weights += weight;
  }
  return sum / glm::max(weights, 1e-30);
}

}  // namespace envmap

#include "envmap/prefilter/light.h"

namespace envmap {
namespace {

// Steradians count a little, so that black parts have a place, too: as much as the least radiance that errors are
// measured against.
double weight(const LightFlux& f) { return (static_cast<double>(f[0]) + f[1] + f[2]) / 3 + 1e-3 * f[3]; }

}  // namespace

Light light_of(const Patch& patch, const Flux& radiance) {
  const double w = patch.solid_angle;
  return {.centre = patch.centre,
          .covariance = patch.covariance,
          .flux = {static_cast<float>(w * radiance.x), static_cast<float>(w * radiance.y),
                   static_cast<float>(w * radiance.z), static_cast<float>(w)},
          .spread = static_cast<float>(patch.spread),
          .reach = static_cast<float>(patch.reach)};
}

Light united(std::span<const Light> parts) {
  Light all;
  double whole = 0;
  std::array<double, light_channels> flux{};
  for (const Light& p : parts) {
    const double w = weight(p.flux);
    whole += w;
    all.centre += w * p.centre;
    for (std::size_t c = 0; c < light_channels; ++c) flux[c] += p.flux[c];
  }
  if (whole <= 0) return {};
  all.centre /= whole;

  std::array<Direction, light_channels> dipole{};
  std::array<Symmetric, light_channels> second{};
  std::array<double, light_channels> uneven{}, cubes{};
  for (const Light& p : parts) {
    const double w = weight(p.flux) / whole;
    if (w <= 0) continue;
    const Direction off = p.centre - all.centre;
    const double distance = glm::length(off), reach = p.spread + distance;
    all.covariance.add(p.covariance, w);
    all.covariance.add_square(off, w);
    for (std::size_t c = 0; c < light_channels; ++c) {
      const Direction d(p.dipole[c]);
      dipole[c] += static_cast<double>(p.flux[c]) * off + d;
      second[c].add(p.covariance, p.flux[c]);
      second[c].add_square(off, p.flux[c]);
      second[c].add_product(off, d, 1);
      uneven[c] += static_cast<double>(p.flux[c]) * p.uneven;
      cubes[c] += static_cast<double>(p.flux[c]) * reach * reach * reach;
    }
    all.reach = std::max(all.reach, static_cast<float>(p.reach + distance));
  }
  double most = 0;
  for (std::size_t c = 0; c < light_channels; ++c) {
    all.flux[c] = static_cast<float>(flux[c]);
    all.dipole[c] = Vec3<float>(dipole[c]);
    if (flux[c] <= 0) continue;
    second[c].add(all.covariance, -flux[c]);
    all.uneven = std::max(all.uneven, static_cast<float>((second[c].norm() + uneven[c]) / flux[c]));
    most = std::max(most, cubes[c] / flux[c]);
  }
  all.spread = static_cast<float>(std::cbrt(most));
  return all;
}

}  // namespace envmap

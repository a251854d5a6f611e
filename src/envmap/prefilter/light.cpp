#include "envmap/prefilter/light.h"

namespace envmap {
namespace {

// Steradians count a little, so that black parts have a place, too: as much as the least radiance that errors are
// measured against.
double weight(const LightFlux& f) { return (static_cast<double>(f[0]) + f[1] + f[2]) / 3 + 1e-3 * f[3]; }

// Of lights or texels: their weights and fluxes summed up, and their mean place.
struct Middle {
  double weight = 0;
  std::array<double, light_channels> flux{};
  Direction centre{0};
};
template <class Parts>
Middle middle_of(const Parts& parts) {
  Middle m;
  for (const auto& p : parts) {
    const double w = weight(p.flux);
    m.weight += w;
    m.centre += w * p.centre;
    for (std::size_t c = 0; c < light_channels; ++c) m.flux[c] += p.flux[c];
  }
  if (m.weight > 0) m.centre /= m.weight;
  return m;
}

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
  const auto [whole, flux, centre] = middle_of(parts);
  if (whole <= 0) return {};
  all.centre = centre;

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

// ---- many texels ------------------------------------------------------------------------------------------------------

void LightSum::start(const Patch& alike) {
  const auto& m = alike.covariance.m;
  rows_.push_back({alike, 1 - 0.5 * (m[0] + m[3] + m[5]), texels_.size()});
}

void LightSum::add(const Direction& middle, double solid_angle, const Flux& radiance) {
  texels_.push_back({rows_.back().inside * middle,
                     {static_cast<float>(solid_angle * radiance.x), static_cast<float>(solid_angle * radiance.y),
                      static_cast<float>(solid_angle * radiance.z), static_cast<float>(solid_angle)}});
}

Light LightSum::light() const {
  Light all;
  const auto [whole, flux, centre] = middle_of(texels_);
  if (whole <= 0) return {};
  all.centre = centre;

  // Sums of flux x offset, flux x offset^2 and flux x |offset|^3 of each channel; offsets are small enough for float32.
  using Channels = std::array<float, light_channels>;
  std::array<Channels, 3> dipole{};
  std::array<Channels, 6> second{};
  Channels cubes{};
  float farthest = 0;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const std::size_t end = r + 1 < rows_.size() ? rows_[r + 1].first : texels_.size();
    Channels row{};
    const auto spread = static_cast<float>(rows_[r].alike.spread), reach = static_cast<float>(rows_[r].alike.reach);
    for (std::size_t k = rows_[r].first; k < end; ++k) {
      const Vec3<float> o(texels_[k].centre - all.centre);
      const float distance = glm::length(o), far = distance + spread, cube = far * far * far;
      const std::array<float, 6> product{o.x * o.x, o.x * o.y, o.x * o.z, o.y * o.y, o.y * o.z, o.z * o.z};
      const Channels f = texels_[k].flux;
      farthest = std::max(farthest, distance + reach);
      for (std::size_t c = 0; c < light_channels; ++c) {
        row[c] += f[c];
        cubes[c] += f[c] * cube;
        for (std::size_t n = 0; n < 3; ++n) dipole[n][c] += f[c] * o[static_cast<int>(n)];
        for (std::size_t n = 0; n < 6; ++n) second[n][c] += f[c] * product[n];
      }
    }
    for (std::size_t c = 0; c < light_channels; ++c)
      for (std::size_t n = 0; n < 6; ++n) second[n][c] += row[c] * static_cast<float>(rows_[r].alike.covariance.m[n]);
  }
  all.reach = farthest;
  for (std::size_t n = 0; n < 6; ++n) {
    const Channels& s = second[n];
    all.covariance.m[n] = ((static_cast<double>(s[0]) + s[1] + s[2]) / 3 + 1e-3 * s[3]) / whole;
  }
  float most = 0;
  for (std::size_t c = 0; c < light_channels; ++c) {
    all.flux[c] = static_cast<float>(flux[c]);
    all.dipole[c] = {dipole[0][c], dipole[1][c], dipole[2][c]};
    if (flux[c] <= 0) continue;
    Symmetric off;
    for (std::size_t n = 0; n < 6; ++n) off.m[n] = second[n][c] / flux[c] - all.covariance.m[n];
    all.uneven = std::max(all.uneven, static_cast<float>(off.norm()));
    most = std::max(most, static_cast<float>(cubes[c] / flux[c]));
  }
  all.spread = std::cbrt(most);
  return all;
}

}  // namespace envmap

#include "envmap/light/light_error.h"

#include <algorithm>
#include <cmath>

#include "envmap/maths/portable.h"
#include "envmap/operate/grade.h"
#include "envmap/operate/refuse_flaws.h"
#include "envmap/prefilter/lobe_formulas.h"

namespace envmap {
namespace {

// The steepest slope of a lobe by angle, at least. Its grid is so fine that no slope between two points is a hundredth
// larger, which is added: the narrowest lobe is 1e-6 wide in radians squared, and steps grow with the angle.
double steepest(const Ggx& lobe) {
  double most = 0, before = 0, value_before = lobe.value(0);
  for (double angle = 1e-6; angle < 0.5 * pi; angle *= 1.002) {
    const double s = portable::sin(0.5 * angle), value = lobe.value(2 * s * s);
    most = std::max(most, std::abs(value - value_before) / (angle - before));
    before = angle, value_before = value;
  }
  return 1.01 * most;
}

double value(const Ggx& lobe, const Direction& a, const Direction& b) {
  const double chord = glm::distance(a, b);
  return lobe.value(std::min(2.0, 0.5 * chord * chord));
}

// The worst channel; one without light has no error.
double largest_ratio(const Flux& error, const Flux& reference) {
  double most = 0;
  for (int c = 0; c < 3; ++c)
    if (error[c] > 0) most = std::max(most, error[c] / std::max(1e-300, reference[c]));
  return most;
}

}  // namespace

LightError light_error(const EnvironmentMap& map, const FoundLights& found, double roughness) {
  check_range({"roughness", 1e-3, 1}, roughness);
  require_finite(map);
  if (found.lights.empty()) return {};
  // An arc is longer than its chord by less than this as far as lights reach: 0.7 radians.
  constexpr double arc = 1.03;
  const Ggx lobe(roughness);
  const double slope = steepest(lobe) * arc;
  Flux spread(0), ggx_there(0);
  for (const DiscLight& light : found.lights) spread += light.spread;
  for (const DiscLight& light : found.lights) {
    // The map reflects there what these lights do, but for that error, and more.
    Flux reflected(0);
    for (const DiscLight& other : found.lights) reflected += value(lobe, other.towards, light.towards) * other.flux;
    ggx_there = glm::max(ggx_there, reflected - slope * spread);
  }
  // What the map gives a plane that faces the strongest light is no more than its largest irradiance.
  const Flux irradiance_there = irradiance(map, found.lights.front().towards);
  return {largest_ratio(spread, irradiance_there), largest_ratio(slope * spread, ggx_there)};
}

}  // namespace envmap

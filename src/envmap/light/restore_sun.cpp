#include "envmap/light/restore_sun.h"

#include <fmt/format.h>

#include <cmath>

#include "envmap/base/error.h"
#include "envmap/light/disc_angles.h"
#include "envmap/light/disc_fit.h"
#include "envmap/maths/portable.h"
#include "envmap/maths/primaries.h"
#include "envmap/operate/atmosphere.h"
#include "envmap/operate/brightest.h"
#include "envmap/operate/check_options.h"
#include "envmap/operate/grade.h"
#include "envmap/operate/refuse_flaws.h"

namespace envmap {
namespace {

// A disc in a map: the texels that it touches, and which part of each.
struct DiscInMap {
  Patch patch;
  std::vector<double> covered;
  double solid_angle = 0;  // Of these parts.

  DiscInMap(TexelGeometry& geometry, const Texel& middle, const Direction& towards, double radius)
      : patch(geometry, near(geometry, middle, towards, radius), {}, towards, radius),
        covered(patch.coverage(towards, radius)) {
    for (std::size_t t = 0; t < covered.size(); ++t) solid_angle += covered[t] * patch.weight()[t];
  }

  // Of the light that is in it.
  [[nodiscard]] Flux flux(const Level& level) const {
    Flux sum(0);
    for (std::size_t t = 0; t < covered.size(); ++t) {
      const Texel& at = patch.texels()[t];
      sum += covered[t] * patch.weight()[t] * Flux(*level.texel(at.face, at.i, at.j));
    }
    return sum;
  }

  void add(Level& level, const Flux& flux) const {
    for (std::size_t t = 0; t < covered.size(); ++t) {
      const Texel& at = patch.texels()[t];
      *level.texel(at.face, at.i, at.j) += Colour(flux * (covered[t] / solid_angle));
    }
  }

 private:
  static std::vector<Texel> near(const TexelGeometry& geometry, const Texel& middle, const Direction& towards,
                                 double radius) {
    const double chord = 2 * portable::sin(0.5 * radius) + 2 * geometry.extent(middle).reach;
    return texels_within(geometry, std::vector<Texel>{middle}, towards, chord);
  }
};

DiscInMap disc_of(TexelGeometry& geometry, const EnvironmentMap& map, const ClippedSun& sun, double radius_degrees) {
  const Measures m = measure(map);
  const Direction towards = glm::transpose(image_to_world(map.forward)) * sun.towards;
  return {geometry, m.brightest_texel, towards, radius_degrees * pi / 180};
}

}  // namespace

ClippedSun clipped_sun(const EnvironmentMap& map) {
  constexpr double largest = 10;
  const Measures m = measure(require_finite(map));
  if (!(m.brightest > 0)) throw InputError("the map is black: it has no sun");
  TexelGeometry geometry(map.base());
  // All texels of the region are about as large as the one in its middle.
  const double solid_angle = geometry.solid_angle(m.brightest_texel) * double(m.brightest_texels);
  const double degrees = 180 / pi * radius_of_disc(solid_angle);
  if (degrees > largest)
    throw InputError(fmt::format("the brightest texels, {} of one value, fill a disc of {:.1f} degrees radius: no sun",
                                 m.brightest_texels, degrees));
  return {m.brightest_direction, m.brightest_texels, degrees};
}

RestoredSun restore_sun(EnvironmentMap& map, const Flux& irradiance, double radius_degrees) {
  check_range(limits::sun_radius, radius_degrees);
  check_not_negative("irradiance", irradiance);
  RestoredSun restored{.sun = clipped_sun(map)};
  TexelGeometry geometry(map.base());
  const DiscInMap disc = disc_of(geometry, map, restored.sun, radius_degrees);
  const double factor = irradiance_of_flux(radius_degrees * pi / 180);
  restored.flux_before = flux(map.base());
  restored.irradiance_before = factor * disc.flux(map.base());
  const Flux missing = irradiance / factor - disc.flux(map.base());
  for (int c = 0; c < 3; ++c)
    if (missing[c] < 0)
      throw InputError(fmt::format("the sun's disc has an irradiance of {:.6g} in {}: more than the {:.6g} wanted",
                                   restored.irradiance_before[c],
                                   c == 0   ? "red"
                                   : c == 1 ? "green"
                                            : "blue",
                                   irradiance[c]));
  disc.add(map.base(), missing);
  require_no_overflow(map.base(), "the restored sun", "irradiance");
  restored.flux_after = flux(map.base());
  restored.irradiance_after = restored.irradiance_before + factor * (restored.flux_after - restored.flux_before);
  map.levels.erase(map.levels.begin() + 1, map.levels.end());
  return restored;
}

Flux irradiance_of_sun(const EnvironmentMap& map, double illuminance) {
  check_not_negative("illuminance", Flux(illuminance));
  const Measures m = measure(map);
  const Flux colour = m.brightest > 0 ? Flux(m.brightest_value) / m.brightest : Flux(1);
  return illuminance * colour;
}

Flux irradiance_of_sun_in_atmosphere(const EnvironmentMap& map, double radius_degrees, const Run& run) {
  const ClippedSun sun = clipped_sun(map);
  if (!(sun.towards.y > 0)) throw InputError("the brightest texels lie below the horizon: no sun of a clear sky");
  constexpr int rows = 32;  // The flux of the disc does not depend on them.
  Atmosphere air{.sun = sun.towards};
  const Daylight with = generate(air, Projection::latlong, rows, run);
  air.disc = false;
  const Daylight without = generate(air, Projection::latlong, rows, run);
  // The light of a sun at the horizon is redder than the primaries.
  const Flux disc = into_gamut(flux(with.map.base()) - flux(without.map.base()), luminance_weights(rec709));
  TexelGeometry geometry(map.base());
  const Flux sun_here = disc_of(geometry, map, sun, radius_degrees).flux(map.base());
  // A horizontal plane sees the sky alone.
  const double sky = luminance_of(irradiance(map, {0, 1, 0})) - sun.towards.y * luminance_of(sun_here);
  return disc * (with.sun_normal / with.sky_horizontal * std::max(0.0, sky) / luminance_of(disc));
}

}  // namespace envmap

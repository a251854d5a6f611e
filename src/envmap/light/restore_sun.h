/// @file
/// The light that a camera or a file cut off a sun.
#pragma once

#include <cstdint>

#include "envmap/base/bounds.h"
#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/light/lights.h"
#include "envmap/map/environment_map.h"

namespace ENVMAP_EXPORT envmap {

/// A sun of which light is missing: the largest region of the brightest texels, where they lie close together.
struct ClippedSun {
  Direction towards{0, 0, 1};  ///< Unit, world.
  std::int64_t texels = 0;     ///< Of one value.
  double degrees = 0;          ///< Radius of a disc of their solid angle.
};

/// What the brightest texels are. @throws InputError where the map is black, or where they fill more than a disc of 10
/// degrees: no sun.
ClippedSun clipped_sun(const EnvironmentMap& map);

/// What happened to the irradiance of a plane that faces the sun, by the disc alone, and to the flux of the map.
struct RestoredSun {
  ClippedSun sun;
  Flux irradiance_before{0}, irradiance_after{0};
  Flux flux_before{0}, flux_after{0};
};

/// Adds the light that is missing to a disc of even radiance in the middle of the brightest texels. The glow round it
/// stays as it is. Removes all levels but the first.
/// @param irradiance that the disc shall have on a plane that faces it, per channel.
/// @throws UsageError where the radius is out of its range (limits::sun_radius) or the irradiance negative or not
/// finite, InputError as clipped_sun(), or where the disc has more light already.
RestoredSun restore_sun(EnvironmentMap& map, const Flux& irradiance, double radius_degrees = sun_radius_degrees);

/// The irradiance of a sun of this illuminance (in units of luminance 1) and of the colour of the brightest texels.
Flux irradiance_of_sun(const EnvironmentMap& map, double illuminance);

/// The irradiance that the sun of a clear sky has where the sky gives the light that it gives here: the ratio of sun to
/// sky, and the sun's colour, of generate(Atmosphere) at the elevation of the brightest texels.
/// @throws InputError where that is below the horizon, too.
Flux irradiance_of_sun_in_atmosphere(const EnvironmentMap& map, double radius_degrees = sun_radius_degrees,
                                     const Run& run = {});

}  // namespace envmap

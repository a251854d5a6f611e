/// @file
/// What is done to a probe before anything else: its colours, and how much light it is.
#pragma once

#include <cstdint>

#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"
#include "envmap/maths/primaries.h"

namespace ENVMAP_EXPORT envmap {

/// @param luminance what red, green and blue count for in luminance: luminance_weights() of the map's primaries.
struct Grade {
  Flux gain{1};           ///< Factor of each channel, at least 0.
  double saturation = 1;  ///< 0: grey; 1: as it is; above 1 as far as no channel falls below 0.
  Flux luminance = luminance_weights(rec709);

  [[nodiscard]] bool changes() const { return gain != Flux(1) || saturation != 1; }
};

/// Gains first, then saturation: y + s (c - y) with the luminance y, which stays the same.
void apply(const Grade& grade, Level& level);

/// Adds the light of a second environment to level 0, resampled to its texels by the filter that convert() chooses.
/// @throws InputError where a texel of either is NaN or infinite.
void add_light(EnvironmentMap& map, const EnvironmentMap& other, double gain = 1, const Run& run = {});

/// A colour with a negative channel, which a wider space brought, is moved to grey of its luminance until none is; what
/// has no luminance becomes 0.
Flux into_gamut(const Flux& colour, const Flux& luminance);

/// All colours of a level likewise. @return how many texels had one below -1e-3 of their largest channel:
/// more than rounding.
std::int64_t into_gamut(Level& level, const Flux& luminance);

/// Irradiance of a plane that faces a direction: the integral of L max(0, n.l), per channel, of level 0. Each texel is
/// taken as constant and cut into as many parts as make 512 rows from pole to pole or more: to 1e-5 of all light, 0.003
/// in maps of discs (rims). NaN and infinite texels count as 0. @param normal of the world, of any length.
/// @throws UsageError where it is 0, NaN or infinite, here and below.
Flux irradiance(const EnvironmentMap& map, const Direction& normal);

/// Mean radiance of the parts of texels (as above) with their middle within so many degrees of a direction; of 1 degree
/// and more there is always one. @param towards of the world, of any length.
Flux radiance_within(const EnvironmentMap& map, const Direction& towards, double degrees);

/// Gains that make a light of this colour grey and keep its luminance. @throws UsageError where a channel is 0.
Flux white_balance(const Flux& colour, const Flux& luminance);

/// The same of a black body, seen in a space of these primaries. @param kelvin 1000 to 25000.
Flux white_balance(double kelvin, const Primaries& primaries);

}  // namespace envmap

/// @file
/// Suns and lamps of a map as lights, and the map without them.
#pragma once

#include <vector>

#include "envmap/base/bounds.h"
#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"
#include "envmap/operate/measure.h"

namespace ENVMAP_EXPORT envmap {

/// Of the real sun, in degrees: its mean over the year.
inline constexpr double sun_radius_degrees = 0.2666;

/// A disc of even radiance that stands for the light which a map holds there beyond its surroundings.
struct DiscLight {
  Direction towards{0, 0, 1};  ///< Unit, world.
  double radius_degrees = 0;
  /// The map is too coarse to tell the radius: it is this large at most.
  bool radius_is_bound = false;
  double radius_within_degrees = 0;  ///< How far off it may be otherwise.
  /// How far off the direction may be: other discs, or other places of this one, explain the texels as well.
  double within_degrees = 0;
  Flux flux{0};            ///< Its integral of radiance: what the map loses.
  Flux radiance{0};        ///< The same over the disc's solid angle.
  Flux irradiance{0};      ///< Of a plane that faces it, by a disc of this flux.
  double share = 0;        ///< Of the luminous flux of the map.
  double contrast = 0;     ///< Its luminance over that of its surroundings.
  double misfit = 0;       ///< rms of what the disc leaves unexplained, over that of the light.
  int texels_at_peak = 0;  ///< That hold the largest value of the light: many where it was clipped.
  Flux spread{0};          ///< Integral of its radiance x distance (chord) from `towards`, at most: for light_error.h.
};

struct LightOptions {
  double min_share = 0.01;        ///< Sources with less of the map's luminous flux stay in the map.
  double max_radius_degrees = 5;  ///< Larger ones stay, too: windows, softboxes, bright clouds.
  double contrast = 4;            ///< Luminance over that of the surroundings, at least.
  int most = 16;                  ///< The strongest.
};

namespace limits {
inline constexpr Bounds min_share{"min_share", 1e-6, 1};
inline constexpr Bounds light_radius{"max_radius_degrees", 0.05, 15};
inline constexpr Bounds contrast{"contrast", 1.5, 1e9};
inline constexpr Bounds lights{"most", 1, 256};
}  // namespace limits

/// A texel of level 0, and what it holds once the lights are taken out.
struct TexelWithoutLight {
  Texel texel;
  Colour colour;
};

struct FoundLights {
  std::vector<DiscLight> lights;                ///< The strongest first.
  std::vector<TexelWithoutLight> without = {};  ///< Flux(map) = flux(remainder) + flux(lights), to rounding of floats.
};

/// Finds compact sources that outshine their surroundings: regions over half of their own peak, to which a disc is
/// fitted by least squares, or two or three discs that touch. A source stays in the map where no disc fits it, as a
/// square window. Light in sources is what they have beyond a smooth continuation of their rim, with the glow next to
/// the disc as far as it falls steeply.
/// @throws UsageError where an option is out of its range, InputError where a texel is NaN or infinite.
FoundLights find_lights(const EnvironmentMap& map, const LightOptions& options = {}, const Run& run = {});

/// Takes the lights out of level 0 of the map that they were found in, and removes its other levels.
void take_out(EnvironmentMap& map, const FoundLights& found);

}  // namespace envmap

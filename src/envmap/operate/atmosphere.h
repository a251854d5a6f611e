/// @file
/// Daylight of a clear sky, computed from the physics of the air.
#pragma once

#include "envmap/base/bounds.h"
#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"

namespace ENVMAP_EXPORT envmap {

/// Which scattered light a sky holds.
enum class Scattering {
  single,    ///< Nishita et al. 1993: sunlight that was scattered once.
  multiple,  ///< All orders: from the second on isotropic, as a geometric series (Hillaire 2020, section 5.5).
};
template <>
inline constexpr std::size_t enumerators<Scattering> = std::size_t(Scattering::multiple) + 1;

/// Spherical air of molecules, haze and ozone above a diffuse ground, lit by the sun. No refraction.
struct Atmosphere {
  Direction sun{0, 0.5, 0.8660254037844386};  ///< Towards the sun, of any length, world frame; +Y is up.
  /// Vertical optical depth at 550 nm of molecules and haze over that of the molecules alone (Preetham et al. 1999).
  double turbidity = 2.5;
  double altitude = 0;             ///< Of the viewer above the ground, in metres.
  Rgb<double> ground{0.2};         ///< Albedo.
  double radius_degrees = 0.2666;  ///< Of the sun's disc. The flux of the sun does not depend on it.
  bool disc = true;                ///< Whether the map holds the sun itself.
  Scattering scattering = Scattering::multiple;
};

namespace limits {
inline constexpr Bounds turbidity{"turbidity", 1, 10};
inline constexpr Bounds altitude{"altitude", 0, 60000};  ///< In metres.
inline constexpr Bounds albedo{"ground", 0, 1};
inline constexpr Bounds sun_radius{"radius_degrees", 0.001, 10};  ///< In degrees.
}  // namespace limits

/// Lumens of a watt that is weighted by CIE 1931.
inline constexpr double luminous_efficacy = 683;

/// Radiance in W/(m^2 sr), weighted by CIE 1931 and given in linear RGB of Rec.709: its luminance times
/// luminous_efficacy is cd/m^2.
struct Daylight {
  EnvironmentMap map;
  /// Illuminance in lux at the viewer: of a surface that faces the sun, and of a horizontal one. The sun's parts count
  /// where the map leaves its disc out, too.
  double sun_normal, sun_horizontal, sky_horizontal;
};

/// @throws UsageError where a parameter is out of its range.
Daylight generate(const Atmosphere& atmosphere, const Frame& to, int size, const Run& run = {});

}  // namespace envmap

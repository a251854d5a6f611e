/// @file
/// Environments with a known answer.
#pragma once

#include <optional>
#include <variant>

#include "envmap/base/bounds.h"
#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"

namespace ENVMAP_EXPORT envmap {

/// The same radiance everywhere.
struct Constant {
  Rgb<double> radiance{1};
};

/// From `bottom` at -Y to `top` at +Y, linear in y; mean radiance (top + bottom) / 2.
struct Gradient {
  Rgb<double> bottom{0.1}, top{1};
};

/// Squares of 180 / `squares` degrees of longitude and latitude; `even` holds the one east and north of +Z.
/// Coverage by 8 x 8 samples a texel.
struct Checker {
  int squares = 8;
  Rgb<double> even{1}, odd{0.1};
};

/// RGB = (direction + 1) / 2, world frame, of each texel's centre.
struct Directions {};

/// Each of the six faces of a cube round the viewpoint in a colour of its own: +X red, -X cyan, +Y green, -Y magenta,
/// +Z blue,
/// -Z yellow. Coverage by 8 x 8 samples a texel.
struct Faces {};

/// CIE standard overcast sky (Moon and Spencer 1942): L = zenith (1 + 2 y) / 3 above, `ground` below the horizon.
/// Irradiance of a floor: 7 pi / 9 x zenith. With a horizon of its own: linear in y from there to the zenith.
struct Sky {
  Rgb<double> zenith{1}, ground{0.2};
  std::optional<Rgb<double>> horizon = {};
};

/// A disc of even radiance over a sky. Each texel holds its mean, so that the sun's flux is
/// 2 pi (1 - cos radius) x radiance at any size.
struct Sun {
  Direction towards{0, 0, 1};  ///< Of any length, world frame.
  double radius_degrees = 0.2666;
  Rgb<double> radiance{1e5};
  Sky sky = {};
};

/// base + amplitude x Y_l^m, the real orthonormal spherical harmonic with +Y as its polar axis, longitude from +Z to
/// +X, no Condon-Shortley phase: m > 0 cosines, m < 0 sines (Sloan 2008, appendix A1, without its sign). At each
/// texel's centre.
struct Harmonic {
  int degree = 2, order = 0;
  double base = 1, amplitude = 0.5;
};

namespace limits {
inline constexpr Bounds disc_radius{"radius_degrees", 1e-9, 180};  ///< Of Sun.
inline constexpr Bounds squares{"squares", 1, 1e9};                ///< Of Checker.
inline constexpr Bounds degree{"degree", 0, 100};                  ///< Of Harmonic.
}  // namespace limits

using Pattern = std::variant<Constant, Gradient, Checker, Directions, Faces, Sun, Sky, Harmonic>;

/// Value of the real orthonormal harmonic described at Harmonic. @param d of any length.
/// @throws UsageError where the degree is not 0 to 200 or the order not -degree to degree, or d is 0, NaN or infinite.
double real_harmonic(int degree, int order, const Direction& d);

/// @throws UsageError where the pattern would hold negative radiance or its parameters make no sense.
EnvironmentMap generate(const Pattern& pattern, const Frame& to, int size, const Run& run = {});

}  // namespace envmap

// Maps of radiance 1 with one texel that is far brighter, where projections are at their worst.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "envmap/map/environment_map.h"
#include "envmap/operate/measure.h"

namespace extremes {

inline constexpr float largest = 3e38F;
inline constexpr float suns[] = {1e4F, 1e9F, largest};

/// Texels at poles, corners, seams, rims and in the middle, by what they are.
inline std::vector<std::pair<std::string, envmap::Texel>> places(const envmap::Level& level) {
  using envmap::Projection;
  const int w = level.width() - 1, h = level.height() - 1, faces = level.faces() - 1;
  switch (level.projection()) {
    case Projection::latlong: return {{"pole", {0, w / 3, 0}}, {"seam", {0, w, h / 2}}, {"middle", {0, w / 2, h / 2}}};
    case Projection::cube: return {{"corner", {faces, 0, 0}}, {"seam", {1, w, h / 2}}, {"pole", {2, w / 2, h / 2}}};
    case Projection::paraboloid:
      return {{"rim", {1, w / 2, 0}}, {"corner", {0, w / 6 + 1, h / 6 + 1}}, {"middle", {0, w / 2, h / 2}}};
    default:
      return {{"rim", {0, w / 2, 0}}, {"slant of the rim", {0, w / 6 + 1, h / 6 + 1}}, {"middle", {0, w / 2, h / 2}}};
  }
}

inline envmap::EnvironmentMap with_sun(envmap::Projection p, int size, const envmap::Texel& at, float sun,
                                       float sky = 1) {
  envmap::EnvironmentMap map;
  map.levels.emplace_back(p, size);
  for (const envmap::Texel& t : envmap::texels_of(map.base()))
    *map.base().texel(t.face, t.i, t.j) = envmap::Colour(sky);
  *map.base().texel(at.face, at.i, at.j) = envmap::Colour(sun, sun / 2, sun / 4);
  return map;
}

/// How far the flux of the cube that the area filter makes of a map of 8 rows may be from that of its texels: its own
/// error, and what bilinear interpolation changes where texels are cut by a rim or the density has a crease (measured:
/// 7 and 8%, falling with the size of texels). Cubes and latlong maps are no cube first.
inline double flux_error_of_cube(envmap::Projection p) {
  using envmap::Projection;
  if (p == Projection::cube || p == Projection::latlong) return 0;
  return p == Projection::equal_area ? 1e-4 : 0.1;
}

/// Least and largest value of the texels that touch the disc. (Coarse levels of a latlong map are not 2:1.)
inline std::pair<float, float> range(const envmap::Level& level) {
  const envmap::Colour middle = *level.texel(0, level.width() / 2, level.height() / 2);
  std::pair<float, float> r{middle.x, middle.x};
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j) {
      const envmap::Columns disc = envmap::columns(level.projection(), level.height(), j);
      const bool whole = level.projection() == envmap::Projection::latlong;
      for (int i = whole ? 0 : disc.first; i < (whole ? level.width() : disc.end); ++i)
        for (int c = 0; c < 3; ++c) {
          const float x = (*level.texel(face, i, j))[c];
          if (!(x >= r.first)) r.first = x;  // NaN, too.
          if (!(x <= r.second)) r.second = x;
        }
    }
  return r;
}

/// Calls f with a map and words for it, for every projection, place and sun.
template <class F>
void for_each_sun(int size, F&& f) {
  for (const envmap::Projection p : envmap::all_projections) {
    const envmap::EnvironmentMap blank = envmap::blank_map(p, size);
    for (const auto& [where, at] : places(blank.base()))
      for (const float sun : suns)
        f(with_sun(p, size, at, sun), std::string(envmap::name(p)) + ", " + where + ", " + std::to_string(sun), at,
          sun);
  }
}

}  // namespace extremes

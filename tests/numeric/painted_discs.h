/// @file
/// Discs of known direction, radius and light, painted into maps by samples of their texels.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "envmap/operate/measure.h"

namespace envmap::numeric_tests {

inline constexpr double degree = pi / 180;

inline double cap(double radius_degrees) { return 2 * pi * (1 - std::cos(radius_degrees * degree)); }

// Adds to each texel the mean of a shape's radiance over it, of samples x samples points. @param is_inside of a
// direction. @param reach in degrees from `towards` beyond which nothing is.
template <class Inside>
void paint(EnvironmentMap& map, const Direction& towards, double reach, const Flux& radiance, const Inside& is_inside,
           int samples = 48) {
  Level& level = map.base();
  const Direction axis = glm::normalize(towards) * image_to_world(map.forward);
  std::vector<Direction> row(std::size_t(level.width()));
  for (const Texel& t : texels_of(level)) {
    if (t.i == columns(level.projection(), level.height(), t.j).first)
      texel_directions(level.projection(), level.height(), t.face, t.j, 0, row);
    if (glm::distance(row[std::size_t(t.i)], axis) > reach * degree + 0.3) continue;  // Most are far away.
    const double w = level.width(), h = level.height();
    std::vector<Point2> corners{{t.i / w, t.j / h},
                                {(t.i + 1) / w, t.j / h},
                                {t.i / w, (t.j + 1) / h},
                                {(t.i + 1) / w, (t.j + 1) / h},
                                {(t.i + 0.5) / w, (t.j + 0.5) / h}};
    std::vector<Direction> d(corners.size());
    directions(level.projection(), t.face, corners, d);
    double size = 0, nearest = 4;
    for (const Direction& c : d)
      size = std::max(size, glm::distance(c, d.back())), nearest = std::min(nearest, glm::distance(c, axis));
    if (nearest > reach * degree + 2 * size) continue;
    std::vector<Point2> points;
    for (int j = 0; j < samples; ++j)
      for (int i = 0; i < samples; ++i)
        points.push_back({(t.i + (i + 0.5) / samples) / w, (t.j + (j + 0.5) / samples) / h});
    std::vector<Direction> at(points.size());
    std::vector<double> density(points.size());
    directions(level.projection(), t.face, points, at);
    densities(level.projection(), points, density);
    double inside = 0, all = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      all += density[k];
      if (is_inside(at[k])) inside += density[k];
    }
    if (inside > 0) *level.texel(t.face, t.i, t.j) += Colour(radiance * (inside / all));
  }
}

inline void paint_disc(EnvironmentMap& map, const Direction& towards, double radius, const Flux& radiance) {
  const Direction axis = glm::normalize(towards) * image_to_world(map.forward);
  paint(map, towards, radius, radiance,
        [&](const Direction& d) { return glm::distance(d, axis) < 2 * std::sin(0.5 * radius * degree); });
}

// What painting added: samples are even, but a rim along a row of them is off by half a sample.
inline Flux added(const EnvironmentMap& map, const EnvironmentMap& before) {
  return flux(map.base()) - flux(before.base());
}

}  // namespace envmap::numeric_tests

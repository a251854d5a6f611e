// How well find_lights() finds a sun that is painted into a real probe: envmap-lights(1) has the figures.
//
//   painted_suns PROBE ROWS [PROJECTION [PLACES]]
//
// The probe is made as dense as a latlong map of ROWS rows, and a disc of the real sun's radius with as much light as
// all of it is added at ten places, one after another: poles, seams, edges of faces, rims, and between them. PLACES are
// numbers of those, such as 048. Each texel gets the part of the disc that midpoints find in it. Errors are those of
// the direction in degrees, and of the illuminance of a plane that faces the sun, in percent, the worst channel's.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "envmap/envmap.h"
#include "envmap/operate/measure.h"
#include "envmap/projection/visit.h"

namespace {

using namespace envmap;

constexpr double degree = pi / 180, radius = sun_radius_degrees * degree;
const double rim = 2 * std::sin(0.5 * radius);  // As a chord, which small angles keep their digits in.

const std::vector<Direction> places{{0, 1, 0},        {0.003, 1, 0.002}, {0, 0, -1},        {0.001, -0.3, -1},
                                    {1, 1, 0},        {1, 1, 1},         {0.02, 0.01, -1},  {0.6, 0.001, 0.8},
                                    {0.3, 0.5, 0.7},  {1, 0.2, 0.003}};

// The part of a texel that a disc covers: by its corners and middle, or where those differ by midpoints.
double part_of(const Level& level, int face, int i, int j, const Direction& axis) {
  constexpr int points = 48;
  const double w = level.width(), h = level.height();
  const std::vector<Point2> ends{{i / w, j / h},
                                 {(i + 1) / w, j / h},
                                 {i / w, (j + 1) / h},
                                 {(i + 1) / w, (j + 1) / h},
                                 {(i + 0.5) / w, (j + 0.5) / h}};
  std::vector<Direction> at(ends.size());
  directions(level.projection(), face, ends, at);
  double size = 0, nearest = 4, farthest = 0;
  for (const Direction& d : at) {
    const double off = glm::distance(d, axis);
    size = std::max(size, glm::distance(d, at.back()));
    nearest = std::min(nearest, off), farthest = std::max(farthest, off);
  }
  if (nearest > rim + 2 * size) return 0;
  if (farthest < rim && size < 0.25 * rim) return 1;
  std::vector<Point2> inner;
  for (int b = 0; b < points; ++b)
    for (int a = 0; a < points; ++a) inner.push_back({(i + (a + 0.5) / points) / w, (j + (b + 0.5) / points) / h});
  at.resize(inner.size());
  std::vector<double> density(inner.size());
  directions(level.projection(), face, inner, at);
  densities(level.projection(), inner, density);
  double covered = 0, all = 0;
  for (std::size_t k = 0; k < at.size(); ++k) {
    all += density[k];
    if (glm::distance(at[k], axis) < rim) covered += density[k];
  }
  return covered > 0 ? covered / all : 0;
}

void paint(EnvironmentMap& map, const Direction& towards, const Flux& radiance) {
  constexpr double around = 0.12;  // Beyond this no texel, however large, reaches the disc.
  Level& level = map.base();
  const Direction axis = towards * image_to_world(map.forward);
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j) {
      const Columns row = columns(level.projection(), level.height(), j);
      if (row.end <= row.first) continue;
      std::vector<Direction> middles(std::size_t(row.end - row.first));
      texel_directions(level.projection(), level.height(), face, j, row.first, middles);
      for (int i = row.first; i < row.end; ++i)
        if (glm::distance(middles[std::size_t(i - row.first)], axis) < around)
          *level.texel(face, i, j) += Colour(radiance * part_of(level, face, i, j, axis));
    }
}

struct Found {
  double off = 180, illuminance = 1;  // Degrees; relative.
};

Found find(const EnvironmentMap& base, const Direction& towards) {
  const double solid_angle = 4 * pi * std::pow(std::sin(0.5 * radius), 2);
  EnvironmentMap map = base.clone();
  const Flux before = flux(map.base());
  paint(map, towards, before / solid_angle);
  const Flux wanted = (flux(map.base()) - before) * 0.5 * (1 + std::cos(radius));
  Found best;
  for (const DiscLight& light : find_lights(map).lights) {
    const double off = angle_between(light.towards, towards) / degree;
    if (off >= best.off) continue;
    best = {off, 0};
    for (int c = 0; c < 3; ++c)
      best.illuminance = std::max(best.illuminance, std::abs(light.irradiance[c] / wanted[c] - 1));
  }
  return best;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return fmt::print("painted_suns PROBE ROWS [PROJECTION [PLACES]]\n"), 2;
  const Source source = read(argv[1]);
  const int rows = std::atoi(argv[2]);
  const std::string projection = argc > 3 ? argv[3] : "", numbers = argc > 4 ? argv[4] : "0123456789";
  for (const Projection to : all_projections) {
    if (!projection.empty() && name(to) != projection) continue;
    const int size = to == Projection::cube ? rows / 2 : rows;
    const Filter filter = size > source.map.base().height() ? Filter::bilinear : Filter::area;
    const EnvironmentMap base = convert(source.map, {.to = {to}, .size = size, .filter = filter});
    Found worst{0, 0};
    int missed = 0;
    for (const char number : numbers) {
      const Found found = find(base, glm::normalize(places.at(std::size_t(number - '0'))));
      if (found.off > 1) {
        ++missed;
        continue;
      }
      worst = {std::max(worst.off, found.off), std::max(worst.illuminance, found.illuminance)};
    }
    fmt::print("{:<10} {:5}: direction within {:.4f} degrees, illuminance within {:.5f}%, {} of {} missed\n", name(to),
               size, worst.off, 100 * worst.illuminance, missed, numbers.size());
  }
}

#include "envmap/operate/grade.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/base/run_operation.h"
#include "envmap/maths/check_direction.h"
#include "envmap/maths/compensated_sum.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/check_options.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/refuse_flaws.h"
#include "envmap/projection/matching_size.h"

namespace envmap {
namespace {

double least(const Flux& c) { return std::min({c.x, c.y, c.z}); }
double largest(const Flux& c) { return std::max({c.x, c.y, c.z}); }

// y + s (c - y), with s as far down as keeps all channels from falling below 0.
Flux saturated(const Flux& c, double s, double y) {
  if (const double low = least(c); y + s * (low - y) < 0) s = y / (y - low);
  return glm::max(Flux(y) + s * (c - Flux(y)), Flux(0));
}

int parts(const Level& level) {
  const int rows_of_sphere = matching_size(level.projection(), level.height(), Projection::latlong);
  return std::max(1, (512 + rows_of_sphere - 1) / rows_of_sphere);
}

bool finite(const Colour& c) { return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z); }

struct Integral {
  Flux light{0};
  double weight = 0;
};

// Row j of every face of a level cut into `cuts` x `cuts` parts a texel. @param n image frame.
// @param weight of cos(n, l).
template <class Weight>
Integral integral_of_row(const Level& level, int j, int cuts, const Direction& n, const Weight& weight) {
  const int size = cuts * level.height(), width = size * aspect(level.projection());
  std::vector<double> angle(static_cast<std::size_t>(width));
  std::vector<Direction> towards(angle.size());
  solid_angles(level.projection(), size, j, angle);
  Integral sum;
  for (int face = 0; face < level.faces(); ++face) {
    texel_directions(level.projection(), size, face, j, 0, towards);
    const std::span<const Colour> texels = level.row(face, j / cuts);
    for (std::size_t i = 0; i < angle.size(); ++i) {
      const double w = angle[i] * weight(glm::dot(towards[i], n));
      const Colour& c = texels[i * texels.size() / angle.size()];
      if (w > 0 && finite(c)) sum.light += w * Flux(c), sum.weight += w;
    }
  }
  return sum;
}

// Of L weight(cos(n, l)) over the sphere. @param normal in the world.
template <class Weight>
Integral integral(const EnvironmentMap& map, const Direction& normal, const Weight& weight) {
  const Level& level = map.base();
  const Direction n = glm::transpose(image_to_world(map.frame().forward)) * normal;
  const int cuts = parts(level);
  CompensatedSum light[3], weights;
  for (const Integral& row : map_rows<Integral>(cuts * level.height(), [&](int j) {
         level.trim();
         return integral_of_row(level, j, cuts, n, weight);
       })) {
    for (int c = 0; c < 3; ++c) light[c].add(row.light[c]);
    weights.add(row.weight);
  }
  return {{light[0].value(), light[1].value(), light[2].value()}, weights.value()};
}

}  // namespace

void apply(const Grade& grade, Level& level) {
  check_not_negative("gain", grade.gain);
  check_finite("luminance", grade.luminance);  // Blue of ACES2065-1 counts below 0.
  check_range(limits::saturation, grade.saturation);
  require_finite(level);
  for_each_row(level.faces(), level.height(), {}, [&](int face, int j) {
    for (Colour& texel : level.row(face, j)) {
      const Flux c = grade.gain * Flux(texel);
      texel = Colour(grade.saturation == 1 ? c : saturated(c, grade.saturation, glm::dot(c, grade.luminance)));
    }
    level.trim();
  });
}

void add_light(EnvironmentMap& map, const EnvironmentMap& other, double gain, const Run& run) {
  require_finite(map);
  run_operation(run, [&](const Progress& progress) {
    const Rows more = Resampler(other, {.to = map.frame(), .size = map.base().height(), .gain = gain}).rows();
    Level& level = map.base();
    if (more.width() != level.width())
      throw UsageError("the map to add to must have the proportions of its projection");
    for_each_row(level.faces(), level.height(), progress, [&](int face, int row) {
      std::vector<Colour> added(std::size_t(level.width()));
      more.fill(face, row, added);
      const std::span<Colour> out = level.row(face, row);
      for (std::size_t i = 0; i < added.size(); ++i) out[i] += added[i];
      level.trim();
    });
  });
}

Flux into_gamut(const Flux& colour, const Flux& luminance) {
  if (!(least(colour) < 0)) return colour;
  const double y = glm::dot(colour, luminance);
  return y > 0 ? saturated(colour, 1, y) : Flux(0);
}

std::int64_t into_gamut(Level& level, const Flux& luminance) {
  check_finite("luminance", luminance);
  const auto rows = map_level<std::int64_t>(level, [&](std::int64_t& outside, int face, int row) {
    for (Colour& texel : level.row(face, row)) {
      const Flux c(texel);
      if (!(least(c) < 0)) continue;
      if (least(c) < -1e-3 * largest(c)) ++outside;
      texel = Colour(into_gamut(c, luminance));
    }
  });
  return std::accumulate(rows.begin(), rows.end(), std::int64_t{0});
}

Flux irradiance(const EnvironmentMap& map, const Direction& normal) {
  return integral(map, checked_direction("normal", normal), [](double cosine) { return std::max(0.0, cosine); }).light;
}

Flux radiance_within(const EnvironmentMap& map, const Direction& towards, double degrees) {
  const Direction middle = checked_direction("towards", towards);
  check_range({"degrees", 0, 180}, degrees);
  const double least_cosine = portable::cos(degrees * pi / 180);
  const Integral seen = integral(map, middle, [=](double cosine) { return cosine >= least_cosine ? 1.0 : 0.0; });
  return seen.weight > 0 ? seen.light / seen.weight : Flux(0);
}

Flux white_balance(const Flux& colour, const Flux& luminance) {
  check_not_negative("colour", colour);
  check_finite("luminance", luminance);
  if (!(least(colour) > 0)) throw UsageError("what shall be grey has a channel that is 0: no gain makes it grey");
  return Flux(glm::dot(colour, luminance)) / colour;
}

Flux white_balance(double kelvin, const Primaries& primaries) {
  const Point2 xy = black_body(kelvin);
  const Flux xyz(xy.x / xy.y, 1, (1 - xy.x - xy.y) / xy.y);
  return white_balance(glm::inverse(to_xyz(primaries)) * xyz, luminance_weights(primaries));
}

}  // namespace envmap

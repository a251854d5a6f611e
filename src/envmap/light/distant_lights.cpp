#include "envmap/light/distant_lights.h"

#include <algorithm>
#include <cmath>

#include "envmap/base/bounds.h"
#include "envmap/maths/luminance.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/convert.h"
#include "envmap/projection/visit.h"

namespace envmap {
namespace {

constexpr int sky_rows = 128, sky_columns = 2 * sky_rows;

struct SkyTexel {
  Direction from;
  Flux irradiance;
  double luminance;
};

std::vector<SkyTexel> texels_of(const EnvironmentMap& environment) {
  std::vector<SkyTexel> texels;
  const EnvironmentMap map =
      convert(environment, {.to = Projection::latlong, .size = sky_rows, .filter = Filter::area});
  std::vector<Direction> from(sky_columns);
  std::vector<double> solid_angle(sky_columns);
  for (int row = 0; row < sky_rows; ++row) {
    texel_directions(Projection::latlong, sky_rows, 0, row, 0, from);
    solid_angles(Projection::latlong, sky_rows, row, solid_angle);
    for (int i = 0; i < sky_columns; ++i) {
      const Flux all = solid_angle[std::size_t(i)] * Flux(*map.base().texel(0, i, row));
      texels.push_back({from[std::size_t(i)], all, luminance_of(all)});
    }
  }
  return texels;
}

// Texels from a left and an upper one to a right and a lower one, without these.
struct Part {
  int left, upper, right, lower;
  double luminance;
};

class Sky {
 public:
  explicit Sky(std::vector<SkyTexel> texels) : texels_(std::move(texels)) {}

  [[nodiscard]] Part part(int left, int upper, int right, int lower) const {
    double sum = 0;
    for (int j = upper; j < lower; ++j)
      for (int i = left; i < right; ++i) sum += at(i, j).luminance;
    return {left, upper, right, lower, sum};
  }

  // Two parts of nearly the same luminance; the part itself where it is one texel.
  [[nodiscard]] std::vector<Part> halves(const Part& p) const {
    const double latitude = 0.5 - 0.5 * (p.upper + p.lower) / sky_rows;  // Over pi.
    const bool across = (p.right - p.left) * portable::cos_pi(latitude) > p.lower - p.upper;
    const bool wide = p.lower - p.upper == 1 || (across && p.right - p.left > 1);
    const int from = wide ? p.left : p.upper, to = wide ? p.right : p.lower;
    if (to - from == 1) return {p};
    const auto before = [&](int cut) {
      return wide ? part(p.left, p.upper, cut, p.lower) : part(p.left, p.upper, p.right, cut);
    };
    const auto after = [&](int cut) {
      return wide ? part(cut, p.upper, p.right, p.lower) : part(p.left, cut, p.right, p.lower);
    };
    const auto apart = [&](int cut) { return std::abs(2 * before(cut).luminance - p.luminance); };
    int best = from + 1;
    double least = apart(best);
    for (int cut = from + 2; cut < to; ++cut)
      if (const double here = apart(cut); here < least) best = cut, least = here;
    return {before(best), after(best)};
  }

  [[nodiscard]] DistantLight light(const Part& p) const {
    Direction sum(0);
    Flux irradiance(0);
    for (int j = p.upper; j < p.lower; ++j)
      for (int i = p.left; i < p.right; ++i) {
        sum += at(i, j).luminance * at(i, j).from;
        irradiance += at(i, j).irradiance;
      }
    const double length = glm::length(sum);
    return {length > 0 ? sum / length : at(p.left, p.upper).from, Colour(irradiance)};
  }

 private:
  [[nodiscard]] const SkyTexel& at(int i, int j) const { return texels_[std::size_t(j * sky_columns + i)]; }
  std::vector<SkyTexel> texels_;
};

}  // namespace

std::vector<DistantLight> distant_lights(const EnvironmentMap& environment, int count) {
  check_range({"count", 1, max_distant_lights}, count);
  const Sky sky(texels_of(environment));
  std::vector<Part> parts{sky.part(0, 0, sky_columns, sky_rows)}, whole;
  while (!parts.empty() && int(parts.size() + whole.size()) < count) {
    const auto brightest = std::ranges::max_element(parts, {}, &Part::luminance);
    const std::vector<Part> halves = sky.halves(*brightest);
    parts.erase(brightest);
    (halves.size() == 1 ? whole : parts)
        .insert((halves.size() == 1 ? whole : parts).end(), halves.begin(), halves.end());
  }
  parts.insert(parts.end(), whole.begin(), whole.end());
  std::vector<DistantLight> lights;
  for (const Part& p : parts)
    if (p.luminance > 0) lights.push_back(sky.light(p));
  return lights;
}

}  // namespace envmap

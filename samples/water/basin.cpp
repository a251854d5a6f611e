#include "basin.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace water {
namespace {

constexpr double eta = 0.75;  // Air to water.

struct Place {
  double x, y;  // In columns.
};

Place place(const View& v, const Direction& p) {
  return {(p.x / v.basin.wide + 1) * 0.5 * (v.field.columns() - 1), (p.z / v.basin.deep + 1) * 0.5 * (v.field.rows() - 1)};
}

Direction normal_at(const Basin& basin, const HeightField& field, double x, double y) {
  const double dx = (field.at(x + 1, y) - field.at(x - 1, y)) * (field.columns() - 1) / (4 * basin.wide);
  const double dz = (field.at(x, y + 1) - field.at(x, y - 1)) * (field.rows() - 1) / (4 * basin.deep);
  return glm::normalize(Direction(-dx, 1, -dz));
}

Flux sky_at(const View& v, const Direction& d) {
  const bool in_disc = envmap::angle_between(d, v.sun) < 2 * envmap::pi / 180;
  return Flux(v.sky(glm::transpose(sky_axes()) * d)) + (in_disc ? v.disc : Flux(0));
}

// Tiles of 10 cm with joints, in the two coordinates of a side.
Flux tiles(double a, double b) {
  const double u = a * 10, w = b * 10, fu = u - std::floor(u), fw = w - std::floor(w);
  if (std::min({fu, fw, 1 - fu, 1 - fw}) < 0.04) return Flux(0.75, 0.75, 0.7);
  const int kind = static_cast<int>(std::floor(u)) * 7 + static_cast<int>(std::floor(w)) * 13;
  const double shade = 0.85 + 0.05 * (((kind % 5) + 5) % 5);
  return Flux(0.12, 0.5, 0.62) * shade;
}

// Where a ray from inside leaves the walls and the floor, and what is there in even light and sun.
Flux inside(const View& v, const Direction& from, const Direction& d, bool under_water) {
  const Basin& b = v.basin;
  const auto reach = [](double at, double along, double lo, double hi) {
    return along > 0 ? (hi - at) / along : along < 0 ? (lo - at) / along : 1e30;
  };
  const double tx = reach(from.x, d.x, -b.wide, b.wide), tz = reach(from.z, d.z, -b.deep, b.deep);
  const double ty = reach(from.y, d.y, b.floor, 1e30), t = std::max(0.0, std::min({tx, ty, tz}));
  const Direction p = from + t * d;
  Flux colour;
  double sunlight = 0.35;
  if (ty <= tx && ty <= tz) {
    const Place at = place(v, p);
    const auto column = [](double k, int size) {
      return static_cast<std::size_t>(std::clamp(static_cast<int>(k + 0.5), 0, size - 1));
    };
    sunlight =
        v.caustics[column(at.y, v.field.rows()) * static_cast<std::size_t>(v.field.columns()) + column(at.x, v.field.columns())];
    colour = tiles(p.x, p.z);
  } else {
    colour = tx < tz ? tiles(p.z, p.y) : tiles(p.x, p.y);
  }
  colour *= 0.35 + 0.65 * sunlight;
  if (!under_water) return colour;
  // Beer's law on the way up and down again; red goes first.
  const double way = t + std::max(0.0, -p.y);
  return colour * glm::exp(-way * Flux(0.7, 0.16, 0.1));
}

// The first place on a ray where it is below the surface: steps of half a column through the layer of waves, then halving.
std::optional<double> meet_water(const View& v, const Direction& from, const Direction& d, double begin, double end) {
  const auto above = [&](double t) {
    const Direction p = from + t * d;
    const Place at = place(v, p);
    return p.y - v.field.at(at.x, at.y);
  };
  constexpr double highest = 0.08;
  if (d.y < 0) begin = std::max(begin, (highest - from.y) / d.y);
  const double step = v.basin.wide / v.field.columns();
  for (double t = begin; t < end; t += step) {
    if (above(t + step) > 0) continue;
    double lo = t, hi = t + step;
    for (int k = 0; k < 24; ++k) (above(0.5 * (lo + hi)) > 0 ? lo : hi) = 0.5 * (lo + hi);
    return hi < end ? std::optional(hi) : std::nullopt;
  }
  return std::nullopt;
}

Flux surface(const View& v, const Direction& p, const Direction& d) {
  const Place at = place(v, p);
  const Direction n = normal_at(v.basin, v.field, at.x, at.y);
  const double cosine = std::max(1e-3, -glm::dot(n, d)), reflected = fresnel(cosine, eta);
  Direction up = glm::reflect(d, n);
  up.y = std::max(up.y, 0.0);  // A wave's back, reflected downwards, would see the next wave.
  return reflected * sky_at(v, glm::normalize(up)) + (1 - reflected) * inside(v, p, glm::refract(d, n, eta), true);
}

}  // namespace

envmap::Rotation sky_axes() { return envmap::rotation(0, -90, 0); }

double fresnel(double cosine, double ratio) {
  const double sine2 = ratio * ratio * (1 - cosine * cosine);
  if (sine2 >= 1) return 1;
  const double within = std::sqrt(1 - sine2);
  const double across = (ratio * cosine - within) / (ratio * cosine + within);
  const double along = (ratio * within - cosine) / (ratio * within + cosine);
  return 0.5 * (across * across + along * along);
}

std::vector<float> caustics(const Basin& basin, const HeightField& field, const Direction& sun) {
  const int columns = field.columns(), rows = field.rows();
  std::vector<float> light(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0.0F);
  const auto splat = [&](double x, double y, double amount) {
    const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
    for (int b = 0; b < 2; ++b)
      for (int a = 0; a < 2; ++a) {
        // What goes beyond the floor is mirrored back: walls of light tiles.
        const auto back = [](int k, int size) {
          return std::clamp(k < 0 ? -1 - k : k >= size ? 2 * size - 1 - k : k, 0, size - 1);
        };
        const double weight = (a ? x - i : 1 - x + i) * (b ? y - j : 1 - y + j);
        light[static_cast<std::size_t>(back(j + b, rows)) * static_cast<std::size_t>(columns) +
              static_cast<std::size_t>(back(i + a, columns))] += static_cast<float>(amount * weight);
      }
  };
  constexpr int fine = 3;  // Rays along each side of a column.
  for (int j = 0; j < rows * fine; ++j)
    for (int i = 0; i < columns * fine; ++i) {
      const double x = (i + 0.5) / fine - 0.5, y = (j + 0.5) / fine - 0.5;
      const Direction n = normal_at(basin, field, x, y), d = glm::refract(-sun, n, eta);
      const double t = (basin.floor - field.at(x, y)) / d.y;
      splat(x + t * d.x / basin.wide * 0.5 * (columns - 1), y + t * d.z / basin.deep * 0.5 * (rows - 1), 1.0 / (fine * fine));
    }
  return light;
}

Flux look(const View& v, const Direction& from, const Direction& d) {
  const Basin& b = v.basin;
  if (d.y >= 0) return sky_at(v, d);
  const double top = (b.rim - from.y) / d.y;
  const Direction p = from + top * d;
  const double x = std::abs(p.x), z = std::abs(p.z);
  if (x <= b.wide && z <= b.deep) {
    const double end = std::min(d.x == 0 ? 1e30 : ((d.x > 0 ? b.wide : -b.wide) - from.x) / d.x,
                                d.z == 0 ? 1e30 : ((d.z > 0 ? b.deep : -b.deep) - from.z) / d.z);
    if (const auto t = meet_water(v, from, d, top, end)) return surface(v, from + *t * d, d);
    return inside(v, p, d, false);
  }
  if (x <= b.wide + b.border && z <= b.deep + b.border) {
    const double joint = std::abs(std::remainder(x > b.wide ? p.z : p.x, 0.4));
    return Flux(0.62, 0.58, 0.52) * (joint < 0.006 ? 0.6 : 1.0);
  }
  // The outer side of the rim, and the ground around.
  return p.z > 0 && x <= b.wide + b.border && p.z + (b.rim + 0.25) / -d.y * d.z < b.deep + b.border
             ? Flux(0.4, 0.37, 0.33)
             : Flux(0.2, 0.26, 0.12);
}

}  // namespace water

#include "envmap/operate/importance_sampling.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <vector>

#include "envmap/base/bounds.h"
#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/base/run_operation.h"
#include "envmap/maths/check_direction.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/brightest.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/refuse_flaws.h"

namespace envmap {

struct ImportanceSampler::Tables {
  // Of the alias table: the part of a bin that is its own, and whose the rest is.
  struct Bin {
    float own;
    std::uint32_t other;
  };

  Projection projection;
  int width, height, faces;
  Rotation to_world;
  std::vector<Bin> bins;       // Of all texels: faces, rows, columns.
  std::vector<double> share;   // Of the light, of each texel.
  std::vector<double> angles;  // Solid angle of the texels of a latlong row.

  [[nodiscard]] std::size_t index(int face, int i, int j) const {
    return (std::size_t(face) * std::size_t(height) + std::size_t(j)) * std::size_t(width) + std::size_t(i);
  }

  // Vose's method: bins that hold less than the mean are filled up by those that hold more. @param share adds up to 1.
  static std::vector<Bin> alias_table(const std::vector<double>& share) {
    const std::size_t count = share.size();
    std::vector<Bin> bins(count);
    std::vector<double> scaled(count);
    std::vector<std::uint32_t> small, large;
    for (std::size_t k = 0; k < count; ++k) {
      scaled[k] = share[k] * double(count);
      (scaled[k] < 1 ? small : large).push_back(std::uint32_t(k));
    }
    while (!small.empty() && !large.empty()) {
      const std::uint32_t less = small.back(), more = large.back();
      small.pop_back();
      bins[less] = {float(scaled[less]), more};
      scaled[more] -= 1 - scaled[less];
      if (scaled[more] >= 1) continue;
      large.pop_back();
      small.push_back(more);
    }
    for (const std::vector<std::uint32_t>& full : {small, large})
      for (const std::uint32_t k : full) bins[k] = {1, k};
    return bins;
  }

  // Per steradian, in texel k at a place of a face. Within a texel of a latlong map directions are drawn evenly over
  // the sphere, within one of a cube evenly over the face.
  [[nodiscard]] double density(std::size_t k, const Point2& at) const {
    if (projection == Projection::latlong) return share[k] / angles[k / std::size_t(width)];
    return share[k] * double(width) * double(height) / density_at(projection, at);
  }
};

namespace {

// Cosine of the polar angle at the upper edge of a row of a latlong map.
double cosine_above(int row, int height) { return portable::cos(pi * row / height); }

}  // namespace

ImportanceSampler::ImportanceSampler(const EnvironmentMap& map, const Run& run) {
  require_radiance(map);
  tables_ = run_operation(run, [&](const Progress&) {
    const bool plain = map.projection() == Projection::cube || map.projection() == Projection::latlong;
    const std::optional<EnvironmentMap> cube =
        plain ? std::nullopt : std::optional(convert(map, {.to = {Projection::cube}, .filter = Filter::area}));
    const EnvironmentMap& from = cube ? *cube : map;
    const Level& level = from.base();
    Tables t{
        level.projection(), level.width(), level.height(), level.faces(), image_to_world(from.forward), {}, {}, {}};
    t.share.resize(t.index(t.faces, 0, 0));
    if (level.projection() == Projection::latlong) t.angles.resize(std::size_t(t.height));
    for_each_row(t.faces, t.height, {}, [&](int face, int j) {
      std::vector<double> angles(std::size_t(t.width));
      solid_angles(t.projection, t.height, j, angles);
      if (!t.angles.empty()) t.angles[std::size_t(j)] = angles.front();
      for (int i = 0; i < t.width; ++i)
        t.share[t.index(face, i, j)] = angles[std::size_t(i)] * luminance_of(*level.texel(face, i, j));
    });
    const double all = std::accumulate(t.share.begin(), t.share.end(), 0.0);
    if (!(all > 0)) throw InputError("is black: no direction of it can be drawn by its light");
    for (double& share : t.share) share /= all;
    t.bins = Tables::alias_table(t.share);
    return std::make_shared<const Tables>(std::move(t));
  });
}

ImportanceSampler::Sample ImportanceSampler::sample(const Point2& u) const {
  constexpr Bounds unit{"u", 0, 1};
  check_range(unit, u.x), check_range(unit, u.y);
  if (u.x == 1 || u.y == 1) throw UsageError("u must be below 1");
  const Tables& t = *tables_;
  // One number finds the texel, and what is left of it the column in it.
  const double place = u.x * double(t.bins.size());
  const std::size_t bin = std::min(std::size_t(place), t.bins.size() - 1);
  const double rest = place - double(bin), own = t.bins[bin].own;
  const std::size_t k = rest < own ? bin : t.bins[bin].other;
  const double right = std::clamp(rest < own ? rest / own : (rest - own) / (1 - own), 0.0, 1.0);
  const auto column = double(k % std::size_t(t.width)) + right;
  const int row = int(k / std::size_t(t.width) % std::size_t(t.height));
  const int face = int(k / (std::size_t(t.width) * std::size_t(t.height)));
  Point2 at(column / t.width, (row + u.y) / t.height);
  if (t.projection == Projection::latlong) {
    const double up = glm::mix(cosine_above(row, t.height), cosine_above(row + 1, t.height), u.y);
    at.y = portable::acos(std::clamp(up, -1.0, 1.0)) / pi;
  }
  return {t.to_world * direction_at(t.projection, face, at), t.density(k, at)};
}

double ImportanceSampler::pdf(const Direction& direction) const {
  const Tables& t = *tables_;
  const Location<double> at =
      locate(t.projection, glm::transpose(t.to_world) * checked_direction("direction", direction));
  const int i = std::clamp(int(at.u * t.width), 0, t.width - 1), j = std::clamp(int(at.v * t.height), 0, t.height - 1);
  return t.density(t.index(at.face, i, j), {at.u, at.v});
}

}  // namespace envmap

#include "envmap/scenes/render/rays/environment_sampler.h"

#include <algorithm>
#include <cmath>

#include "envmap/maths/luminance.h"
#include "envmap/operate/convert.h"
#include "envmap/projection/latlong.h"

namespace envmap {
namespace {

// Cosine of the polar angle at the upper edge of a row.
double cosine_above(int row, int height) { return std::cos(pi * row / height); }

// @return the cell that holds x, and how far x reaches into it, 0 to 1. @param sums rising, from 0.
std::pair<int, double> find(const double* sums, int count, double x) {
  const auto cell = int(std::upper_bound(sums + 1, sums + count, x) - (sums + 1));
  const double size = sums[cell + 1] - sums[cell];
  return {cell, size > 0 ? std::clamp((x - sums[cell]) / size, 0.0, 1.0) : 0.5};
}

}  // namespace

EnvironmentSampler::EnvironmentSampler(const EnvironmentMap& map)
    : rows_(height + 1, 0), cells_(height * (width + 1), 0) {
  const EnvironmentMap cells = convert(map, {.to = {Projection::latlong}, .size = height});
  for (int row = 0; row < height; ++row) {
    const double solid_angle = 2 * pi / width * (cosine_above(row, height) - cosine_above(row + 1, height));
    double* const sums = &cells_[row * (width + 1)];
    for (int i = 0; i < width; ++i) {
      const Flux radiance(*cells.base().texel(0, i, row));
      sums[i + 1] = sums[i] + solid_angle * std::max(0.0, luminance_of(radiance));
    }
    rows_[row + 1] = rows_[row] + sums[width];
  }
}

EnvironmentSampler::Sample EnvironmentSampler::sample(const Point2& u) const {
  if (rows_.back() <= 0) return {{0, 0, 1}, 0};
  const auto [row, down] = find(rows_.data(), height, u.y * rows_.back());
  const double* const sums = &cells_[row * (width + 1)];
  const auto [column, right] = find(sums, width, u.x * sums[width]);
  const double y = glm::mix(cosine_above(row, height), cosine_above(row + 1, height), down);
  const Direction from = Latlong::direction(0, (column + right) / width, std::acos(std::clamp(y, -1.0, 1.0)) / pi);
  return {from, density(from)};
}

double EnvironmentSampler::density(const Direction& from) const {
  if (rows_.back() <= 0) return 0;
  const Location<double> at = Latlong::locate(from);
  const int i = std::clamp(int(at.u * width), 0, width - 1), row = std::clamp(int(at.v * height), 0, height - 1);
  const double* const sums = &cells_[row * (width + 1)];
  const double solid_angle = 2 * pi / width * (cosine_above(row, height) - cosine_above(row + 1, height));
  return (sums[i + 1] - sums[i]) / (solid_angle * rows_.back());
}

}  // namespace envmap

#include "envmap/operate/lookup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "envmap/base/check_length.h"
#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/base/run_operation.h"
#include "envmap/maths/check_direction.h"
#include "envmap/operate/refuse_flaws.h"
#include "envmap/projection/visit.h"
#include "envmap/sample/padded_level.h"
#include "envmap/sample/point.h"

namespace envmap {
namespace {

void check_rising(std::span<const double> roughnesses, std::size_t levels) {
  if (roughnesses.size() != levels)
    throw UsageError(fmt::format("roughnesses must be as many as the {} levels, not {}", levels, roughnesses.size()));
  for (std::size_t k = 0; k < roughnesses.size(); ++k)
    if (!std::isfinite(roughnesses[k]) || (k > 0 && roughnesses[k] <= roughnesses[k - 1]))
      throw UsageError(
          fmt::format("roughnesses must rise from level to level: that of level {} is {:g}", k, roughnesses[k]));
}

}  // namespace

struct EnvironmentLookup::Levels {
  std::vector<PaddedLevel> levels;
  Rotation world_to_image;
  std::vector<double> roughnesses;

  // @param d of the world, of any length.
  [[nodiscard]] Colour at(const Direction& d, double level) const {
    const double square = glm::dot(d, d);
    if (!(square > 0 && std::isfinite(square))) return Colour(0);
    // Unit vectors stay as they are, to the last bit.
    const Direction in_image = world_to_image * (is_unit(d) ? d : d / std::sqrt(square));
    const Location<double> place =
        visit(levels.front().projection(), [&](auto p) { return decltype(p)::template locate<double>(in_image); });
    const double last = double(levels.size() - 1), clamped = level > 0 ? std::min(level, last) : 0;
    const auto finer = std::size_t(clamped);
    const Colour found = bilinear(levels[finer], place);
    const auto part = float(clamped - double(finer));
    return part > 0 ? (1 - part) * found + part * bilinear(levels[finer + 1], place) : found;
  }

  template <class D>
  void look_all(std::span<const D> directions, std::span<Colour> out, double level, const Run& run) const {
    constexpr std::size_t step = 1024;  // Directions that a thread takes at once.
    check_length("out", out.size(), directions.size());
    run_operation(run, [&](const Progress&) {
      parallel_for(int((out.size() + step - 1) / step), [&](int part) {
        const std::size_t begin = std::size_t(part) * step, end = std::min(begin + step, out.size());
        for (std::size_t k = begin; k < end; ++k) out[k] = at(Direction(directions[k]), level);
      });
    });
  }
};

EnvironmentLookup::EnvironmentLookup(EnvironmentMap&& map) : EnvironmentLookup(std::move(map), {}) {}

EnvironmentLookup::EnvironmentLookup(EnvironmentMap&& map, std::vector<double> roughnesses) {
  const Projection projection = map.projection();
  if (!roughnesses.empty()) check_rising(roughnesses, map.levels.size());
  Levels made{.levels = {},
              .world_to_image = glm::transpose(image_to_world(map.forward)),
              .roughnesses = std::move(roughnesses)};
  for (Level& level : map.levels) {
    if (level.projection() != projection) throw UsageError("levels of one map must have one projection");
    require_finite(level);
    made.levels.emplace_back(std::move(level));
  }
  levels_ = std::make_shared<const Levels>(std::move(made));
}

Colour EnvironmentLookup::operator()(const Direction& direction, double level) const {
  return levels_->at(direction, level);
}

void EnvironmentLookup::operator()(std::span<const Direction> directions, std::span<Colour> out, double level,
                                   const Run& run) const {
  levels_->look_all(directions, out, level, run);
}

void EnvironmentLookup::operator()(std::span<const Vec3<float>> directions, std::span<Colour> out, double level,
                                   const Run& run) const {
  levels_->look_all(directions, out, level, run);
}

double EnvironmentLookup::level_at(double roughness) const {
  const std::vector<double>& known = levels_->roughnesses;
  if (known.empty()) throw UsageError("the levels have no roughnesses: give them with the map");
  if (!(roughness > known.front())) return 0;
  const auto above = std::ranges::upper_bound(known, roughness);
  if (above == known.end()) return double(known.size() - 1);
  const auto k = std::size_t(above - known.begin()) - 1;
  return double(k) + (roughness - known[k]) / (known[k + 1] - known[k]);
}

}  // namespace envmap

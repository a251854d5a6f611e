#include "envmap/operate/lookup.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "envmap/base/carry_out.h"
#include "envmap/base/check_length.h"
#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/maths/check_direction.h"
#include "envmap/operate/refuse_flaws.h"
#include "envmap/sample/padded_level.h"
#include "envmap/sample/point.h"

namespace envmap {
namespace {

constexpr std::size_t block = 256;  // Directions that are looked up together.

// The same direction at length 1; unit vectors stay as they are, to the last bit. Nothing where it has no direction.
bool make_unit(Direction& d) {
  const double square = glm::dot(d, d);
  if (!(square > 0 && std::isfinite(square))) return false;
  if (!is_unit(d)) d /= std::sqrt(square);
  return true;
}

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

  // @param d at most a block of directions of the world.
  template <class D>
  void look(std::span<const D> d, std::span<Colour> out, double level) const {
    std::array<Direction, block> towards;
    std::array<bool, block> known;
    for (std::size_t k = 0; k < d.size(); ++k) {
      towards[k] = Direction(d[k]);
      known[k] = make_unit(towards[k]);
      if (!known[k]) towards[k] = {0, 0, 1};
    }
    const std::span<Direction> units = std::span(towards).first(d.size());
    rotate(world_to_image, units);
    std::array<Location<double>, block> places;
    const std::span<Location<double>> at = std::span(places).first(d.size());
    locate(levels.front().projection(), units, at);
    const double last = double(levels.size() - 1), clamped = level > 0 ? std::min(level, last) : 0;
    const auto finer = std::size_t(clamped);
    sample_bilinear(levels[finer], at, out);
    if (const auto part = float(clamped - double(finer)); part > 0) {
      std::array<Colour, block> coarser;
      sample_bilinear(levels[finer + 1], at, std::span(coarser).first(d.size()));
      for (std::size_t k = 0; k < d.size(); ++k) out[k] = (1 - part) * out[k] + part * coarser[k];
    }
    for (std::size_t k = 0; k < d.size(); ++k)
      if (!known[k]) out[k] = Colour(0);
  }

  template <class D>
  void look_all(std::span<const D> directions, std::span<Colour> out, double level, const Run& run) const {
    check_length("out", out.size(), directions.size());
    run_operation(run, [&](const Progress&) {
      const auto blocks = int((directions.size() + block - 1) / block);
      parallel_ranges(blocks, 8, [&](int begin, int end) {
        for (std::size_t k = std::size_t(begin) * block; k < std::min(std::size_t(end) * block, out.size());
             k += block) {
          const std::size_t count = std::min(block, out.size() - k);
          look(directions.subspan(k, count), out.subspan(k, count), level);
        }
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
  Colour found;
  levels_->look(std::span(&direction, 1), std::span(&found, 1), level);
  return found;
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

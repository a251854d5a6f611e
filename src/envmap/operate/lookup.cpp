#include "envmap/operate/lookup.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "envmap/base/check_length.h"
#include "envmap/base/error.h"
#include "envmap/maths/check_direction.h"
#include "envmap/operate/refuse_flaws.h"
#include "envmap/projection/visit.h"
#include "envmap/sample/padded_level.h"
#include "envmap/sample/point.h"

namespace envmap {

struct EnvironmentLookup::Levels {
  std::vector<PaddedLevel> levels;
  Rotation world_to_image;

  // @param d a unit vector of the image's frame.
  [[nodiscard]] Colour at(const Direction& d, double level) const {
    const Location<double> place =
        visit(levels.front().projection(), [&](auto p) { return decltype(p)::template locate<double>(d); });
    const double last = double(levels.size() - 1), clamped = level > 0 ? std::min(level, last) : 0;
    const auto finer = std::size_t(clamped);
    const Colour found = bilinear(levels[finer], place);
    const auto part = float(clamped - double(finer));
    return part > 0 ? (1 - part) * found + part * bilinear(levels[finer + 1], place) : found;
  }
};

EnvironmentLookup::EnvironmentLookup(EnvironmentMap&& map) {
  Levels made{.levels = {}, .world_to_image = glm::transpose(image_to_world(map.forward))};
  const Projection projection = map.projection();
  for (Level& level : map.levels) {
    if (level.projection() != projection) throw UsageError("levels of one map must have one projection");
    require_finite(level);
    made.levels.emplace_back(std::move(level));
  }
  levels_ = std::make_shared<const Levels>(std::move(made));
}

Colour EnvironmentLookup::operator()(const Direction& direction, double level) const {
  const double square = glm::dot(direction, direction);
  if (!(square > 0 && std::isfinite(square))) return Colour(0);
  // Unit vectors stay as they are, to the last bit.
  return levels_->at(levels_->world_to_image * (is_unit(direction) ? direction : direction / std::sqrt(square)), level);
}

void EnvironmentLookup::operator()(std::span<const Direction> directions, std::span<Colour> out, double level) const {
  check_length("out", out.size(), directions.size());
  std::ranges::transform(directions, out.begin(), [&](const Direction& d) { return (*this)(d, level); });
}

}  // namespace envmap

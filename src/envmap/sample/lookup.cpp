#include "envmap/sample/lookup.h"

#include <cmath>

#include "envmap/projection/visit.h"
#include "envmap/sample/padded_level.h"
#include "envmap/sample/point.h"

namespace envmap {

EnvironmentLookup::EnvironmentLookup(Level&& level, Forward forward)
    : level_(std::make_shared<const PaddedLevel>(std::move(level))),
      world_to_image_(glm::transpose(image_to_world(forward))) {}

Colour EnvironmentLookup::operator()(const Direction& direction) const {
  const double square = glm::dot(direction, direction);
  if (!(square > 0 && std::isfinite(square))) return Colour(0);
  // Unit vectors stay as they are, to the last bit.
  const Direction d = world_to_image_ * (std::abs(square - 1) < 1e-9 ? direction : direction / std::sqrt(square));
  return bilinear(*level_,
                  visit(level_->projection(), [&](auto p) { return decltype(p)::template locate<double>(d); }));
}

}  // namespace envmap

#include "envmap/operate/check_options.h"

#include <fmt/format.h>

#include <cmath>

#include "envmap/base/error.h"

namespace envmap {

void check_rotation(std::string_view field, const Rotation& rotation) {
  const Rotation product = glm::transpose(rotation) * rotation;
  bool close = std::abs(glm::determinant(rotation) - 1) <= 1e-6;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) close = close && std::abs(product[i][j] - (i == j ? 1 : 0)) <= 1e-6;
  if (!close) throw UsageError(fmt::format("{} must be a rotation: orthonormal columns and determinant 1", field));
}

void check_finite(std::string_view field, const Flux& value) {
  for (int k = 0; k < 3; ++k)
    if (!std::isfinite(value[k]))
      throw UsageError(fmt::format("{} must be finite, not ({:g}, {:g}, {:g})", field, value.x, value.y, value.z));
}

void check_not_negative(std::string_view field, const Flux& value) {
  for (int k = 0; k < 3; ++k)
    if (!(std::isfinite(value[k]) && value[k] >= 0))
      throw UsageError(
          fmt::format("{} must be finite and at least 0, not ({:g}, {:g}, {:g})", field, value.x, value.y, value.z));
}

}  // namespace envmap

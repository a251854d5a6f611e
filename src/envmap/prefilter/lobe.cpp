#include "envmap/prefilter/lobe.h"

#include <fmt/format.h>

#include <cmath>

#include "envmap/base/bounds.h"
#include "envmap/base/error.h"

namespace envmap {

// The field is `parameter`, whatever the lobe calls it.
Lobe::Lobe(LobeShape shape, double parameter) : shape_(shape), parameter_(parameter) {
  const std::string_view name = lobe_shape_names[number_of("shape", shape)];
  const bool given = !std::isnan(parameter);
  if (shape == LobeShape::diffuse) {
    if (given) throw UsageError(fmt::format("{} takes no parameter: leave it unset, not {:g}", name, parameter));
    return;
  }
  const bool power = shape == LobeShape::phong || shape == LobeShape::blinn_phong;
  const Bounds& range = power ? limits::exponent : limits::roughness;
  if (!given) throw UsageError(fmt::format("{} needs a parameter, its {}: it is unset, or NaN", name, range.field));
  check_range({"parameter", range.least, range.most}, parameter);
}

std::vector<Lobe> lobes_of(LobeShape shape, std::span<const double> parameters) {
  std::vector<Lobe> lobes;
  lobes.reserve(parameters.size());
  for (const double parameter : parameters) lobes.emplace_back(shape, parameter);
  return lobes;
}

}  // namespace envmap

#include "envmap/prefilter/lobe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "envmap/base/bounds.h"
#include "envmap/base/error.h"

namespace envmap {

namespace {

// The same samples by rising cosine.
std::vector<LobeSample> checked(std::vector<LobeSample> samples) {
  if (samples.size() < 2) throw UsageError(fmt::format("a table needs two samples or more, not {}", samples.size()));
  constexpr double least_step = 1e-9;  // A slope between two samples keeps its digits.
  const bool falling = samples.front().cosine > samples.back().cosine;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const auto [cosine, value] = samples[k];
    if (!(cosine >= 0 && cosine <= 1))
      throw UsageError(fmt::format("sample {}: cosine must be 0 to 1, not {:g}", k + 1, cosine));
    if (!(value >= 0 && std::isfinite(value)))
      throw UsageError(fmt::format("sample {}: value must be finite and not negative, not {:g}", k + 1, value));
    if (k > 0 && !((falling ? -1 : 1) * (cosine - samples[k - 1].cosine) >= least_step))
      throw UsageError(fmt::format("sample {}: cosines must {} by 1e-9 or more: {:.17g} follows {:.17g}", k + 1,
                                   falling ? "fall" : "rise", cosine, samples[k - 1].cosine));
  }
  if (falling) std::ranges::reverse(samples);
  if (samples.back().cosine != 1)
    throw UsageError(fmt::format("a table needs a sample at cosine 1 (angle 0): the largest cosine is {:.17g}",
                                 samples.back().cosine));
  if (std::ranges::none_of(samples, [](const LobeSample& s) { return s.value > 0; }))
    throw UsageError("a table needs a value above 0");
  return samples;
}

}  // namespace

Lobe Lobe::table(std::vector<LobeSample> samples) {
  Lobe lobe = diffuse();
  lobe.shape_ = LobeShape::table;
  lobe.samples_ = std::make_shared<const std::vector<LobeSample>>(checked(std::move(samples)));
  return lobe;
}

std::span<const LobeSample> Lobe::samples() const {
  return samples_ ? std::span<const LobeSample>(*samples_) : std::span<const LobeSample>();
}

// The field is `parameter`, whatever the lobe calls it.
Lobe::Lobe(LobeShape shape, double parameter) : shape_(shape), parameter_(parameter) {
  const std::string_view name = lobe_shape_names[number_of("shape", shape)];
  const bool given = !std::isnan(parameter);
  if (shape == LobeShape::diffuse) {
    if (given) throw UsageError(fmt::format("{} takes no parameter: leave it unset, not {:g}", name, parameter));
    return;
  }
  if (shape == LobeShape::table) throw UsageError("a table has samples: make it by Lobe::table()");
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

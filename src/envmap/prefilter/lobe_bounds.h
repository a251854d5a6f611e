/// @file
/// What a lobe is at most and at least, without its exponentials: tables for the walk through the tree.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "envmap/prefilter/lobe.h"

namespace envmap {

/// Tables over x = 1 - cos with 32 steps an octave, from 2^-48 to 1/2, and from there over 1 - x down to 2^-32.
class LobeBounds {
 public:
  /// What holds for all x of a step.
  struct Step {
    float value, second, third;  ///< At its beginning: the value never rises, derivatives are monotonic.
  };

  explicit LobeBounds(const Lobe& lobe) {
    std::visit(
        [&](const auto& l) {
          for (std::uint32_t k = 0; k < steps; ++k) {
            const double x = edge(k);
            steps_.push_back(
                {static_cast<float>(l.value(x)), static_cast<float>(l.second(x)), static_cast<float>(l.third(x))});
          }
        },
        lobe);
    steps_.insert(steps_.end(), 2, Step{});
  }
  /// The step of x; the lobe is at most its value, and at least that of the step after it.
  [[nodiscard]] const Step* at(double x) const { return &steps_[step(x)]; }

 private:
  static constexpr std::uint32_t per_octave = 32, rising = 47 * per_octave, falling = 31 * per_octave;
  static constexpr std::uint32_t steps = rising + falling;
  static constexpr std::uint32_t half = 126 << 5;  // Exponent and upper bits of 1/2.

  static double number(std::uint32_t bits) { return std::bit_cast<float>(bits << 18); }
  static std::uint32_t bits(double x) { return std::bit_cast<std::uint32_t>(static_cast<float>(x)) >> 18; }
  // Where step k begins: the first at 0, the next at 2^-48.
  static double edge(std::uint32_t k) {
    if (k == 0) return 0;
    return k <= rising ? number(half - rising + k) : 1 - number(half - (k - rising));
  }
  static std::size_t step(double x) {
    if (x < 0.5) return std::max(bits(x), half - rising) - (half - rising);
    if (x >= 1) return steps;
    // 1 - x lies between the number of its bits and the next: the step began at the larger one.
    const std::uint32_t down = half - std::min(half, bits(1 - x) + 1);
    return rising + std::min(down, falling - 1);
  }
  std::vector<Step> steps_;
};

}  // namespace envmap

/// @file
/// Curves that are one power.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <span>

#include "envmap/base/parallel.h"
#include "envmap/maths/portable.h"
#include "envmap/maths/vector.h"

namespace envmap {

/// Raises red, green and blue to their powers, in place.
inline std::function<void(std::span<Colour>)> power_curve(const std::array<double, 3>& powers) {
  if (powers == std::array<double, 3>{1, 1, 1}) return {};
  return [powers](std::span<Colour> colours) {
    parallel_ranges(int(colours.size()), 1 << 12, [&](int begin, int end) {
      for (Colour& c : colours.subspan(std::size_t(begin), std::size_t(end - begin)))
        for (int k = 0; k < 3; ++k) c[k] = float(portable::pow(std::max(c[k], 0.0F), powers[std::size_t(k)]));
    });
  };
}

}  // namespace envmap

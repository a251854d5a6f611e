/// @file
/// What cores of lobes are sums over: rows of texels of a source, by rules of Gauss points.
#pragma once

#include <array>
#include <cmath>
#include <span>

#include "envmap/map/environment_map.h"
#include "envmap/prefilter/near_field/gauss_points.h"

namespace envmap::prefiltering {

// A rule for texels that are even enough, and the coordinates across of its points: see gauss_points-inl.h.
struct RuleAcross {
  const Rule& rule;
  double part;             // It does for this part of the unevenness that four points of a panel do for.
  float* x = nullptr;      // The first point of each texel.
  std::size_t stride = 0;  // The coordinates of the next points follow so far behind.

  // One point about in the middle of each texel, from texel k on.
  [[nodiscard]] const float* middle_of(std::size_t k) const { return x + rule.count / 2 * stride + k; }
};

// From the sparsest on.
struct Rules {
  std::array<RuleAcross, 3> all;
  int low = 0;  // Column of the first coordinates.
};

// Texels of one row of the source, as an output sees them.
struct RowOfTexels {
  std::span<const Colour> row;
  int first, count;  // Column of the first, which may lie beyond the row: rows of latlong maps wrap.
  Piece texel;       // The first.
};

// The light of a source is counted from the darkest, in a unit that keeps its sums within floats.
struct Light {
  const Level& source;
  const Colour& darkest;
  float scale, scale_again;  // Their product is 1 / unit, which may be beyond floats.
  Light(const Level& of, const Colour& least, double unit)
      : source(of), darkest(least), scale(float(1 / std::sqrt(unit))), scale_again(scale) {}
};

}  // namespace envmap::prefiltering

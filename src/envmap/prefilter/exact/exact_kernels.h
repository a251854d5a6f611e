/// @file
/// The inner loop of the exact method, by SIMD in float64: the same bits on every CPU.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "envmap/maths/vector.h"
#include "envmap/prefilter/lobe.h"

namespace envmap::prefiltering {

/// Directions side by side, padded to whole vectors, and what each has got so far.
struct ExactSums {
  static constexpr std::size_t lanes = 8;
  std::size_t count = 0;
  std::array<std::vector<double>, 3> direction, flux;

  explicit ExactSums(std::span<const Direction> directions);
};

/// A texel as Gauss points with their solid angles: four for a lobe that hardly changes over it,
/// sixteen for one that does.
struct ExactTexel {
  Direction centre;
  double reach;
  std::array<double, 3> radiance;
  bool simple;  ///< Four may be enough.
  std::array<Direction, 4> few;
  std::array<double, 4> few_weights;
  std::array<Direction, 16> many;
  std::array<double, 16> many_weights;
};

/// How closely a lobe has to be looked at.
struct Closeness {
  double start;        ///< x up to which it is next to nothing: 0 but for sheen.
  double faint;        ///< x beyond which four points always do: so little is left of the lobe.
  double end;          ///< x beyond which it is nothing.
  double most_uneven;  ///< How much of its value it may lose over a texel of sixteen points.
};

/// Adds a texel to the sums of all directions for which points are good enough. @param left set to the indices of the
/// directions for which they are not.
void add_texel(const Lobe& lobe, const Closeness& close, const ExactTexel& texel, ExactSums& sums,
               std::vector<std::uint32_t>& left);

}  // namespace envmap::prefiltering

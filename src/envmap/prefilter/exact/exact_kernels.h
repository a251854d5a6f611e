/// @file
/// The inner loop of the exact method, by SIMD in float64: the same bits on every CPU.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "envmap/maths/vector.h"
#include "envmap/prefilter/lobe_formulas.h"

namespace envmap::prefiltering {

/// Directions side by side, padded to whole vectors, and the sum of each so far.
struct ExactSums {
  static constexpr std::size_t lanes = 8;
  std::size_t count = 0;
  std::array<std::vector<double>, 3> direction, flux;

  explicit ExactSums(std::span<const Direction> directions);
};

/// A texel as Gauss points with their solid angles: four for a lobe that hardly changes over it, sixteen for one that
/// does.
struct ExactTexel {
  Direction centre;
  double bounding_radius;
  std::array<double, 3> radiance;
  bool simple;  ///< Four points may be accurate.
  std::array<Direction, 4> few;
  std::array<double, 4> few_weights;
  std::array<Direction, 16> many;
  std::array<double, 16> many_weights;
};

/// Thresholds of x that decide how many points a texel needs.
struct SampleThresholds {
  double start;          ///< The lobe is negligible below this x: 0 but for sheen.
  double faint;          ///< So little is left of the lobe beyond this x that four points suffice.
  double end;            ///< The lobe is 0 or negligible beyond this x.
  double max_variation;  ///< The part of its value that the lobe may lose over a texel of sixteen points.
};

/// Adds a texel to the sums of all directions for which its points are accurate. @param left set to the indices of the
/// other directions.
void add_texel(const LobeFormula& lobe, const SampleThresholds& thresholds, const ExactTexel& texel, ExactSums& sums,
               std::vector<std::uint32_t>& left);

}  // namespace envmap::prefiltering

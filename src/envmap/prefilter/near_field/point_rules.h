/// @file
/// Which Gauss rules serve the texels of a source: few points where the lobe is flat over a texel, more where it is
/// steep.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "envmap/prefilter/multilevel/multilevel_kernels.h"
#include "envmap/prefilter/near_field/gauss_points.h"

namespace envmap::prefiltering {

/// A rule for the texels of a row, with the coordinates of its points across (gauss_points-inl.h).
struct RuleAcross {
  const SideRule* rule;
  double part;             ///< The variation over a texel that it serves, over LevelKernel::max_variation.
  float* x = nullptr;      ///< The first point of each texel.
  std::size_t stride = 0;  ///< The coordinates of the next points follow so far behind.

  /// One point about in the middle of each texel, from texel k on.
  [[nodiscard]] const float* middle_of(std::size_t k) const { return x + rule->count / 2 * stride + k; }
};

/// Rules from the sparsest on.
struct Rules {
  static constexpr std::size_t most = 6;
  std::array<RuleAcross, most> all;
  std::size_t count = 0;
  int low = 0;  ///< Column of the first coordinates.

  void add(const SideRule& rule, double part) { all[count++] = {&rule, part}; }
  [[nodiscard]] std::span<RuleAcross> used() { return std::span(all).first(count); }
  [[nodiscard]] std::span<const RuleAcross> used() const { return std::span(all).first(count); }
};

/// Panels of a texel's width at which a power is interpolated (narrow_power-inl.h): over each it falls by at most
/// LevelKernel::max_variation.
inline constexpr int most_panels = 8;

/// The power of e by which a power falls over a side, where it is steepest, over LevelKernel::max_variation.
double variation_over(const LevelKernel& k, double side);

/// Values of the power that give the polynomial of a window of a face (power_on_face-inl.h): 16 at each of 8 x 8 nodes.
inline constexpr std::size_t panel_values = 1024;

/// Panels of a side of a cube's texel (power_on_face-inl.h). None where a lobe is too wide or falls too far.
std::optional<int> panels_on_face(const LevelKernel& k, double side);
/// The angle from the middle of a lobe up to which so many panels serve.
double reach_of_panels(const LevelKernel& k, double side, int panels);

/// The sparsest rule that serves a power over a side, or the densest that there is.
const SideRule& steepest_rule(const LevelKernel& k, double side);

/// The rules for texels of a side.
Rules rules_of(const LevelKernel& k, double side);

/// The mean number of points that a power takes in a texel.
double points_in_texel(const LevelKernel& k, double side);

}  // namespace envmap::prefiltering

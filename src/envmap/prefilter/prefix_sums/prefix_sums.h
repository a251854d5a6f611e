/// @file
/// Prefix sums of light: integrals over the half sphere that a direction n sees, weighted by a polynomial in the
/// clamped cosine t+ = max(0, n.d), with a proved bound.
///
/// Powers of t are polynomials in d, so cells wholly above the horizon are summed without error: in each row of cells
/// their moments are a difference of two prefix sums (Crow 1984, "Summed-area tables for texture mapping"). The sum
/// over a cell that the horizon cuts lies between two limits, as the weight is convex and radiance is not negative:
/// Jensen's inequality below, the chord above. The result takes the middle, and half of the gap is the bound. Where the
/// sum of the bounds is too large, the cells of the largest ones are divided, down to parts of a texel. More:
/// docs/explanation/prefilter-horizon.md.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"
#include "envmap/prefilter/lobe_formulas.h"
#include "envmap/prefilter/target_texels.h"

namespace envmap::prefiltering {

/// A weight of light: the factors of t+, t+^2 and t+^3, none negative.
struct ClampedCosinePolynomial {
  std::array<double, 3> factors{};

  [[nodiscard]] int order() const { return factors[2] > 0 ? 3 : factors[1] > 0 ? 2 : 1; }
  /// The weight over t.
  [[nodiscard]] double slope(double t) const { return factors[0] + t * (factors[1] + t * factors[2]); }
  /// The integral over the half sphere.
  [[nodiscard]] double integral() const { return pi * (factors[0] + 2 * factors[1] / 3 + factors[2] / 2); }
};

/// The integral over the sphere of radiance x weight, and the bound of its error.
struct PrefixSum {
  Flux value{0}, bound{0};
};

/// A source prepared for any number of directions, on any number of threads.
class PrefixSums {
 public:
  /// @param source a cube or latlong map, which must outlive this. @param mean of its radiance, above 0.
  /// @param min_radiance of each channel, or less. @param order of polynomials, at most.
  /// @param error of the sums, about.
  PrefixSums(const Level& source, double mean, const Colour& min_radiance, int order, double error);
  ~PrefixSums();

  /// Whether it was made for an order and an error.
  [[nodiscard]] bool fits(int order, double error) const;

  /// Computes sums one after another. A bound exceeds the error only where parts of texels would have to be divided
  /// further.
  /// @param error of each sum, relative to the sum plus `beside`, or to the floor (error_floor.h).
  /// @param beside flux that the caller adds to each sum; empty: none.
  void sums(const ClampedCosinePolynomial& weight, std::span<const Direction> directions, double error,
            std::span<const Flux> beside, std::span<PrefixSum> out) const;

 private:
  struct Prepared;
  std::unique_ptr<Prepared> prepared_;
};

/// The polynomial that a lobe is: diffuse, Phong of exponent 1, 2 and 3, GGX of roughness 1. Nothing for other lobes.
std::optional<ClampedCosinePolynomial> clamped_cosine_polynomial(const LobeFormula& lobe);

/// The first terms of the series of Blinn's lobe at the horizon, k t ((1 + t) / 2)^p, by the binomial theorem. For
/// powers p below 1 the third term is negative, and left out.
ClampedCosinePolynomial blinn_horizon_terms(const BlinnPhong& lobe);

/// Sets the texels of a map and their bounds.
/// @param weight see clamped_cosine_polynomial(). @param max_error of each texel, relative like the bounds.
/// @param mean of the source's radiance.
void prefix_sums_map(const PrefixSums& prefix_sums, const ClampedCosinePolynomial& weight, double max_error,
                     double mean, const TargetTexels& map);

}  // namespace envmap::prefiltering

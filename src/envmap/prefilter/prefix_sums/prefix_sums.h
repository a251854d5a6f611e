/// @file
/// Sums of light over the half sphere that a direction sees, weighted by a polynomial in t+ (t = n.d, t+ = max(0, t)),
/// with a bound.
///
/// Cells wholly above the horizon count exactly: their moments are differences of prefix sums (Crow 1984, "Summed-area
/// tables for texture mapping", along rows). What a cut cell adds lies between Jensen's inequality and the chord of the
/// convex polynomial. Where the sum of half those gaps is too large, the cells with the widest are divided,
/// down to parts of a texel.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"
#include "envmap/prefilter/lobe.h"
#include "envmap/prefilter/target_texels.h"

namespace envmap::prefiltering {

/// Weight of light: the factors of t+, t+^2 and t+^3, none below 0.
struct HingePolynomial {
  std::array<double, 3> factors{};

  [[nodiscard]] int order() const { return factors[2] > 0 ? 3 : factors[1] > 0 ? 2 : 1; }
  /// Over t, so that its product with t is the weight.
  [[nodiscard]] double slope(double t) const { return factors[0] + t * (factors[1] + t * factors[2]); }
  /// Over the half sphere.
  [[nodiscard]] double integral() const { return pi * (factors[0] + 2 * factors[1] / 3 + factors[2] / 2); }
};

/// The integral over the sphere of radiance x weight, and how far it may be off at most.
struct HingeSum {
  Flux value{0}, bound{0};
};

/// A source prepared for any number of directions, on any number of threads.
class Hinges {
 public:
  /// @param source a cube or latlong map, which must outlive this. @param mean of its radiance, above 0.
  /// @param darkest its least radiance of each channel, or less. @param order of polynomials, at most.
  /// @param error the sums asked for have, about.
  Hinges(const Level& source, double mean, const Colour& darkest, int order, double error);
  ~Hinges();

  /// Whether it was made for these.
  [[nodiscard]] bool fits(int order, double error) const;

  /// One after another. A bound may be larger in the end where parts of texels would have to be cut further.
  /// @param error each sum may be off by, relative to itself and what is `beside` it, or to 0.001 x the mean.
  /// @param beside what the caller adds to each sum; empty: nothing.
  void sums(const HingePolynomial& weight, std::span<const Direction> directions, double error,
            std::span<const Flux> beside, std::span<HingeSum> out) const;

 private:
  struct Prepared;
  std::unique_ptr<Prepared> prepared_;
};

/// Of a lobe that is a power of t+: diffuse, Phong of exponent 1, 2 and 3, GGX of roughness 1.
std::optional<HingePolynomial> hinge_polynomial(const Lobe& lobe);

/// Sets the texels of a map, each with the bound of its error.
/// @param weight see hinge_polynomial(). @param max_error wanted, relative like the bounds of the map.
/// @param mean of the source's radiance.
void hinge_map(const Hinges& hinges, const HingePolynomial& weight, double max_error, double mean, const Making& map);

}  // namespace envmap::prefiltering

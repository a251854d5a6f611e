/// @file
/// Sums of light over the half sphere that a direction sees, weighted by t+ and t+^2 (t = n.d, t+ = max(0, t)),
/// each with a bound.
///
/// Cells wholly above the horizon count exactly: their moments are differences of prefix sums (Crow 1984, "Summed-area
/// tables for texture mapping", along rows). What a cut cell adds lies between Jensen's inequality and the chord of the
/// convex function t+. Where the sum of half those gaps is too large, the cells with the widest are divided,
/// down to parts of a texel.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "envmap/base/progress.h"
#include "envmap/map/environment_map.h"
#include "envmap/prefilter/lobe.h"

namespace envmap::prefiltering {

/// Integrals over the sphere of radiance x t+ and radiance x t+^2, and how far each may be off at most.
struct HingeSums {
  std::array<Flux, 2> sum{Flux(0), Flux(0)}, bound{Flux(0), Flux(0)};
};

/// A source prepared for any number of directions, on any number of threads.
class Hinges {
 public:
  /// @param source a cube or latlong map, which must outlive this. @param mean of its radiance, above 0.
  /// @param order 1: sums of t+ alone, 2: of t+^2, too. @param error the sums asked for have, about.
  Hinges(const Level& source, double mean, int order, double error);
  ~Hinges();
  Hinges(Hinges&&) noexcept;

  /// Whether it was made for these.
  [[nodiscard]] bool fits(int order, double error) const;

  /// One after another. @param error each sum may be off by, relative to itself or to what 0.001 x the mean everywhere
  /// comes to.
  /// @param least sums over the mean that smaller ones are held to, too.
  /// A bound may be larger in the end where parts of texels would have to be cut further.
  void sums(std::span<const Direction> directions, double error, std::span<HingeSums> out,
            const std::array<double, 2>& least = {}) const;

 private:
  struct Prepared;
  std::unique_ptr<Prepared> prepared_;
};

/// The factors of t+ and t+^2 where a lobe is a sum of these.
std::optional<std::array<double, 2>> hinge_factors(const Lobe& lobe);

}  // namespace envmap::prefiltering

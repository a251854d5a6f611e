/// @file
/// Real spherical harmonics of a map.
///
/// Basis: Y_l^m real and orthonormal, polar axis +Y, longitude from +Z to +X, m > 0 cosines, m < 0 sines, no
/// Condon-Shortley phase. The first nine, in the order l (l + 1) + m in which coefficients stand,
/// of a unit vector (x, y, z):
///   0.282095   0.488603 x   0.488603 y   0.488603 z
///   1.092548 x z   1.092548 x y   0.315392 (3 y^2 - 1)   1.092548 y z   0.546274 (z^2 - x^2)
#pragma once

#include <span>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"
#include "envmap/prefilter/lobe.h"

namespace ENVMAP_EXPORT envmap {

struct Harmonics {
  int order = 0;                   ///< The largest degree l.
  std::vector<Flux> coefficients;  ///< (order + 1)^2, at l (l + 1) + m.
};

/// Functions throw UsageError where an order is out of its range (bounds.h) or an array has the wrong length.

/// Values of all harmonics up to an order in one direction, of any length. @param out (order + 1)^2 values.
/// @throws UsageError where the direction is 0, NaN or infinite, here and below.
void harmonics_at(int order, const Direction& d, std::span<double> out);

/// Coefficients of the radiance of a map, world frame: the integral of L Y over the sphere, L constant over each texel.
/// @throws InputError where a texel is NaN or infinite.
Harmonics project(const EnvironmentMap& map, int order, const Run& run = {});

/// Value of the series in a direction, of any length.
Flux evaluate(const Harmonics& h, const Direction& d);

/// The series as a map; what is below 0 in it, between the rings of bright lights, is cut to 0. @return the map.
EnvironmentMap evaluate(const Harmonics& h, Projection to, int size, Forward forward, const Run& run = {});

/// What convolution with a lobe multiplies degree l with: the integral of lobe x P_l over the sphere; 1 for l = 0
/// (Funk and Hecke's theorem).
std::vector<double> zonal(const Lobe& lobe, int order);

/// The same for the irradiance E = integral of L max(0, cos): pi, 2 pi / 3, pi / 4, 0, -pi / 24, 0, pi / 64, ...
/// (Ramamoorthi and Hanrahan 2001, "An efficient representation for irradiance environment maps", equation 8).
std::vector<double> irradiance_factors(int order);

/// Multiplies every degree by its factor.
void scale_degrees(Harmonics& h, std::span<const double> factors);

}  // namespace envmap

/// @file
/// Prefiltering by a spherical transform: a lobe multiplies every degree of the source by one number (Funk and Hecke's
/// theorem), so that a narrow lobe, which sees many texels from many directions, costs no more than its band limit asks for.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "envmap/map/environment_map.h"
#include "envmap/base/progress.h"
#include "envmap/prefilter/lobe.h"
#include "envmap/prefilter/spectral_kernels.h"
#include "envmap/sample/target.h"

namespace envmap {

inline constexpr int most_spectral_order = 340;

/// What a lobe makes of each degree, as far as they count: the light of one steradian and radiance 1, spread by the lobe and
/// cut at that degree, is nowhere off by more than `tail`. Empty where that takes more degrees than are given.
/// @param factors zonal() of the lobe, of ten degrees or more.
std::vector<double> spectral_factors(std::vector<double> factors, double tail);

/// Complex coefficients of a map's radiance about the image's own pole, to some degree.
///
/// Texels are taken as Gauss points, and those go to a grid of rings by the transpose of 8 x 8-point Lagrange interpolation,
/// on a grid as dense as the lobe needs; from there by fast Fourier transforms
/// along the rings and sums over Legendre functions (Driscoll and Healy 1994, "Computing Fourier transforms and convolutions
/// on the 2-sphere", without its fast Legendre transform). The way back is the same transposed.
class Spectrum {
 public:
  /// @param factors of the narrowest lobe. @param error of the results that are made of it, which says how dense the grid is
  /// and how many points a texel takes.
  Spectrum(const Level& source, std::span<const double> factors, double error, const Progress& progress = {});

  [[nodiscard]] int order() const { return order_; }
  [[nodiscard]] double error() const { return error_; }

  /// Fills a map with the convolution. @param factors of degrees 0, 1, ... up to the order at most.
  void convolve(std::span<const double> factors, const Target& target, Level& out, const Progress& progress = {}) const;

 private:
  int order_;
  double error_;
  std::vector<Parts> coefficients_;  ///< By m, then l.
};

}  // namespace envmap

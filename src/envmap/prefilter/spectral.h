/// @file
/// Prefiltering by a spherical transform: a lobe multiplies every degree of the source by one number (Funk and Hecke's
/// theorem), so that a narrow lobe, which sees many texels from many directions,
/// costs no more than its band limit asks for.
#pragma once

#include <complex>
#include <memory>
#include <span>
#include <vector>

#include "envmap/map/environment_map.h"
#include "envmap/base/progress.h"
#include "envmap/operate/measure.h"
#include "envmap/prefilter/lobe.h"
#include "envmap/prefilter/spectral_kernels.h"
#include "envmap/sample/target.h"

namespace envmap::prefiltering {

inline constexpr int most_spectral_order = 340;

/// What a lobe makes of each degree, as far as they count. All that is left out makes the light of one steradian and
/// radiance 1, spread by the lobe, nowhere off by more than `tail`.
struct Cut {
  std::vector<double> factors;
  double tail;
};
/// @param factors zonal() of the lobe, of ten degrees or more. @param tail as much as may be left out; that of the
/// result is larger where it takes more degrees than are given.
Cut spectral_cut(std::vector<double> factors, double tail);

/// Complex coefficients of a map's radiance about the image's own pole, to some degree.
///
/// Texels are taken as Gauss points, and those go to a grid of rings by the transpose of 8 x 8-point Lagrange
/// interpolation, on a grid as dense as the lobe needs; from there by fast Fourier transforms
/// along the rings and sums over Legendre functions (Driscoll and Healy 1994, "Computing Fourier transforms and
/// convolutions on the 2-sphere", without its fast Legendre transform). The way back is the same transposed.
class Spectrum {
 public:
  /// @param factors of the narrowest lobe. @param error of the results that are made of it, which says how dense the
  /// grid is and how many points a texel takes.
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

/// Sets all texels of a map, each with its figure, or none where the transform is not worth its time.
///
/// A texel's figure is what it may be off, over the texel or 0.001 x the mean. The degrees left out add at most their
/// sum of (2 l + 1) / (4 pi) |factor| times the flux of the source or, where that is much because the lobe has a kink
/// at its horizon, the most that the lobe less the degrees kept comes to at any angle. What gridding does to light at
/// an angle is, by differences of the lobe there, below `envelope` x a wider lobe, so that what it does to a texel is
/// below that part of the map of the
/// wider lobe: little where light is even, too much in dark texels beside bright ones, which are refused. That is
/// derived for great circles and measured, in every texel, by tests/bench/hostile.cpp. @param light of the source.
/// @param grid_error what the grid and the points are made for: the less, the darker may texels be. @param kept of the
/// source; made anew where it does not do.
/// @return texels that are off by more than max_error, but would not be on a finer grid.
std::size_t spectral_prefilter(const Level& source, const Totals& light, const Lobe& lobe, const Target& target,
                               double max_error, double grid_error, std::unique_ptr<Spectrum>& kept, Level& out,
                               std::span<float> figures, const Progress& progress = {});

}  // namespace envmap::prefiltering

/// @file
/// Windows of spherical harmonics: less ringing round bright lights for less detail.
#pragma once

#include <span>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/prefilter/harmonics.h"

namespace ENVMAP_EXPORT envmap {

/// Hann's window, (1 + cos(pi l / (order + 1))) / 2.
std::vector<double> hann_window(int order);

/// 1 / (1 + lambda l^2 (l + 1)^2): what comes nearest to a series while lambda x its squared Laplacian is kept small
/// (Sloan 2008, "Stupid spherical harmonics (SH) tricks", "Windowing").
std::vector<double> laplacian_window(int order, double lambda);

/// A Laplacian window, and what it does to an irradiance.
struct Deringing {
  double lambda = 0;   ///< 0: no window is needed.
  double rms = 0;      ///< Of the change, relative to the rms of the irradiance; the channel where it is largest.
  double maximum = 0;  ///< The largest change, relative to the mean irradiance of its channel; on a grid.
};

/// The largest order that weakest_window() takes.
inline constexpr int max_deringed_order = 20;

/// The least lambda, to 1e-6 of it, of which no channel's irradiance is below 0 anywhere. Its lowest value is looked
/// for on a grid of sixteen points a period of the highest degree and, from those that may be near it, by descent.
/// @param radiance coefficients, not multiplied by irradiance_factors() yet.
Deringing weakest_window(const Harmonics& radiance, const Run& run = {});

}  // namespace envmap

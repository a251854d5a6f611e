/// @file
/// The light that an environment sends to a viewer by a surface's lobes, as integrals over all of the environment. A
/// reference: prefiltered maps stand for these integrals and assume that normal, view and mirrored direction are one.
#pragma once

#include <utility>

#include "envmap/operate/lookup.h"
#include "envmap/scenes/render/rays/environment_sampler.h"

namespace envmap {

/// Estimates by multiple importance sampling: half of the samples follow the lobe, half the environment (Veach 1997,
/// the balance heuristic). The same arguments give the same estimate. With n samples in all the error falls about as 1
/// / sqrt(n); in tests/render/lobe_integral_test.cpp it is below 1% with 4,096.
class LobeIntegral {
 public:
  /// @param lookup of the map. @param samples of each integral, even and above 0.
  LobeIntegral(const EnvironmentMap& map, EnvironmentLookup lookup, int samples)
      : lookup_(std::move(lookup)), sampler_(map), half_(samples / 2) {}

  /// Irradiance over pi.
  [[nodiscard]] Flux diffuse(const Direction& normal) const;
  /// Trowbridge and Reitz (GGX) with Smith's height-correlated masking and Schlick's Fresnel term. @param view unit,
  /// towards the viewer. @param alpha above 0. @param f0 straight on. @param f90 at grazing angles.
  [[nodiscard]] Flux ggx(const Direction& normal, const Direction& view, double alpha, const Flux& f0,
                         double f90) const;
  /// Charlie, the sheen of cloth, of colour 1. @param roughness perceptual.
  [[nodiscard]] Flux charlie(const Direction& normal, const Direction& view, double roughness) const;

 private:
  template <class Lobe>
  [[nodiscard]] Flux integrate(const Lobe& lobe) const;

  EnvironmentLookup lookup_;
  EnvironmentSampler sampler_;
  int half_;
};

}  // namespace envmap

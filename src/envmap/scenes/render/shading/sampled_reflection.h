/// @file
/// What rough surfaces reflect of an environment by filtered importance sampling: a few directions of the lobe, each
/// looked up where a texel is as large as the part of the sphere that the direction stands for. Unlike one prefiltered
/// level, they follow the lobe as it bends at grazing angles. shaders/sampled.glsl is the same for the graphics card.
///
/// Sources: Krivanek and Colbert 2008, "Real-time shading with filtered importance sampling"; Colbert and Krivanek
/// 2007, "GPU-based importance sampling", GPU Gems 3, chapter 20; Heitz 2018, "Sampling the GGX Distribution of Visible
/// Normals".
#pragma once

#include <vector>

#include "envmap/map/environment_map.h"
#include "envmap/sample/padded_level.h"

namespace envmap {

/// Directions of a lobe, and the area of a texel in parts of that of a direction: chosen by the errors under suns
/// (docs/explanation/rough-reflections.md), and since less of either shows spots round bright suns.
inline constexpr int reflection_samples = 128;
inline constexpr double reflection_texel = 0.7;
/// Below it a surface is a mirror, and has no lobe to sample or to integrate.
inline constexpr float least_lobe_roughness = 0.03F;

/// Cubes of an environment in the world's frame, each half as high as the one before, down to one texel a face; the
/// first has the density of the map, and 512 texels at most. All but the first are smoothed by the binomials 1 2 1:
/// plain means show their squares where they are interpolated.
std::vector<PaddedLevel> sampled_levels(const EnvironmentMap& map);

/// Returns the mean of radiance over directions, which count by the BRDF times their cosine: Trowbridge and Reitz (GGX)
/// with Smith's height-correlated masking and Schlick's Fresnel term. @param levels of sampled_levels(). @param view
/// unit, towards the viewer. @param alpha above 0. @param f0 straight on. @param f90 at grazing angles.
Flux sampled_mean(const std::vector<PaddedLevel>& levels, const Direction& normal, const Direction& view, double alpha,
                  const Flux& f0, double f90);

}  // namespace envmap

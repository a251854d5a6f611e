/// @file
/// Nine colours of spherical harmonics, as shaders take them for diffuse light.
#pragma once

#include <array>
#include <iterator>
#include <string_view>

#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"
#include "envmap/prefilter/harmonics.h"

namespace ENVMAP_EXPORT envmap {

/// What the nine colours are, for degrees 0 to 2 in the order 1; y, z, x; xy, yz, 3z^2 - 1, zx, x^2 - y^2.
/// three, ramamoorthi: coefficients of the radiance, which the shader multiplies by the factors of the cosine
///   (LightProbe of three.js; L00, L1-1, L10 ... of Ramamoorthi and Hanrahan 2001). Both are the same.
/// filament: the factors before those functions of irradiance / pi (IndirectLight::Builder::irradiance(3, sh);
///   computeIrradianceSH3Bands in libs/ibl/src/CubemapSH.cpp).
/// godot: coefficients of the radiance / pi (light probes of LightmapGI: lm_compute.glsl,
///   scene_forward_clustered.glsl).
enum class ShBasis { three, ramamoorthi, filament, godot };
inline constexpr std::string_view sh_basis_names[] = {"three", "ramamoorthi", "filament", "godot"};
template <>
inline constexpr std::size_t enumerators<ShBasis> = std::size(sh_basis_names);

/// What is left of each degree, so that bright lights ring less. automatic: the weakest Laplacian window that keeps the
/// irradiance above 0 (weakest_window()).
enum class ShWindow { none, hann, automatic };
inline constexpr std::string_view sh_window_names[] = {"none", "hann", "auto"};
template <>
inline constexpr std::size_t enumerators<ShWindow> = std::size(sh_window_names);

using ShaderSh = std::array<Flux, 9>;

/// Of a map, in the axes of the world. Level 0 is used. @throws InputError where a texel is NaN or infinite.
ShaderSh shader_sh(const EnvironmentMap& map, ShBasis basis = ShBasis::three, ShWindow window = ShWindow::automatic,
                   const Run& run = {});

/// Of coefficients of the radiance; degrees above 2 are not looked at. @throws UsageError where there are fewer.
ShaderSh shader_sh(const Harmonics& radiance, ShBasis basis = ShBasis::three);

/// Multiplies each degree by its part of the window. @param radiance coefficients of the radiance.
void apply_window(Harmonics& radiance, ShWindow window, const Run& run = {});

}  // namespace envmap

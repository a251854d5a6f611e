/// @file
/// What surfaces reflect of white light: GGX for any reflectance at normal incidence (the second half of the split
/// sum), and the sheen of cloth.
#pragma once

#include <span>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/maths/vector.h"

namespace ENVMAP_EXPORT envmap {

/// Scale and bias: the part reflected is scale x F0 + bias, with Schlick's Fresnel term (1994).
struct ScaleBias {
  double scale, bias;
};

/// Integral of D G F / (4 cos(n,v)) over the hemisphere (Karis 2013, "Real shading in Unreal Engine 4"), with Smith's
/// height-correlated masking and shadowing G (Heitz 2014, "Understanding the masking-shadowing function", equation 99),
/// alpha = roughness^2, no less than 1e-6. By Gauss's rules in variables that follow the peak: right to 1e-5.
/// @throws UsageError where a value is out of its range, here and below.
/// @param cosines of the angles between normal and view, 1/2048 to 1. @param roughness perceptual, 0 to 1.
std::vector<ScaleBias> brdf(std::span<const double> cosines, double roughness);

/// size x size texels, columns cosine (i + 0.5) / size, rows roughness (j + 0.5) / size: red scale, green bias, blue 0.
std::vector<Colour> brdf_table(int size, const Run& run = {});

/// Directional albedo of white sheen: integral of D(h) V(l,v) cos(n,l) over the hemisphere. D is Estevez and Kulla's
/// (2017, "Production friendly microfacet sheen BRDF"), with alpha = roughness^2, no less than 9e-4. V is Ashikhmin and
/// Premoze's (2007, "Distribution-based BRDFs"), 1 / (4 (cos(n,l) + cos(n,v) - cos(n,l) cos(n,v))), as Khronos'
/// glTF-IBL-Sampler has it. It exceeds 1 where a smooth surface is seen at a grazing angle: the model does not conserve
/// energy. Right to 1e-6 of the value.
/// @param cosine of the angle between normal and view, 1/2048 to 1. @param roughnesses perceptual, 0 to 1.
std::vector<double> sheen_albedo(double cosine, std::span<const double> roughnesses);

/// size x size texels, columns cosine (i + 0.5) / size, rows roughness (j + 0.5) / size:
/// the albedo in all three channels.
std::vector<Colour> sheen_table(int size, const Run& run = {});

}  // namespace envmap

/// @file
/// The sheen of cloth: fibres that stand off a surface. shaders/sheen.glsl is the same for the graphics card.
///
/// Sources: KHR_materials_sheen; Estevez and Kulla 2017, "Production friendly microfacet sheen BRDF". No Fresnel term,
/// as the extension allows. Of the environment sheen reflects sheen_albedo() times the irradiance along the normal: by
/// numeric integration over three probes and half a sky, roughness 0.4 to 1, that is off by 0.16 to 1.0 of the mean,
/// where a map prefiltered by Charlie's lobe and looked up in the mirrored direction is off by 0.6 to 1.4.
#pragma once

#include <vector>

namespace envmap {

/// Less roughness counts as this much: below, fibres shine by over 1 at grazing angles.
inline constexpr double least_sheen_roughness = 0.1;

/// Distribution times visibility. @param nh, nv, nl cosines of the angles between the normal and the half vector, the
/// view, the light; the last two above 0. @param roughness perceptual.
double sheen(double nh, double nv, double nl, double roughness);

/// The part of white light from all round that sheen of colour 1 sends to a view, 1 at most: out of the table.
double sheen_albedo(double nv, double roughness);

/// Of that, made once: columns cosine (i + 0.5) / n, rows roughness.
inline constexpr int sheen_table_size = 32;
const std::vector<float>& sheen_table();

}  // namespace envmap

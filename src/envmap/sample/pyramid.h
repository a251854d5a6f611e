/// @file
/// Filters that read mip levels: trilinear, and footprints put together from trilinear probes.
#pragma once

#include "envmap/sample/footprint.h"
#include "envmap/sample/multi_sample.h"
#include "envmap/sample/padded_level.h"

namespace envmap {

/// Between the two levels next to `lod` (0 is the finest), bilinear in each (Williams 1983, "Pyramidal parametrics").
void sample_trilinear(std::span<const PaddedLevel> levels, std::span<const Location<double>> at, double lod,
                      std::span<Colour> out);

/// One probe at the level where a texel is as wide as the footprint is long: never aliases, blurs what is oblique.
/// @param footprint in texels of the finest level.
Probes trilinear_plan(const Jacobian& footprint);
Probes trilinear_plan(const Target& target, const PaddedLevel& base, int face, const Point2& at);

/// The same in the nearer of the two levels, the finer one where both are as near: OpenGL's GL_LINEAR_MIPMAP_NEAREST,
/// which takes level ceil(lod + 1/2) - 1 (OpenGL 4.6, 8.14.3).
Probes nearest_level_plan(const Jacobian& footprint);
Probes nearest_level_plan(const Target& target, const PaddedLevel& base, int face, const Point2& at);

/// As many probes as tile the footprint at a level chosen by its short axis: footprint assembly (Schilling, Knittel and
/// Strasser 1996, "Texram"), with the axes that EWA takes from the Jacobian (Heckbert 1989).
Probes ewa_plan(const Jacobian& footprint);
Probes ewa_plan(const Target& target, const PaddedLevel& base, int face, const Point2& at);

}  // namespace envmap

/// @file
/// Maps of lobes that are powers of t+: diffuse, Phong of exponent 1, 2 and 3, GGX of roughness 1.
#pragma once

#include <array>
#include <span>

#include "envmap/base/progress.h"
#include "envmap/map/environment_map.h"
#include "envmap/prefilter/hinge.h"
#include "envmap/sample/target.h"

namespace envmap::prefiltering {

/// Sets the texels of a map, each with the bound of its error.
/// @param weight see hinge_polynomial(). @param max_error wanted, relative to a texel or to 0.001 x the
/// mean.
/// @param mean of the source's radiance. @param rows of the faces that are wanted, `size` for each face; empty: all.
/// @param out of the projection and size of the target. @param bounds by face, row and column, relative like max_error.
void hinge_map(const Hinges& hinges, const HingePolynomial& weight, const Target& target, double max_error, double mean,
               std::span<const char> rows, Level& out, std::span<float> bounds, const Progress& progress = {});

}  // namespace envmap::prefiltering

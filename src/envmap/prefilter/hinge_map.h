/// @file
/// Maps of lobes that are powers of t+: diffuse, Phong of exponent 1, 2 and 3, GGX of roughness 1.
#pragma once

#include <array>
#include <span>

#include "envmap/prefilter/hinge.h"
#include "envmap/prefilter/making.h"

namespace envmap::prefiltering {

/// Sets the texels of a map, each with the bound of its error.
/// @param weight see hinge_polynomial(). @param max_error wanted, relative like the bounds of the map.
/// @param mean of the source's radiance.
void hinge_map(const Hinges& hinges, const HingePolynomial& weight, double max_error, double mean, const Making& map);

}  // namespace envmap::prefiltering

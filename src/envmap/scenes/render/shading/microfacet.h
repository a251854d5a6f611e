/// @file
/// The microfacet model of metals and dielectrics.
#pragma once

#include <algorithm>
#include <cmath>

#include "envmap/maths/vector.h"

namespace envmap {

/// Distribution of Trowbridge and Reitz (GGX). 1 - cos^2 is taken from the cross product: the peak of a smooth surface
/// is lost otherwise. @param n normal. @param h half vector.
inline double ggx_distribution(double alpha, const Direction& n, const Direction& h) {
  const double a2 = alpha * alpha, nh = std::max(0.0, glm::dot(n, h));
  const Direction side = glm::cross(n, h);
  const double q = a2 * nh * nh + glm::dot(side, side);
  return a2 / (pi * q * q);
}

/// Smith's height-correlated masking over 4 cos(n,l) cos(n,v). @param nv, nl these cosines, above 0.
inline double smith_visibility(double alpha, double nv, double nl) {
  const double a2 = alpha * alpha;
  return 0.5 / (nl * std::sqrt(nv * nv * (1 - a2) + a2) + nv * std::sqrt(nl * nl * (1 - a2) + a2));
}

/// Schlick's part of the way from what is reflected straight on to what is at grazing angles (1994).
inline double schlick_weight(double cosine) { return std::pow(1 - std::clamp(cosine, 0.0, 1.0), 5); }

}  // namespace envmap

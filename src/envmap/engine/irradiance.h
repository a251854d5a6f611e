// The irradiance of a probe as engines take it beside the levels: nine colours in their own order, signs and scale.
#pragma once

#include <string>
#include <utility>

#include "envmap/engine/engines.h"
#include "envmap/prefilter/harmonics.h"
#include "envmap/prefilter/shader_sh.h"

namespace envmap {

/// Irradiance over pi of a surface that faces (x, y, z): colours before 1, y, z, x, xy, yz, 3z^2 - 1, zx and x^2 - y^2.
using IrradiancePolynomial = ShaderSh;

/// Returns the irradiance of radiance to degree 2, windowed as `envmap sh --window auto` does where it would fall below
/// 0.
IrradiancePolynomial irradiance_polynomial(Harmonics radiance);

/// What goes into WriteOptions::pairs.
std::pair<std::string, std::string> harmonics_pair(IrradianceForm kind, const IrradiancePolynomial& p);

}  // namespace envmap

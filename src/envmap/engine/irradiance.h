// The irradiance of a probe as engines take it beside the levels: nine colours in their own order, signs and scale.
#pragma once

#include <string>
#include <utility>

#include "envmap/base/run.h"
#include "envmap/engine/engines.h"
#include "envmap/map/environment_map.h"
#include "envmap/prefilter/shader_sh.h"

namespace envmap {

/// Irradiance over pi of a surface that faces (x, y, z): colours before 1, y, z, x, xy, yz, 3z^2 - 1, zx and x^2 - y^2.
using IrradiancePolynomial = ShaderSh;

/// By spherical harmonics to degree 2, windowed as `envmap sh --window auto` does where they would fall below 0.
IrradiancePolynomial irradiance_polynomial(const EnvironmentMap& source, const Progress& progress);

/// What goes into WriteOptions::pairs.
std::pair<std::string, std::string> harmonics_pair(IrradianceForm kind, const IrradiancePolynomial& p);

}  // namespace envmap

#include "envmap/engine/irradiance.h"

#include <fmt/format.h>

#include <vector>

#include "envmap/io/formats/json_array.h"
#include "envmap/prefilter/harmonic_norms.h"

namespace envmap {
namespace {

using namespace harmonic_norms;

std::string colour(const Flux& f) { return json_array({f.x, f.y, f.z}); }

// Filament: computeIrradianceSH3Bands in libs/ibl/src/CubemapSH.cpp.
std::string filament(const IrradiancePolynomial& p) {
  std::string text;
  for (const Flux& f : p) text += fmt::format("{:.9g} {:.9g} {:.9g}\n", f.x, f.y, f.z);
  return text;
}

// Babylon.js: SphericalPolynomial.FromHarmonics in packages/dev/core/src/Maths/sphericalPolynomial.ts, which multiplies
// degrees 0, 1 and 2 by 1, 2/3 and 1/4 once more, and shares the constant between xx, yy and zz. X is negated:
// its world is left-handed.
std::string babylon(const IrradiancePolynomial& p) {
  return fmt::format(R"({{"x":{},"y":{},"z":{},"xx":{},"yy":{},"zz":{},"yz":{},"zx":{},"xy":{}}})",
                     colour(-2.0 / 3 * p[3]), colour(2.0 / 3 * p[1]), colour(2.0 / 3 * p[2]),
                     colour(p[0] - 0.25 * p[6] + 0.25 * p[8]), colour(p[0] - 0.25 * p[6] - 0.25 * p[8]),
                     colour(p[0] + 0.5 * p[6]), colour(0.25 * p[5]), colour(-0.25 * p[7]), colour(-0.25 * p[4]));
}

// EXT_lights_image_based: coefficients of the irradiance itself, l00, l1-1, l10, l11, l2-2 ... l22. Their signs, of
// which the extension says nothing, as SphericalHarmonics.FromArray of Babylon.js takes them:
// those of m = -1 and 1 negated, X negated.
std::string gltf(const IrradiancePolynomial& p) {
  constexpr double scale[] = {1 / n0, -1 / n1, 1 / n1, 1 / n1, -1 / n2, -1 / n2, 1 / n20, 1 / n2, 1 / n22};
  std::string coefficients;
  for (std::size_t k = 0; k < 9; ++k) coefficients += (k == 0 ? "" : ",") + colour(pi * scale[k] * p[k]);
  return "[" + coefficients + "]";
}

}  // namespace

IrradiancePolynomial irradiance_polynomial(Harmonics radiance) {
  apply_window(radiance, ShWindow::automatic);
  return shader_sh(radiance, ShBasis::filament);
}

std::pair<std::string, std::string> harmonics_pair(IrradianceForm kind, const IrradiancePolynomial& p) {
  if (kind == IrradianceForm::filament) return {"sh", filament(p)};
  if (kind == IrradianceForm::babylon) return {"irradiance", babylon(p)};
  return {"irradianceCoefficients", gltf(p)};
}

}  // namespace envmap

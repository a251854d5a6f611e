#include "envmap/prefilter/shader_sh.h"

#include "envmap/base/part_progress.h"
#include "envmap/base/run_operation.h"
#include "envmap/prefilter/harmonic_norms.h"
#include "envmap/prefilter/harmonics_window.h"

namespace envmap {
namespace {

using namespace harmonic_norms;

// The factors before the functions of ShBasis. The polar axis of harmonics.h is Y, theirs Z: with x^2 + y^2 + z^2 = 1,
// a (3y^2 - 1) + b (z^2 - x^2) = (b - a)/2 (3z^2 - 1) - (3a + b)/2 (x^2 - y^2).
ShaderSh polynomial(const std::vector<Flux>& c) {
  const Flux a = n20 * c[6], b = n22 * c[8];
  return {n0 * c[0], n1 * c[2],     n1 * c[3], n1 * c[1],           n2 * c[5],
          n2 * c[7], 0.5 * (b - a), n2 * c[4], -0.5 * (3.0 * a + b)};
}

ShaderSh irradiance_over_pi(Harmonics h) {
  std::vector<double> factors = irradiance_factors(h.order);
  for (double& f : factors) f /= pi;
  scale_degrees(h, factors);
  return polynomial(h.coefficients);
}

// Coefficients of the radiance, times `scale`.
ShaderSh coefficients(const Harmonics& h, double scale) {
  constexpr double constants[9] = {n0, n1, n1, n1, n2, n2, n20, n2, n22};
  ShaderSh nine = polynomial(h.coefficients);
  for (std::size_t k = 0; k < 9; ++k) nine[k] *= scale / constants[k];
  return nine;
}

}  // namespace

ShaderSh shader_sh(const Harmonics& radiance, ShBasis basis) {
  check_enumerator("basis", basis);
  if (radiance.order < 2 || radiance.coefficients.size() < 9)
    throw UsageError("nine colours are of harmonics up to degree 2: project with order 2");
  if (basis == ShBasis::filament) return irradiance_over_pi(radiance);
  return coefficients(radiance, basis == ShBasis::godot ? 1 / pi : 1);
}

void apply_window(Harmonics& h, ShWindow window, const Run& run) {
  check_enumerator("window", window);
  if (window == ShWindow::hann) scale_degrees(h, hann_window(h.order));
  if (window == ShWindow::automatic) scale_degrees(h, laplacian_window(h.order, weakest_window(h, run).lambda));
}

ShaderSh shader_sh(const EnvironmentMap& map, ShBasis basis, ShWindow window, const Run& run) {
  check_enumerator("basis", basis);
  check_enumerator("window", window);
  return run_operation(run, [&](const Progress& progress) {
    Harmonics h = project(map, 2, {.progress = part_progress(progress, 0, 0.9), .stop = run.stop});
    apply_window(h, window, {.stop = run.stop});
    return shader_sh(h, basis);
  });
}

}  // namespace envmap

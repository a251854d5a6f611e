#include "envmap/sample/pyramid.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "envmap/maths/portable.h"
#include "envmap/sample/point.h"

namespace envmap {
namespace {

// A probe's own kernel is two texels wide: at a level this much finer its blur stays small beside the footprint.
// Against `area` on a sunset, rms at 2, 3, 4, 6: 17%, 5%, 4%, 4% for four-fold minification.
constexpr double finer = 4;
constexpr double max_probes = 32;  // Along a side of a texel: what is more oblique than that is read more coarsely.

}  // namespace

void sample_trilinear(std::span<const PaddedLevel> levels, std::span<const Location<double>> at, double lod,
                      std::span<Colour> out) {
  const double level = std::clamp(lod, 0.0, double(levels.size() - 1));
  const auto fine = std::size_t(level);
  const auto f = float(level - double(fine));
  sample_bilinear(levels[fine], at, out);
  if (f == 0) return;
  static thread_local std::vector<Colour> coarse;
  coarse.resize(at.size());
  sample_bilinear(levels[fine + 1], at, coarse);
  for (std::size_t k = 0; k < at.size(); ++k) out[k] = (1 - f) * out[k] + f * coarse[k];
}

Probes trilinear_plan(const Jacobian& j) { return {.lod = portable::log2(std::max(1.0, ellipse(j).major))}; }

Probes trilinear_plan(const Target& target, const PaddedLevel& base, int face, const Point2& at) {
  return trilinear_plan(jacobian(target, base.projection(), base.height(), face, at));
}

Probes nearest_level_plan(const Jacobian& j) {
  return {.lod = std::max(0.0, std::ceil(trilinear_plan(j).lod + 0.5) - 1)};
}

Probes nearest_level_plan(const Target& target, const PaddedLevel& base, int face, const Point2& at) {
  return nearest_level_plan(jacobian(target, base.projection(), base.height(), face, at));
}

Probes ewa_plan(const Target& target, const PaddedLevel& base, int face, const Point2& at) {
  return ewa_plan(jacobian(target, base.projection(), base.height(), face, at));
}

Probes ewa_plan(const Jacobian& j) {
  const double across = glm::length(j.du), down = glm::length(j.dv);
  const double texel = std::max({1.0, ellipse(j).minor / finer, across / max_probes, down / max_probes});
  const auto count = [&](double length) { return std::clamp(int(std::ceil(length / texel)), 1, int(max_probes)); };
  return {count(across), count(down), portable::log2(texel)};
}

}  // namespace envmap

#include "envmap/render/choose.h"

#include <array>

namespace envmap {
namespace {

// Milliseconds: of a texel that is found and lit, of a triangle sent to a face. See tests/bench/README.md.
struct Cost {
  double texel, triangle;
};

double texels(Projection p, int size) { return static_cast<double>(faces(p)) * aspect(p) * size * size; }

}  // namespace

double estimated_cost(DrawMethod method, Projection to, int size, std::size_t triangles) {
  const auto count = static_cast<double>(triangles);
  if (method == DrawMethod::raycast) return 60e-6 * texels(to, size) + 300e-6 * count;
  if (method == DrawMethod::resample)
    return 75e-6 * texels(Projection::cube, size) + 1.6e-3 * count + 60e-6 * texels(to, size);
  return 80e-6 * texels(to, size) + 1.2e-3 * count *
                                        (to == Projection::latlong ? 1.0
                                         : to == Projection::cube  ? 3
                                                                   : faces(to));
}

DrawMethod cheapest(Projection to, int size, std::size_t triangles) {
  DrawMethod best = DrawMethod::exact;
  for (const DrawMethod m : {DrawMethod::resample, DrawMethod::raycast})
    if (estimated_cost(m, to, size, triangles) < estimated_cost(best, to, size, triangles)) best = m;
  return best;
}

}  // namespace envmap

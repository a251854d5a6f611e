#include "envmap/render/choose.h"

#include "envmap/render/image.h"

namespace envmap {
namespace {

double texels(Projection p, int size) { return static_cast<double>(faces(p)) * aspect(p) * size * size; }

}  // namespace

double estimated_cost(DrawMethod method, Projection to, int size, std::size_t triangles) {
  const auto count = static_cast<double>(triangles);
  if (method == DrawMethod::raycast) return 3.1e-4 * texels(to, size) + 0.8e-3 * count;
  if (method == DrawMethod::resample)
    return 1e-4 * texels(Projection::cube, size) + 1e-3 * count + (to == Projection::cube ? 0 : 1e-4 * texels(to, size));
  // Of a cube's faces, about half see a given part of the scene.
  return 1.7e-4 * texels(to, size) + 1.2e-3 * count * (to == Projection::cube ? 3 : faces(to));
}

DrawMethod cheapest(Projection to, int size, std::size_t triangles) {
  DrawMethod best = DrawMethod::exact;
  for (const DrawMethod m : {DrawMethod::resample, DrawMethod::raycast})
    if (!can_draw(best, to) || estimated_cost(m, to, size, triangles) < estimated_cost(best, to, size, triangles))
      best = m;
  return best;
}

bool can_draw(DrawMethod method, Projection to) {
  const ImageShape shape = image_shape(to);
  if (method == DrawMethod::exact) return shape != ImageShape::other;
  if (method == DrawMethod::distort || method == DrawMethod::tessellate)
    return shape == ImageShape::plane || shape == ImageShape::disc;
  return true;
}

}  // namespace envmap

#include "envmap/render/choose.h"

#include "envmap/render/image.h"

namespace envmap {
double estimated_cost(DrawMethod method, Projection to, int size, std::size_t triangles, const Costs& costs) {
  const auto count = double(triangles);
  if (method == DrawMethod::raycast)
    return costs[Cost::ray_texel] * texel_count(to, size) + costs[Cost::ray_triangle] * count;
  if (method == DrawMethod::resample)
    return costs[Cost::cube_texel] * texel_count(Projection::cube, size) + costs[Cost::cube_triangle] * count +
           (to == Projection::cube ? 0 : costs[Cost::resample_texel] * texel_count(to, size));
  // Of a cube's faces, about half see a given part of the scene.
  return costs[Cost::draw_texel] * texel_count(to, size) +
         costs[Cost::draw_triangle] * count * (to == Projection::cube ? 3 : faces(to));
}

DrawMethod cheapest(Projection to, int size, std::size_t triangles, const Costs& costs, bool rays) {
  const auto cost = [&](DrawMethod m) { return estimated_cost(m, to, size, triangles, costs); };
  DrawMethod best = can_draw(DrawMethod::exact, to) ? DrawMethod::exact : DrawMethod::resample;
  for (const DrawMethod m : {DrawMethod::resample, DrawMethod::raycast})
    if ((rays || m != DrawMethod::raycast) && cost(m) < cost(best)) best = m;
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

#include "envmap/render/choose.h"

#include "envmap/render/image.h"

namespace envmap {
namespace {

// Nanoseconds of processor time, all threads, on an x86-64 server with AVX2 and OSMesa: lines through the figures of
// tests/bench/README.md.
constexpr double drawn_texel = 170, drawn_triangle = 1200;  // The triangle for each face that it is sent to.
constexpr double cube_texel = 100, cube_triangle = 1000, resampled_texel = 100;  // The triangle in all six faces.
constexpr double cast_texel = 310, cast_triangle = 800;  // A triangle in the tree that rays are cast through.

}  // namespace

double estimated_cost(DrawMethod method, Projection to, int size, std::size_t triangles) {
  const auto count = double(triangles);
  if (method == DrawMethod::raycast) return cast_texel * texel_count(to, size) + cast_triangle * count;
  if (method == DrawMethod::resample)
    return cube_texel * texel_count(Projection::cube, size) + cube_triangle * count +
           (to == Projection::cube ? 0 : resampled_texel * texel_count(to, size));
  // Of a cube's faces, about half see a given part of the scene.
  return drawn_texel * texel_count(to, size) + drawn_triangle * count * (to == Projection::cube ? 3 : faces(to));
}

DrawMethod cheapest(Projection to, int size, std::size_t triangles, bool rays) {
  const auto cost = [&](DrawMethod m) { return estimated_cost(m, to, size, triangles); };
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

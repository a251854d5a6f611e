#include "envmap/render/choose.h"

#include "envmap/render/image.h"

namespace envmap {
namespace {

// Nanoseconds a texel and a triangle, with the map read back: docs/explanation/dynamic-maps.md.
struct Lines {
  double drawn_texel, drawn_triangle;                 // The triangle for each face that it is sent to.
  double cube_texel, cube_triangle, resampled_texel;  // The triangle in all six faces.
  double cast_texel, cast_triangle;                   // A triangle in the tree that rays are cast through.
};
// Of processor time, all threads, on an x86-64 server with AVX2 and OSMesa.
constexpr Lines on_processor{160, 350, 100, 340, 100, 310, 330};
// By the clock, on an NVIDIA H100 and 16 cores of its server.
constexpr Lines on_card{20, 5, 18, 5.5, 35, 33, 47};

}  // namespace

double estimated_cost(DrawMethod method, Projection to, int size, std::size_t triangles, bool card) {
  const Lines& lines = card ? on_card : on_processor;
  const auto count = double(triangles);
  if (method == DrawMethod::raycast) return lines.cast_texel * texel_count(to, size) + lines.cast_triangle * count;
  if (method == DrawMethod::resample)
    return lines.cube_texel * texel_count(Projection::cube, size) + lines.cube_triangle * count +
           (to == Projection::cube ? 0 : lines.resampled_texel * texel_count(to, size));
  // Of a cube's faces, about half see a given part of the scene.
  return lines.drawn_texel * texel_count(to, size) +
         lines.drawn_triangle * count * (to == Projection::cube ? 3 : faces(to));
}

DrawMethod cheapest(Projection to, int size, std::size_t triangles, bool rays, bool card) {
  const auto cost = [&](DrawMethod m) { return estimated_cost(m, to, size, triangles, card); };
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

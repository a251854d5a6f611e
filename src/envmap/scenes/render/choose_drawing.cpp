#include "envmap/scenes/render/choose_drawing.h"

#include "envmap/scenes/render/face_image.h"
#include "envmap/scenes/render/shading/shading.h"
#include "envmap/scenes/render/shadow_view.h"

namespace envmap {
namespace {

// Nanoseconds a texel and a triangle, with the map read back: docs/explanation/dynamic-maps.md.
struct Lines {
  double drawn_texel, drawn_triangle;                 // The triangle for each face that it is sent to.
  double cube_texel, cube_triangle, resampled_texel;  // The triangle in all six faces.
  double cast_texel, cast_triangle;                   // A triangle in the tree that rays are cast through.
  double shadow_texel, drawn_shadow, cast_shadow;     // Of a shadow map; of a light in a texel.
};
// Of processor time, all threads, on an x86-64 server with AVX2 and OSMesa.
constexpr Lines on_processor{160, 220, 100, 340, 100, 310, 450, 65, 29, 70};
// By the clock, on an NVIDIA H100 and 16 cores of its server.
constexpr Lines on_card{20, 5, 18, 5.5, 35, 33, 47, 1, 0.07, 7};

}  // namespace

DrawLoad draw_load(const FrameState& shot) {
  DrawLoad load{.triangles = triangles(shot.scene), .lights = shot.distant.size(), .shadow_texels = 0};
  load.shadow_texels = shadow_map_texels(load.lights);
  if (!shot.shadows) return load;
  const std::size_t suns = shot.environment != nullptr ? shot.environment->light.suns.size() : 0;
  const std::vector<PlacedLight> lights = placed_lights(shot.scene, shot.pose);
  std::size_t images = 0;
  for (const PlacedLight& light : lights) images += std::size_t(shadow_view_count(light));
  images += suns * maps_per_sun;
  load.lights += lights.size() + suns * maps_per_sun;
  load.more_rays = suns * (rays_per_sun - maps_per_sun);
  load.shadow_texels += shadow_map_texels(images);
  return load;
}

double estimated_cost(DrawMethod method, Projection to, int size, const DrawLoad& load, bool card) {
  const Lines& lines = card ? on_card : on_processor;
  const double count = double(load.triangles), lights = double(load.lights), texels = texel_count(to, size);
  if (method == DrawMethod::raycast)
    return (lines.cast_texel + lines.cast_shadow * (lights + double(load.more_rays))) * texels +
           lines.cast_triangle * count;
  const double maps = lines.shadow_texel * double(load.shadow_texels), shadows = lines.drawn_shadow * lights;
  if (method == DrawMethod::resample)
    return maps + (lines.cube_texel + shadows) * texel_count(Projection::cube, size) + lines.cube_triangle * count +
           (to == Projection::cube ? 0 : lines.resampled_texel * texels);
  // Of a cube's faces, about half see a given part of the scene.
  return maps + (lines.drawn_texel + shadows) * texels +
         lines.drawn_triangle * count * (to == Projection::cube ? 3 : faces(to));
}

DrawMethod cheapest(Projection to, int size, const DrawLoad& load, bool rays, bool card) {
  const auto cost = [&](DrawMethod m) { return estimated_cost(m, to, size, load, card); };
  DrawMethod best = can_draw(DrawMethod::exact, to) ? DrawMethod::exact : DrawMethod::resample;
  for (const DrawMethod m : {DrawMethod::resample, DrawMethod::raycast})
    if ((rays || m != DrawMethod::raycast) && cost(m) < cost(best)) best = m;
  return best;
}

bool can_draw(DrawMethod method, Projection to) {
  check_enumerator("method", method);
  const ImageShape shape = image_shape(to);
  if (method == DrawMethod::exact) return shape != ImageShape::other;
  if (method == DrawMethod::distort || method == DrawMethod::tessellate)
    return shape == ImageShape::plane || shape == ImageShape::disc;
  return true;
}

}  // namespace envmap

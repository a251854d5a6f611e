// Water drawn through dynamic maps.
#pragma once

#include "basin.h"
#include "envmap/scenes/render/mirrors.h"
#include "envmap/scenes/render/shading/shading.h"

namespace water {

/// The water's map, of sky and surroundings above it and of the basin below it, stays from frame to frame and is drawn again
/// in each. Needs a current context, and goes before it.
class Painter {
 public:
  Painter(const Pool& pool, const envmap::Environment* sky)
      : pool_(pool),
        renderer_(pool.scene, sky, {pool.water_node}),
        maps_(pool.scene, {make_mirror(pool.scene, pool.water_node, envmap::Projection::paraboloid)}) {}

  /// The picture through from.lens, of the pool as it is now.
  std::vector<Colour> paint(const envmap::Viewpoint& from, envmap::FrameState shot) {
    for (const int mesh : {pool_.water, pool_.floor}) renderer_.update(pool_.scene, mesh);
    const double pixel = 2 * from.lens->tangents.y / from.size;
    maps_.update(renderer_, shot, {{.at = from.at, .pixel = pixel}}, {.bounces = 1, .all = true});
    shot.mirrors = maps_.maps();
    return draw_picture(renderer_, from, shot);
  }

 private:
  const Pool& pool_;
  envmap::Renderer renderer_;
  envmap::Mirrors maps_;
};

}  // namespace water

#include "envmap/scenes/render/shadow_view.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "envmap/projection/cube.h"

namespace envmap {
int shadow_view_count(const PlacedLight& light) {
  const bool wide = light.kind == PunctualLight::Kind::spot && light.outer < std::cos(0.25 * pi);
  return light.kind == PunctualLight::Kind::point || wide ? 6 : 1;
}

int shadow_map_size(std::size_t count) {
  constexpr std::size_t largest = 2048;
  return int(std::min(largest, std::bit_floor(std::size_t(std::sqrt(double(max_shadow_texels / count))))));
}

ShadowView parallel_image(const Direction& along, const Ball& scene) {
  const double half = scene.radius > 0 ? 1.001 * scene.radius : 1;
  return {-1, scene.centre, upright_about(along), half, true};
}

std::vector<ShadowView> shadow_views(std::span<const PlacedLight> lights, const Ball& scene) {
  std::vector<ShadowView> all;
  for (const PlacedLight& light : lights) {
    if (light.kind == PunctualLight::Kind::directional) {
      all.push_back(parallel_image(light.direction, scene));
      all.back().but = light.node;
    } else if (shadow_view_count(light) == 1) {
      const double half = std::sqrt(1 - light.outer * light.outer) / light.outer;
      all.push_back({light.node, light.position, upright_about(light.direction), std::max(half, 1e-6)});
    } else {
      for (const Cube::Axes& axes : Cube::axes)
        all.push_back({light.node, light.position, Rotation(axes.right, axes.up, axes.forward)});
    }
  }
  return all;
}

}  // namespace envmap

#include "envmap/render/light_image.h"

#include <cmath>

#include "envmap/projection/cube.h"

namespace envmap {
namespace {

// Right, up and ahead; any right will do.
Rotation looking_along(const Direction& ahead) {
  const Direction beside = std::abs(ahead.y) < 0.9 ? Direction(0, 1, 0) : Direction(1, 0, 0);
  const Direction right = glm::normalize(glm::cross(beside, ahead));
  return {right, glm::cross(ahead, right), ahead};
}

}  // namespace

int light_faces(const PlacedLight& light) {
  const bool wide = light.kind == PunctualLight::Kind::spot && light.outer < std::cos(0.25 * pi);
  return light.kind == PunctualLight::Kind::point || wide ? 6 : 1;
}

std::vector<LightFace> light_images(std::span<const PlacedLight> lights, const Ball& scene) {
  std::vector<LightFace> all;
  for (std::size_t k = 0; k < lights.size(); ++k) {
    const PlacedLight& light = lights[k];
    const auto number = static_cast<int>(k);
    if (light.kind == PunctualLight::Kind::directional) {
      const double half = scene.radius > 0 ? 1.001 * scene.radius : 1;
      all.push_back({number, scene.centre, looking_along(light.direction), half, true});
    } else if (light_faces(light) == 1) {
      const double half = std::sqrt(1 - light.outer * light.outer) / light.outer;
      all.push_back({number, light.position, looking_along(light.direction), std::max(half, 1e-6)});
    } else {
      for (const Cube::Axes& axes : Cube::axes)
        all.push_back({number, light.position, Rotation(axes.right, axes.up, axes.forward)});
    }
  }
  return all;
}

}  // namespace envmap

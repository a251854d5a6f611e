#include "envmap/scenes/scene/own_light.h"

namespace envmap {

void divide_own_light(SceneGraph& scene, double white_luminance) {
  for (PunctualLight& light : scene.lights) light.intensity = Colour(Flux(light.intensity) / white_luminance);
  for (Material& material : scene.materials) material.emissive = Colour(Flux(material.emissive) / white_luminance);
}

}  // namespace envmap

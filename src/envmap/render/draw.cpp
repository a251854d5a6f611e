#include "envmap/render/draw.h"

namespace envmap {

std::vector<Instance> instances(const Scene& scene) {
  std::vector<Instance> all;
  for (std::size_t node = 0; node < scene.nodes.size(); ++node)
    for (const int mesh : scene.nodes[node].meshes) all.push_back({static_cast<int>(node), mesh});
  return all;
}

}  // namespace envmap

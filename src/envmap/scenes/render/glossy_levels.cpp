#include "envmap/scenes/render/glossy_levels.h"

#include <algorithm>

#include "envmap/scenes/render/draw.h"

namespace envmap {
namespace {

constexpr float least_step = 0.1F;  // Of the row of steps; what is smoother is mixed with the map as it is.

// Of one material.
void add_roughnesses(const Material& m, std::vector<float>& all, bool& varies) {
  if (m.roughness > 0 && !is_smooth(m)) all.push_back(std::min(m.roughness, 1.0F));
  if (m.coat > 0 && m.coat_roughness > 0) all.push_back(std::min(m.coat_roughness, 1.0F));
  varies = varies || m.metallic_roughness_texture >= 0 || (m.coat > 0 && m.coat_roughness_texture >= 0);
}

// The roughest stays.
void leave_out_neighbours(std::vector<float>& all) {
  constexpr float apart = 1e-3F;
  std::ranges::sort(all, std::greater<>());
  const auto too_near = [](float rougher, float smoother) { return rougher - smoother < apart; };
  all.erase(std::ranges::unique(all, too_near).begin(), all.end());
  std::ranges::reverse(all);
}

// Rising.
std::vector<float> even_steps() {
  std::vector<float> steps;
  for (float r = 1; r > 0.99F * least_step; r /= 1.3F) steps.push_back(r);
  std::ranges::reverse(steps);
  return steps;
}

}  // namespace

std::vector<float> glossy_roughnesses(const SceneGraph& scene, int node) {
  std::vector<float> all;
  bool varies = false;
  for (const Instance& instance : instances(scene)) {
    const int material = scene.meshes[std::size_t(instance.mesh)].material;
    if ((node < 0 || lies_under(scene, instance.node, node)) && material >= 0)
      add_roughnesses(scene.materials[std::size_t(material)], all, varies);
  }
  leave_out_neighbours(all);
  const std::vector<float> steps = even_steps();
  if (all.size() + (varies ? steps.size() : 0) > max_glossy_levels) return steps;
  if (varies || all.empty()) {
    all.insert(all.end(), steps.begin(), steps.end());
    leave_out_neighbours(all);
  }
  return all;
}

int glossy_doublings(float roughness) {
  const float across = float(glossy_size) * roughness * roughness / 1.2F;
  return across >= 1 ? 0 : across >= 0.5F ? 1 : 2;
}

}  // namespace envmap

#include "envmap/scenes/lit_scene.h"

#include <fmt/format.h>

#include "envmap/base/error.h"
#include "envmap/scenes/read/read_scene.h"
#include "envmap/scenes/render/shading/sampled_reflection.h"
#include "envmap/scenes/scene/skin_and_morph.h"

namespace envmap {

void LitScene::light_by(EnvironmentMap map, int lights, Reflection reflection, const Progress& progress) {
  auto made = std::make_unique<Environment>(std::move(map), glossy_size, progress, glossy_roughnesses(scene));
  if (reflection == Reflection::sampled) made->light.sampled = sampled_levels(made->map);
  environment = std::move(made);
  if (lights > 0) distant = distant_lights(environment->map, lights);
}

std::vector<int> LitScene::move_to(double time) {
  const Pose then = pose(scene, time);
  if (!is_bounded(then))
    throw InputError(scene.files.empty() ? "" : scene.files.front(),
                     fmt::format("at {} s its nodes multiply to sizes beyond 1e30", time));
  return deform(scene, then, time);
}

FrameState LitScene::shot(double time, const std::optional<Colour>& ambient, bool shadows) const {
  return {.scene = scene,
          .pose = pose(scene, time),
          .environment = environment.get(),
          .ambient = ambient.value_or(Colour(0)),
          .shadows = shadows,
          .distant = distant};
}

bool LitScene::is_dark(const std::optional<Colour>& ambient) const {
  return !environment && !ambient && !has_light(scene);
}

std::vector<std::string> LitScene::remarks(const std::optional<Colour>& ambient) const {
  std::vector<std::string> all = remarks_on(scene);
  if (is_dark(ambient))
    all.push_back("no light in it and none given, so it is black: give an environment or ambient light");
  return all;
}

std::vector<std::string> remarks_on(const Scene& scene) {
  std::vector<std::string> all = scene.remarks;
  for (const std::string& what : scene.unsupported) all.push_back("not drawn: " + what);
  return all;
}

LitScene read_lit_scene(const std::string& path, const EnvironmentMap* environment, int lights, Reflection reflection,
                        double time, const Progress& progress) {
  LitScene lit{.scene = read_scene(path)};
  lit.move_to(time);
  if (environment == nullptr) return lit;
  EnvironmentMap base{.levels = {}, .forward = environment->forward};
  base.levels.push_back(environment->base().clone());
  lit.light_by(std::move(base), lights, reflection, progress);
  return lit;
}

}  // namespace envmap

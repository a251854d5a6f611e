#include "envmap/scenes/lit_scene.h"

#include <fmt/format.h>

#include "envmap/base/error.h"
#include "envmap/scenes/render/glossy_levels.h"
#include "envmap/scenes/scene/skin_and_morph.h"

namespace envmap {

void LitScene::light_by(const PreparedEnvironment& by, int lights, Reflection reflection, const Progress& progress) {
  environment = by.light(glossy_roughnesses(scene), reflection, progress);
  distant = lights > 0 ? by.distant(lights, progress) : std::vector<DistantLight>{};
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

std::vector<std::string> remarks_on(const SceneGraph& scene) {
  std::vector<std::string> all = scene.remarks;
  for (const std::string& what : scene.unsupported) all.push_back("not drawn: " + what);
  return all;
}

}  // namespace envmap

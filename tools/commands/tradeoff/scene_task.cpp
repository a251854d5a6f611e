#include "commands/tradeoff/scene_task.h"

#include <fmt/format.h>

#include "cli/console.h"
#include "envmap/base/error.h"
#include "envmap/scenes/render/choose_drawing.h"
#include "envmap/scenes/render/rays/raycast.h"

namespace tools {

using namespace envmap;

std::shared_ptr<Gl> open_gl(const LoadedScene& loaded, ContextKind kind, const std::vector<int>& mirrors,
                            const char* what) {
  try {
    return std::make_shared<Gl>(loaded, kind, mirrors);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::renderer) throw;
    warn(fmt::format("envmap tradeoff: {} are left out: {}", what, e.what()));
    return nullptr;
  }
}

bool is_of_scene(const std::string& task) {
  const std::string first = parts_of(task)[0];
  return first == "render" || first == "view";
}

Task make_scene_task(const std::string& name, const LoadedScene& loaded, const SceneOptions& options,
                     const std::string& at) {
  const std::vector<std::string> parts = parts_of(name);
  if (parts.size() != 2 && parts.size() != 3)
    throw UsageError(fmt::format("--task '{}' must be one of {}", name, task_words()));
  Viewpoint from = viewpoint_of(at, loaded.scene, options.path);
  from.to = projection_of(name, parts[1]);
  if (parts.size() == 3) from.size = size_of(name, parts[2]);
  const FrameState shot = loaded.shot(options.time, options);
  if (from.without >= 0) from.at = centre_of(loaded.scene, shot.pose, from.without);
  const auto cast = [shot, from] { return Outcome{std::move(raycast(shot, from).radiance.base())}; };
  Task task{.name = name, .reference = "--method raycast", .truth = cast};
  const std::shared_ptr<Gl> gl = open_gl(loaded, options.context, {}, "the methods of OpenGL");
  const auto drawn = [gl, shot, from](DrawMethod method) {
    Drawn map = draw(gl->renderer, from, shot, method);
    return Outcome{.level = std::move(map.radiance.base()), .missing_solid_angle = map.missing_solid_angle};
  };
  for (const DrawMethod method : {DrawMethod::distort, DrawMethod::tessellate, DrawMethod::exact, DrawMethod::resample})
    if (gl && can_draw(method, from.to))
      task.ways.push_back(
          {std::string(draw_method_names[std::size_t(method)]), "", [drawn, method] { return drawn(method); }});
  task.ways.push_back({"raycast", "", cast});
  return task;
}

}  // namespace tools

/// @file
/// What a Scene holds, and its turns.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "envmap/base/parallel.h"
#include "envmap/base/part_progress.h"
#include "envmap/base/run_operation.h"
#include "envmap/base/turn.h"
#include "envmap/scenes/lit_scene.h"
#include "envmap/scenes/render/drawing_thread.h"
#include "envmap/scenes/scene.h"

namespace envmap {

struct Scene::State {
  std::string path;  ///< For errors.
  LitScene lit;      ///< As it was drawn last.
  std::timed_mutex in_use;
  std::unique_ptr<DrawingThread> drawing = nullptr;  ///< None before OpenGL drew.
  std::set<int> moved = {};                          ///< Meshes that OpenGL has as they were.

  /// work() while no other thread draws this scene.
  template <class Work>
  auto in_turn(const Progress& progress, const Work& work) {
    const auto turn = wait_for_turn(in_use, progress);
    std::optional<decltype(work())> made;
    isolate_tasks([&] { made.emplace(work()); });
    return std::move(*made);
  }

  /// Puts the scene in its light, and where it is then. @param light may be null.
  void prepare(const Light* light, int occlusion, Reflection reflection, double time, const Progress& progress) {
    if (light == nullptr)
      lit.environment = nullptr, lit.distant.clear();
    else
      lit.light_by(*light->prepared_, occlusion, reflection, progress);
    for (const int mesh : lit.move_to(time)) moved.insert(mesh);
  }

  /// The thread that draws with such a context.
  DrawingThread& drawing_with(ContextKind kind) {
    if (!drawing || drawing->kind() != kind) {
      drawing.reset();
      drawing = std::make_unique<DrawingThread>(kind);
    }
    return *drawing;
  }

  /// The renderer of maps, of the scene as it is now. Called in the thread that draws.
  Renderer& renderer(DrawingSession& session) {
    if (!session.renderer || session.lit_by != lit.environment) {
      session.renderer.reset();
      session.renderer.emplace(lit.scene, lit.environment.get(), std::vector<int>{}, session.programs);
      session.lit_by = lit.environment;
    } else {
      for (const int mesh : moved) session.renderer->update(lit.scene, mesh);
    }
    moved.clear();
    return *session.renderer;
  }
};

/// For functions on scenes that are not members.
class SceneAccess {
 public:
  static Scene::State& state(const Scene& scene) { return *scene.state_; }
};

/// draw(light, rest) with a light of the first level of the environment, or null, and the rest of the progress.
template <class Draw>
auto lit_by(const EnvironmentMap* environment, const Run& run, const Draw& draw) {
  constexpr double lighting = 0.3;  // Its share.
  return run_operation(run, [&](const Progress& progress) {
    std::optional<Light> light;
    if (environment != nullptr) {
      EnvironmentMap base{.levels = {}, .forward = environment->forward};
      base.levels.push_back(environment->base().clone());
      light.emplace(std::move(base), Run{.progress = part_progress(progress, 0, lighting), .stop = run.stop});
    }
    return draw(light ? &*light : nullptr,
                Run{.progress = part_progress(progress, lighting, 1 - lighting), .stop = run.stop});
  });
}

}  // namespace envmap

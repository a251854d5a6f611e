// What `tradeoff` measures of scenes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "commands/tradeoff/tasks.h"
#include "envmap/scenes/render/context.h"
#include "envmap/scenes/render/renderer.h"
#include "scenes/scene_options.h"

namespace tools {

// What OpenGL draws with; made once for all ways of a task.
struct Gl {
  envmap::Context context;
  envmap::Renderer renderer;
  Gl(const LoadedScene& loaded, envmap::ContextKind kind, const std::vector<int>& mirrors)
      : context(kind), renderer(loaded.scene, loaded.environment.get(), mirrors) {}
};

// Null without a renderer, with a warning that `what` is left out. @param loaded must outlive the result.
std::shared_ptr<Gl> open_gl(const LoadedScene& loaded, envmap::ContextKind kind, const std::vector<int>& mirrors,
                            const char* what);

// Whether a task is about a scene: render:P[:N] or view[:N].
bool is_of_scene(const std::string& task);

// The methods of `envmap render`. @param at NODE, X,Y,Z or nothing: the origin. @param loaded must outlive the task.
// @throws UsageError as make_task(); without a renderer the methods of OpenGL are left out, with a warning.
Task make_scene_task(const std::string& name, const LoadedScene& loaded, const SceneOptions& options,
                     const std::string& at);

// The ways of `envmap view`, for a task view[:N]. @param camera NAME, X,Y,Z or nothing, as of `view`. @param loaded
// must outlive the task.
// @throws UsageError as make_task(), and where the scene has no mirror;
// without a renderer OpenGL's ways are left out, with a warning.
Task make_view_task(const std::string& name, const LoadedScene& loaded, const SceneOptions& options,
                    const std::string& camera);

}  // namespace tools

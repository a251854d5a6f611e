// What `tradeoff` measures of scenes.
#pragma once

#include <string>

#include "scene_options.h"
#include "tradeoff_tasks.h"

namespace tools {

// Whether a task is about a scene: render:P[:N] or view[:N].
bool is_of_scene(const std::string& task);

// The methods of `envmap render`. @param at NODE, X,Y,Z or nothing: the origin. @param loaded must outlive the task.
// @throws UsageError as make_task(); without a renderer the methods of OpenGL are left out, with a warning.
Task make_scene_task(const std::string& name, const LoadedScene& loaded, const SceneOptions& options, const std::string& at);

}  // namespace tools

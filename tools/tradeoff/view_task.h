// What `tradeoff` measures of pictures with mirrors.
#pragma once

#include <string>

#include "scenes/scene_options.h"
#include "tradeoff/tasks.h"

namespace tools {

// The ways of `envmap view`, for a task view[:N]. @param camera NAME, X,Y,Z or nothing, as of `view`. @param loaded
// must outlive the task.
// @throws UsageError as make_task(), and where the scene has no mirror;
// without a renderer OpenGL's ways are left out, with a warning.
Task make_view_task(const std::string& name, const LoadedScene& loaded, const SceneOptions& options,
                    const std::string& camera);

}  // namespace tools

// What `tradeoff` measures of folders for engines.
#pragma once

#include <string>

#include "envmap/io/read.h"
#include "tradeoff/tasks.h"

namespace tools {

// The maps of an engine in every quality and in every depth that its files hold, for a task bake:ENGINE.
// @param source must outlive the task.
// @throws UsageError where there is no such engine.
Task make_bake_task(const std::string& name, const envmap::Source& source);

}  // namespace tools

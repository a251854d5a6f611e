// What `tradeoff` measures of folders for engines.
#pragma once

#include <string>

#include "envmap/io/read.h"
#include "envmap/base/costs.h"
#include "tradeoff/tasks.h"

namespace tools {

// The maps of an engine in every quality and in every depth that its files hold, for a task bake:ENGINE.
// @param source must outlive the task. @param costs that methods are chosen by.
// @throws UsageError where there is no such engine.
Task make_bake_task(const std::string& name, const envmap::Source& source, const envmap::Costs& costs);

}  // namespace tools

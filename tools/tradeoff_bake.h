// What `tradeoff` measures of folders for engines.
#pragma once

#include <string>

#include "command.h"
#include "tradeoff_tasks.h"

namespace tools {

// The maps of an engine in every quality and in every depth that its files hold, for a task bake:ENGINE. @param source, common must
// outlive the task. @throws UsageError where there is no such engine.
// @param costs that methods are chosen by.
Task make_bake_task(const std::string& name, const envmap::Source& source, const envmap::Costs& costs, const Common& common);

}  // namespace tools

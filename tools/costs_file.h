// --costs: what `tradeoff --calibrate --save` measured, for the automatic choices of other commands.
#pragma once

#include <string>

#include "command.h"
#include "envmap/base/costs.h"

namespace tools {

/// --costs FILE, or ENVMAP_COSTS. @param path empty where neither says anything.
void add_costs(CLI::App& app, std::string& path);

/// The defaults where there is no path. The file is one that the output depends on. @throws InputError where it does not hold all figures, each
/// a time above 0 and up to 1000 seconds.
envmap::Costs read_costs(const std::string& path, const Common& common);

/// The text of such a file.
std::string text_of(const envmap::Costs& costs);

}  // namespace tools

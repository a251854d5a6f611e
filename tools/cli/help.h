// --help: the options of a command under headings, in at most 100 columns.
#pragma once

#include <string>

#include "command.h"

namespace tools {

/// @param all groups and the last lines of --help; -h shows the first two groups.
std::string help_of(const Command& command, const Options& options, bool all);

/// What 'envmap --help' prints: the commands.
std::string overview();

/// The groups in the order of their first option. Arguments have none.
std::vector<std::string_view> groups_of(const Options& options);

}  // namespace tools

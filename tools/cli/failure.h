// How errors of the library end the program: one line, and an exit status.
#pragma once

#include <string>

#include "cli/options.h"
#include "envmap/base/error.h"

namespace tools {

enum Status { done = 0, not_reached = 1, usage = 2, bad_input = 3, not_written = 4, no_renderer = 5 };

/// The message of an error, and what helps, in words of the options that the command has.
std::string words_of(const envmap::Error& error, const Options& options);
Status status_of(envmap::ErrorCode code);
/// Prints a line that begins with "envmap COMMAND: ". @return the exit status.
int report_error(const std::string& who, std::string what, int status);

}  // namespace tools

// What --depfile writes, and that no file is read and written by one command.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "command.h"

namespace tools {

/// The file that --depfile asks for, written but not yet shown, or null: `outputs: inputs` in Make syntax, and a rule
/// without a recipe for each input, so that make goes on where one was removed (as GCC's -MP). To be opened before the
/// outputs are written and committed after them: where there can be no depfile, there is no output.
/// @param outputs,inputs names with {face} and {level} stand for all of their files; `-` is left out.
/// @param levels that the outputs have, where their names have {level}.
/// @throws UsageError where there is no output to speak of.
std::unique_ptr<envmap::OutputFile> open_depfile(const std::vector<std::string>& outputs,
                                                 const std::vector<std::string>& inputs, const Common& common,
                                                 int levels = 1);

/// @throws UsageError where an output or the depfile is one of the inputs or another output, whatever names the two have,
/// or standard input is named twice.
void check_files(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs, const Common& common);

}  // namespace tools

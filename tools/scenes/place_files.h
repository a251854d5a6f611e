// Names of the files of maps that are drawn from several places in one run.
#pragma once

#include <string>
#include <vector>

namespace tools {

// OUTPUT for each place: {at} stands for the place as --at has it, with _ for characters that a name cannot hold, and
// {index} for its number, from 0. @param places of --at; none: one file.
// @throws UsageError where several places would have one file, or where a mark stands for no place.
std::vector<std::string> place_files(const std::string& output, const std::vector<std::string>& places);

}  // namespace tools

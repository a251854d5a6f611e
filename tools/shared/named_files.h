// The files that a name on the command line stands for.
#pragma once

#include <string>
#include <vector>

namespace tools {

/// Of a name with {face}, {half} and {level} all of its files, else the name; none of '-' and of no name.
/// @param levels that there are.
std::vector<std::string> files_of(const std::string& path, int levels);

}  // namespace tools

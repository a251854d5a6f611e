// The files that a name on the command line stands for.
#pragma once

#include <string>
#include <vector>

namespace tools {

/// How {face} is named: --faces and --from-faces.
struct FaceNames {
  std::string written = {}, read = {};
};

/// Of a name with {face}, {half} and {level} all of its files, else the name; none of '-' and of no name.
/// @param levels that there are. @param faces names of the files of {face}. @see face_files()
std::vector<std::string> files_of(const std::string& path, int levels, const std::string& faces);

}  // namespace tools

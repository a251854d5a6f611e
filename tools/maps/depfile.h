// The files of a command: none is both read and written, and --depfile lists them for make and ninja.
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

/// @throws UsageError where an output or the depfile is an input or another output, by whatever names, where standard
/// input is named twice, or where a report and an output would both go to standard output. @param others that may be
/// written, too, without being in the depfile.
void check_files(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs,
                 const FaceNames& faces = {}, const std::vector<std::string>& others = {});

/// Writes the depfile for the files of the last check_files(), if --depfile asks for one. commit_depfile() shows it.
/// Call this before outputs are written: without a depfile there is no output. Later calls do nothing. Each input gets
/// a rule without a recipe, as by GCC's -MP: make goes on where an input was removed.
/// @param levels of the outputs whose names have {level}. @throws UsageError where there is no output.
void open_depfile(int levels = 1);
void commit_depfile();

/// Discards a depfile that was not committed: the command failed.
class PendingDepfile {
 public:
  PendingDepfile() = default;
  PendingDepfile(const PendingDepfile&) = delete;
  PendingDepfile& operator=(const PendingDepfile&) = delete;
  ~PendingDepfile();
};

}  // namespace tools

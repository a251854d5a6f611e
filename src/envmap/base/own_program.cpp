#include "envmap/base/own_program.h"

#include <cerrno>

namespace envmap {

// A program that its own loader starts, as that of the portable archive, is the loader to the system. The script that
// calls the loader gives the program's name as an absolute path.
std::filesystem::path own_program() {
  std::error_code error;
  std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (program.filename().string().starts_with("ld-linux") || program.empty()) program = ::program_invocation_name;
  return program.is_absolute() ? program : std::filesystem::path();
}

}  // namespace envmap

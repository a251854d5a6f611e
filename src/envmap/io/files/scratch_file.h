// A file in the folder for temporary ones.
#pragma once

#include <string>

namespace envmap {

// Gone when this is, and where a signal ends the program. @throws OutputError
class ScratchFile {
 public:
  explicit ScratchFile(const std::string& extension);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace envmap

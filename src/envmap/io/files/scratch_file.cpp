#include "envmap/io/files/scratch_file.h"

#include <stdlib.h>
#include <unistd.h>

#include <filesystem>

#include "envmap/base/error.h"
#include "envmap/base/remove_on_signal.h"
#include "envmap/io/files/output_file.h"

namespace envmap {

ScratchFile::ScratchFile(const std::string& extension) : path_(temporary_folder() + "/envmap-XXXXXX." + extension) {
  const int descriptor = ::mkstemps(path_.data(), int(extension.size() + 1));
  if (descriptor < 0) throw OutputError(path_, "not written; TMPDIR names another folder");
  ::close(descriptor);
  remove_on_signal(path_.c_str());
}

ScratchFile::~ScratchFile() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
  keep_on_signal(path_.c_str());
}

}  // namespace envmap

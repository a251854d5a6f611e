#include "envmap/io/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "envmap/base/error.h"

namespace envmap {

InputFile::InputFile(const std::string& path) : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  struct stat status = {};
  if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0) throw InputError(std::strerror(errno));
  size_ = static_cast<std::uint64_t>(status.st_size);
}

InputFile::InputFile(std::vector<char> bytes) : bytes_(std::move(bytes)), size_(bytes_.size()) {}

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::size_t InputFile::pread(void* buffer, std::size_t size, std::uint64_t offset) const {
  const std::size_t wanted = offset < size_ ? std::min<std::uint64_t>(size, size_ - offset) : 0;
  if (descriptor_ < 0) {
    if (wanted > 0) std::memcpy(buffer, bytes_.data() + offset, wanted);
    return wanted;
  }
  std::size_t done = 0;
  while (done < wanted) {
    const ssize_t n =
        ::pread(descriptor_, static_cast<char*>(buffer) + done, wanted - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    done += static_cast<std::size_t>(n);
  }
  return done;
}

}  // namespace envmap

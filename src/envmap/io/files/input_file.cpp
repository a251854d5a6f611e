#include "envmap/io/files/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <utility>

#include "envmap/base/error.h"

namespace envmap {
namespace {

constexpr std::size_t head = 1 << 16;

}  // namespace

InputFile::InputFile(const std::string& path) : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) { start(); }

InputFile::InputFile(int descriptor) : descriptor_(::fcntl(descriptor, F_DUPFD_CLOEXEC, 3)) { start(); }

void InputFile::start() {
  struct stat status = {};
  if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0) throw InputError(std::strerror(errno));
  const off_t at = ::lseek(descriptor_, 0, SEEK_CUR);
  stream_ = !S_ISREG(status.st_mode) || at < 0;
  if (stream_) return take(head);
  start_ = std::uint64_t(at);
  size_ = std::uint64_t(std::max<off_t>(0, status.st_size - at));
}

InputFile::InputFile(std::span<const char> bytes) {
  block_.reset(static_cast<char*>(std::malloc(std::max<std::size_t>(1, bytes.size()))));
  if (!block_) throw std::bad_alloc();
  std::ranges::copy(bytes, block_.get());
  size_ = bytes.size();
}

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

// The block grows by half: the system moves large ones without copying them.
void InputFile::take(std::size_t most) {
  while (stream_ && size_ < most) {
    if (size_ == room_) {
      room_ = std::max<std::uint64_t>(head, room_ + room_ / 2);
      char* const larger = static_cast<char*>(std::realloc(block_.get(), room_));
      if (!larger) throw std::bad_alloc();
      (void)block_.release();
      block_.reset(larger);
    }
    const ssize_t n = ::read(descriptor_, block_.get() + size_, std::min<std::uint64_t>(room_, most) - size_);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw InputError(std::strerror(errno));
    size_ += std::uint64_t(n);
    stream_ = n > 0;
  }
}

void InputFile::read_all() { take(std::size_t(-1)); }

void InputFile::hold() {
  read_all();
  if (block_) return;
  std::unique_ptr<char, Free> whole(static_cast<char*>(std::malloc(std::max<std::size_t>(1, size_))));
  if (!whole) throw std::bad_alloc();
  if (pread(whole.get(), size_, 0) != size_) throw InputError("cannot be read to its end");
  block_ = std::move(whole);
}

std::size_t InputFile::pread(void* buffer, std::size_t size, std::uint64_t offset) const {
  const std::size_t wanted = offset < size_ ? std::min<std::uint64_t>(size, size_ - offset) : 0;
  if (block_) {
    if (wanted > 0) std::memcpy(buffer, block_.get() + offset, wanted);
    return wanted;
  }
  std::size_t done = 0;
  while (done < wanted) {
    const ssize_t n =
        ::pread(descriptor_, static_cast<char*>(buffer) + done, wanted - done, off_t(start_ + offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    done += std::size_t(n);
  }
  return done;
}

}  // namespace envmap

#include "envmap/map/storage.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>
#include <utility>

#include "envmap/base/error.h"
#include "envmap/base/system.h"

namespace envmap {
namespace {

// Without a name, so that nothing is left of it however the program ends. Its room on the disk is taken at once: a full
// disk must not show when a texel is written.
Colour* map_scratch_file(std::size_t bytes) {
  const char* const wanted = std::getenv("TMPDIR");
  const std::string folder = wanted && *wanted ? wanted : "/var/tmp";
  const auto fail = [&](int error) {
    throw OutputError(
        fmt::format("{}: cannot hold {:.1f} GiB of scratch: {}: set TMPDIR to another folder", folder,
                    double(bytes) / 0x1p30, std::strerror(error)));
  };
  std::string path = folder + "/envmap-XXXXXX";
  const int file = ::mkostemp(path.data(), O_CLOEXEC);
  if (file < 0) fail(errno);
  ::unlink(path.c_str());
  // Which is known at once; to fill the disk first takes minutes.
  const int full = lacks_room(file, bytes) ? ENOSPC : take_room(file, bytes);
  void* const data = full ? MAP_FAILED : ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  const int error = full ? full : errno;
  ::close(file);
  if (data == MAP_FAILED) fail(error);
  return static_cast<Colour*>(data);
}

// calloc() takes the zeros of large blocks from the system, page by page as they are first written.
Colour* zeros(std::size_t count) {
  auto* const data = static_cast<Colour*>(std::calloc(count, sizeof(Colour)));
  if (!data) throw std::bad_alloc();
  ask_for_large_pages(data, count * sizeof(Colour));
  return data;
}

}  // namespace

Storage::Storage(std::size_t count, std::size_t limit) : count_(count), limit_(limit) {
  data_ = limit ? map_scratch_file(count * sizeof(Colour)) : zeros(count);
}

Storage::Storage(const Storage& other) : Storage(other.count_, other.limit_) {
  std::memcpy(static_cast<void*>(data_), other.data_, count_ * sizeof(Colour));
}

Storage::Storage(Storage&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), count_(std::exchange(other.count_, 0)), limit_(other.limit_) {}

Storage& Storage::operator=(Storage other) noexcept {
  std::swap(data_, other.data_);
  std::swap(count_, other.count_);
  std::swap(limit_, other.limit_);
  return *this;
}

Storage::~Storage() {
  if (data_) limit_ ? static_cast<void>(::munmap(data_, count_ * sizeof(Colour))) : std::free(data_);
}

void Storage::trim() const {
  // Between two calls a thread may take as much again as it works on.
  if (limit_ && resident_bytes() > limit_ / 4 * 3) forget_pages(data_, count_ * sizeof(Colour));
}

}  // namespace envmap

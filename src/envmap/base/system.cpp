#include "envmap/base/system.h"

#include <cerrno>

#ifdef __linux__
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#else
#include <cstdio>
#endif

namespace envmap {

#ifdef __linux__

// A program that its own loader starts, as that of the portable archive, is the loader to the system. The script that
// calls the loader gives the program's name as an absolute path.
std::filesystem::path own_program() {
  std::error_code error;
  std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (program.filename().string().starts_with("ld-linux") || program.empty()) program = ::program_invocation_name;
  return program.is_absolute() ? program : std::filesystem::path();
}

int open_nameless(const std::string& folder) {
  static const bool can_be_named = ::access("/proc/self/fd", X_OK) == 0;
  return can_be_named ? ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666) : -1;
}

bool name_nameless(int descriptor, const std::string& name) {
  return ::linkat(AT_FDCWD, fmt::format("/proc/self/fd/{}", descriptor).c_str(), AT_FDCWD, name.c_str(),
                  AT_SYMLINK_FOLLOW) == 0;
}

int open_in_memory() { return ::memfd_create("envmap", MFD_CLOEXEC); }

bool rename_at_once(const std::string& from, const std::string& to, bool exchange) {
  return ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), exchange ? RENAME_EXCHANGE : RENAME_NOREPLACE) == 0;
}

Lock lock_folder(int descriptor, bool alone) {
  if (::flock(descriptor, (alone ? LOCK_EX : LOCK_SH) | LOCK_NB) == 0) return Lock::taken;
  return errno == EWOULDBLOCK ? Lock::busy : Lock::unknown;
}

int take_room(int descriptor, std::uint64_t bytes) { return ::posix_fallocate(descriptor, 0, off_t(bytes)); }

bool lacks_room(int descriptor, std::uint64_t bytes) {
  // Btrfs, ZFS, bcachefs, F2FS.
  constexpr std::uint32_t compressing[] = {0x9123683e, 0x2fc12fc1, 0xca451a4e, 0xf2f52010};
  struct statfs disk = {};
  if (::fstatfs(descriptor, &disk) != 0 || disk.f_blocks == 0) return false;
  if (std::find(std::begin(compressing), std::end(compressing), std::uint32_t(disk.f_type)) != std::end(compressing))
    return false;
  return bytes / std::uint64_t(disk.f_frsize > 0 ? disk.f_frsize : disk.f_bsize) > disk.f_bavail;
}

std::size_t resident_bytes() {
  std::FILE* const file = std::fopen("/proc/self/statm", "r");
  unsigned long all = 0, pages = 0;
  if (file) {
    if (std::fscanf(file, "%lu %lu", &all, &pages) != 2) pages = 0;
    std::fclose(file);
  }
  return pages * std::size_t(::sysconf(_SC_PAGE_SIZE));
}

void forget_pages(void* data, std::size_t bytes) { ::madvise(data, bytes, MADV_DONTNEED); }

void ask_for_large_pages(void* data, std::size_t bytes) {
  constexpr std::uintptr_t page = 1 << 21;
  const auto begin = reinterpret_cast<std::uintptr_t>(data), first = (begin + page - 1) / page * page,
             last = (begin + bytes) / page * page;
  // Refused where the system has none, which changes no result.
  if (last > first) ::madvise(static_cast<char*>(data) + (first - begin), last - first, MADV_HUGEPAGE);
}

#else

// Other systems begin with these answers. Each is right, and leaves the work to the caller. Better ones go here.
std::filesystem::path own_program() { return {}; }

int open_nameless(const std::string&) { return -1; }

bool name_nameless(int, const std::string&) {
  errno = ENOSYS;
  return false;
}

int open_in_memory() {
  std::FILE* const file = std::tmpfile();  // Whose name is gone already. It stays open.
  return file != nullptr ? ::fileno(file) : -1;
}

bool rename_at_once(const std::string&, const std::string&, bool) {
  errno = ENOSYS;
  return false;
}

Lock lock_folder(int, bool) { return Lock::unknown; }

int take_room(int, std::uint64_t) { return 0; }

bool lacks_room(int, std::uint64_t) { return false; }

std::size_t resident_bytes() { return 0; }

void forget_pages(void*, std::size_t) {}

void ask_for_large_pages(void*, std::size_t) {}

#endif

}  // namespace envmap

#include "envmap/io/files/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/base/remove_on_signal.h"
#include "envmap/base/system.h"

namespace envmap {
namespace {

namespace fs = std::filesystem;

// Writing beyond a limit of the shell's is an error like a full disk.
void bear_limits() {
  static const bool borne = std::signal(SIGXFSZ, SIG_IGN) != SIG_ERR;
  (void)borne;
}

std::string folder_of(const std::string& path) {
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

OutputError no_folder(const std::string& path, const std::string& folder) {
  std::error_code error;
  if (fs::is_directory(folder, error)) return {path, "cannot write into " + folder};
  return {path, "no such folder: " + folder};
}

std::string shown(const std::string& path) { return path == "-" ? "standard output" : path; }

// Where it is a file, another would take its place, and what the shell appends to would be gone.
bool is_standard_output(const std::string& name) {
  return name == "-" || name == "/dev/stdout" || name == "/dev/fd/1" || name == "/proc/self/fd/1";
}

}  // namespace

void check_replaceable(const std::string& path, const CommitOptions& how) {
  struct stat there = {};
  if (how.force || ::stat(path.c_str(), &there) != 0 || (there.st_mode & 0222) != 0) return;
  if (S_ISREG(there.st_mode) || S_ISDIR(there.st_mode)) throw OutputError(path, "is read-only", Remedy::force);
}

void require_folder_of(const std::string& path) {
  std::error_code error;
  const fs::path folder = fs::path(path).parent_path();
  if (!folder.empty() && !fs::is_directory(folder, error)) throw no_folder(path, folder.string());
}

std::string temporary_folder() {
  const char* const wanted = std::getenv("TMPDIR");
  return wanted && *wanted ? wanted : "/tmp";
}

int synchronise(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  // Of what cannot be read nothing can be said here; file systems without fsync say EINVAL.
  if (descriptor < 0) return errno == EACCES ? 0 : errno;
  const int error = ::fsync(descriptor) == 0 || errno == EINVAL ? 0 : errno;
  ::close(descriptor);
  return error;
}

OutputFile::OutputFile(const std::string& name, const CommitOptions& how)
    : path_(is_standard_output(name) ? "-" : name), target_(path_), how_(how) {
  const std::string& path = path_;
  bear_limits();
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (path != "-" && fs::is_directory(status)) throw OutputError(path, "is a folder: give a file name");
  // A file without a name would show it only at the end, when other outputs are there.
  if (ignored == std::errc::filename_too_long || ignored == std::errc::too_many_symbolic_link_levels)
    throw OutputError(path, "not written: " + ignored.message());
  if (path != "-" && !how.if_changed) check_replaceable(path, how);  // Else only where the bytes differ.
  stream_ = path == "-" || (fs::exists(status) && !fs::is_regular_file(status));
  // Through links to what they name, which need not exist: renaming over a link would cut it.
  for (int links = 0; !stream_ && links < 40 && fs::is_symlink(fs::symlink_status(target_, ignored)); ++links)
    target_ = (fs::path(target_).parent_path() / fs::read_symlink(target_, ignored)).string();
  // Bytes for `-`, a device or a pipe are collected: formats seek while they write.
  const std::string folder = stream_ ? temporary_folder() : folder_of(target_);
  descriptor_ = open_nameless(folder);
  if (descriptor_ < 0) {
    // Short: the target's name may be as long as names can be.
    temporary_ = (fs::path(folder) / ".envmap-XXXXXX").string();
    remove_on_signal(temporary_.c_str());  // By the name that it is about to have.
    descriptor_ = ::mkostemp(temporary_.data(), O_CLOEXEC);
    const int why = errno;
    if (descriptor_ < 0 || stream_) {
      ::unlink(temporary_.c_str());
      keep_on_signal(temporary_.c_str());
      temporary_.clear();
    }
    if (descriptor_ < 0 && why == ENOENT && !stream_) throw no_folder(path, folder);
    if (descriptor_ < 0)
      throw OutputError(fmt::format("{}: cannot write into {}: {}{}", shown(path), folder, std::strerror(why),
                                    stream_ ? ": set TMPDIR to another folder" : ""));
  }
  // Never one of the standard three, even where the caller has closed them: `-` would write into its own file.
  if (const int low = descriptor_; low < 3) {
    descriptor_ = ::fcntl(low, F_DUPFD_CLOEXEC, 3);
    ::close(low);
  }
}

OutputFile::OutputFile() : descriptor_(open_in_memory()) {
  if (descriptor_ < 0) throw OutputError(fmt::format("cannot hold the file in memory: {}", std::strerror(errno)));
}

std::vector<std::byte> OutputFile::bytes() const {
  check();
  std::vector<std::byte> all(static_cast<std::size_t>(end_));
  for (std::size_t done = 0; done < all.size();) {
    const std::size_t n = pread(all.data() + done, all.size() - done, std::int64_t(done));
    if (n == 0) throw OutputError("cannot be read back from memory");
    done += n;
  }
  return all;
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (temporary_.empty()) return;
  ::unlink(temporary_.c_str());
  keep_on_signal(temporary_.c_str());
}

std::size_t OutputFile::pread(void* buffer, std::size_t size, std::int64_t offset) const {
  const ssize_t n = ::pread(descriptor_, buffer, size, offset);
  return n < 0 ? 0 : std::size_t(n);
}

std::size_t OutputFile::write(const void* buffer, std::size_t size) {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t n =
        ::pwrite(descriptor_, static_cast<const char*>(buffer) + done, size - done, at_ + std::int64_t(done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      if (error_ == 0) error_ = n < 0 ? errno : ENOSPC;
      break;
    }
    done += std::size_t(n);
  }
  at_ += std::int64_t(done);
  end_ = std::max(end_, at_);
  return done;
}

void OutputFile::put(const void* buffer, std::size_t size) {
  if (write(buffer, size) != size) check();
}

void OutputFile::expect(std::uint64_t bytes) const {
  if (target_.empty() || !lacks_room(descriptor_, bytes)) return;  // Memory has no folder.
  const std::string what = fmt::format("takes at least {:.3g} GiB, more than is free in {}", double(bytes) / 0x1p30,
                                       stream_ ? temporary_folder() : folder_of(target_));
  throw OutputError(shown(path_), what + (stream_ ? ": set TMPDIR to another folder" : ""));
}

void OutputFile::copy_to_stream() {
  const int out = path_ == "-" ? STDOUT_FILENO : ::open(path_.c_str(), O_WRONLY);
  if (out < 0) error_ = errno;
  std::array<char, 1 << 16> block;
  for (int64_t at = 0; at < end_ && error_ == 0;) {
    const size_t n = pread(block.data(), block.size(), at);
    for (size_t done = 0; done < n && error_ == 0;) {
      const ssize_t written = ::write(out, block.data() + done, n - done);
      if (written >= 0)
        done += static_cast<size_t>(written);
      else if (errno != EINTR)
        error_ = errno;
    }
    if (n == 0) error_ = EIO;
    at += static_cast<int64_t>(n);
  }
  if (out >= 0 && path_ != "-" && ::close(out) != 0 && error_ == 0) error_ = errno;
}

// A file without a name gets one: its own at once where there is nothing yet, else another, from which it takes the
// place of what is there. One that has a name takes it from that.
void OutputFile::take_name() {
  struct stat before = {};
  const bool there = ::stat(target_.c_str(), &before) == 0;
  const mode_t mask = ::umask(0);
  ::umask(mask);
  // What is replaced keeps its owner, where that may be set, and who may read it.
  const bool keeps_group = there && (::fchown(descriptor_, before.st_uid, before.st_gid) == 0 ||
                                     ::fchown(descriptor_, uid_t(-1), before.st_gid) == 0);
  ::fchmod(descriptor_, there ? before.st_mode & (keeps_group ? 0777 : 0707) : 0666 & ~mask);
  if (temporary_.empty()) {
    if (!there && name_nameless(descriptor_, target_)) return;
    for (int k = 0; temporary_.empty() && error_ == 0; ++k) {
      temporary_ = (fs::path(folder_of(target_)) / fmt::format(".envmap-{}-{}", ::getpid(), k)).string();
      remove_on_signal(temporary_.c_str());
      if (name_nameless(descriptor_, temporary_)) break;
      if (errno != EEXIST) error_ = errno;
      keep_on_signal(temporary_.c_str());
      temporary_.clear();
    }
    if (error_ != 0) return;
  }
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) {
    error_ = errno;
    return;
  }
  keep_on_signal(temporary_.c_str());
  temporary_.clear();
}

// The same bytes under the name that this file is to have?
bool OutputFile::is_there_already() const {
  struct stat there = {};
  const int other = ::open(target_.c_str(), O_RDONLY | O_CLOEXEC);
  bool same = other >= 0 && ::fstat(other, &there) == 0 && there.st_size == end_;
  std::vector<char> ours(1 << 18), theirs(ours.size());
  for (std::int64_t at = 0; same && at < end_;) {
    const std::size_t n = pread(ours.data(), ours.size(), at);
    same = n > 0 && ::pread(other, theirs.data(), n, at) == static_cast<ssize_t>(n) &&
           std::memcmp(ours.data(), theirs.data(), n) == 0;
    at += std::int64_t(n);
  }
  if (other >= 0) ::close(other);
  return same;
}

void OutputFile::check() const {
  if (error_ == 0) return;
  if (!stream_) throw OutputError(path_, fmt::format("not written: {}", std::strerror(error_)));
  throw OutputError(shown(path_), fmt::format("cannot be held in {}: {}: set TMPDIR to another folder",
                                              temporary_folder(), std::strerror(error_)));
}

void OutputFile::commit() {
  check();
  if (stream_) {
    copy_to_stream();
  } else {
    if (how_.sync && ::fsync(descriptor_) != 0) error_ = errno;
    if (error_ == 0 && !(how_.if_changed && is_there_already())) {
      check_replaceable(target_, how_);
      take_name();
    }
    // Of what was there already, too: another program may have left it in memory.
    if (error_ == 0 && how_.sync) error_ = synchronise(target_);
    if (error_ == 0 && how_.sync) error_ = synchronise(folder_of(target_));
  }
  if (::close(descriptor_) != 0 && error_ == 0) error_ = errno;
  descriptor_ = -1;
  if (error_ != 0) throw OutputError(shown(path_), fmt::format("not written: {}", std::strerror(error_)));
}

}  // namespace envmap

#include "envmap/io/files/output_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "envmap/base/remove_on_signal.h"
#include "envmap/base/system.h"
#include "envmap/io/files/output_file.h"

namespace envmap {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

[[noreturn]] void fail(const std::string& path) {
  throw OutputError(path, fmt::format("not written: {}", std::strerror(errno)));
}

int open_folder(const fs::path& path) { return ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC); }

bool holds_only_files(const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (!entry.is_regular_file(error)) return false;
  return !error;
}

// Removes the folder unless a process that lives has it locked.
void remove_if_stale(const fs::path& folder) {
  const int descriptor = open_folder(folder);
  std::error_code ignored;
  if (descriptor >= 0 && lock_folder(descriptor, true) == Lock::taken && holds_only_files(folder))
    fs::remove_all(folder, ignored);
  if (descriptor >= 0) ::close(descriptor);
}

// Whether the folder is there and locked now, or its file system has no locks.
bool is_locked(int descriptor, const fs::path& folder) {
  struct stat open = {}, named = {};
  if (descriptor >= 0 && lock_folder(descriptor, false) == Lock::busy) return false;
  if (::stat(folder.c_str(), &named) != 0) return false;
  return descriptor < 0 || ::fstat(descriptor, &open) != 0 || open.st_ino == named.st_ino;
}

// Engines keep what they know of NAME beside it: Godot, Unity.
constexpr std::array<std::string_view, 2> companion_suffixes{".import", ".meta"};

// Whether an entry is one of these files, or lies beside one for an engine.
bool is_file_of(const fs::directory_entry& entry, const std::vector<std::string>& files) {
  return !entry.is_directory() && std::ranges::find(files, entry.path().filename().string()) != files.end();
}
bool is_companion_of(const fs::directory_entry& entry, const std::vector<std::string>& files) {
  const fs::path name = entry.path().filename();
  return entry.is_regular_file() && std::ranges::find(files, name.stem().string()) != files.end() &&
         std::ranges::find(companion_suffixes, name.extension().string()) != companion_suffixes.end();
}

constexpr std::size_t random_letters = 6;

// What killed processes left of folders of this name.
void remove_stale(const std::string& stem) {
  std::error_code error;
  const fs::path folder = fs::path(stem).parent_path();
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (const std::string path = entry.path(); path.starts_with(stem) && path.size() == stem.size() + random_letters)
      found.push_back(path);
  for (const fs::path& path : found) remove_if_stale(path);
}

}  // namespace

// Another process may take the folder for one of a dead owner, and remove it, until it is locked.
void OutputFolder::make_hidden(const std::string& stem) {
  do {
    if (lock_ >= 0) ::close(lock_);
    keep_on_signal(hidden_.c_str());
    hidden_ = stem + std::string(random_letters, 'X');
    remove_on_signal(hidden_.c_str());  // By the name that it is about to have.
    if (!::mkdtemp(hidden_.data())) {
      const int why = errno;
      keep_on_signal(hidden_.c_str());
      hidden_.clear();
      errno = why;
      fail(path_);
    }
    lock_ = open_folder(hidden_);
  } while (!is_locked(lock_, hidden_));
}

// What is there may be written anew, or go with what an earlier run wrote.
void OutputFolder::check_entries() const {
  std::error_code error;
  const fs::directory_iterator entries(path_, error);
  if (error) throw OutputError(path_, fmt::format("cannot be read: {}", error.message()));
  for (const auto& entry : entries) {
    if (is_file_of(entry, files_) || is_companion_of(entry, files_)) continue;
    if (!is_file_of(entry, earlier_) && !is_companion_of(entry, earlier_))
      throw UsageError(path_, fmt::format("contains {}, which would be lost: move it out, or choose another folder",
                                          entry.path().filename().string()));
    check_replaceable(entry.path(), how_);
  }
}

OutputFolder::OutputFolder(std::string path, std::span<const std::string> files, std::span<const std::string> earlier,
                           const CommitOptions& how)
    : path_(std::move(path)), files_(files.begin(), files.end()), earlier_(earlier.begin(), earlier.end()), how_(how) {
  if (path_.empty()) throw UsageError("the name of the folder is empty");
  while (path_.size() > 1 && path_.ends_with('/')) path_.pop_back();
  std::error_code error;
  if (fs::exists(path_, error)) {
    if (!fs::is_directory(path_, error)) throw UsageError(path_, "is not a folder: choose another name");
    if (fs::equivalent(path_, fs::current_path(error), error))
      throw UsageError(path_, "is the current folder, which would be another one then: choose one inside or beside it");
    check_replaceable(path_, how_);
    check_entries();
  }
  // The folder that a link names, not the link.
  const fs::path full = fs::weakly_canonical(fs::absolute(path_), error);
  if (error || fs::is_symlink(full, error)) throw UsageError(path_, "is a link to nothing: choose another name");
  target_ = full.string();
  make_parents(full.parent_path());
  const std::string stem = (full.parent_path() / fmt::format(".{}.envmap-", full.filename().string())).string();
  remove_stale(stem);
  make_hidden(stem);
  for (const std::string& name : files_) {
    pending_.push_back(file(name));
    for (const std::string_view suffix : companion_suffixes) pending_.push_back(file(name + std::string(suffix)));
  }
  // Behind the hidden folder, which lies in them.
  pending_.insert(pending_.end(), parents_.begin(), parents_.end());
  for (const std::string& name : pending_) remove_on_signal(name.c_str());
  const mode_t mask = ::umask(0);
  ::umask(mask);
  struct stat before = {};
  ::chmod(hidden_.c_str(), ::stat(path_.c_str(), &before) == 0 ? before.st_mode & 0777 : 0777 & ~mask);
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  if (!hidden_.empty()) fs::remove_all(hidden_, ignored);
  if (lock_ >= 0) ::close(lock_);
  for (const std::string& parent : parents_) ::rmdir(parent.c_str());  // Fails where the folder lies in it.
  for (const std::string& name : pending_) keep_on_signal(name.c_str());
  keep_on_signal(hidden_.c_str());
}

void OutputFolder::make_parents(const fs::path& parent) {
  std::error_code error;
  for (fs::path p = parent; !fs::exists(p, error) && p.has_relative_path(); p = p.parent_path()) parents_.push_back(p);
  fs::create_directories(parent, error);
  if (error) throw OutputError(path_, fmt::format("cannot make the folder {}: {}", parent.string(), error.message()));
}

void OutputFolder::keep_companions() const {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(path_, error)) {
    if (!is_companion_of(entry, files_)) continue;
    const std::string kept = file(entry.path().filename().string());
    fs::create_hard_link(entry, kept, error);
    if (error) fs::copy_file(entry, kept, error);  // Not every file system has links.
    if (error) throw OutputError(entry.path().string(), fmt::format("cannot be kept: {}", error.message()));
  }
}

std::string OutputFolder::file(std::string_view name) const { return hidden_ + "/" + std::string(name); }

OutputError OutputFolder::with_final_path(const OutputError& e, std::string_view name) const {
  const std::string hidden = file(name);
  if (e.file() != hidden) return e;
  return {path_ + "/" + std::string(name), std::string(e.what()).substr(hidden.size() + 2), e.remedy()};
}

void OutputFolder::write(std::string_view name, std::string_view text) const {
  try {
    OutputFile out(file(name), how_);
    out.write(text.data(), text.size());
    out.commit();
  } catch (const OutputError& e) {
    throw with_final_path(e, name);
  }
}

bool OutputFolder::is_there_already() const {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(path_, error))
    if (!is_file_of(entry, files_) && !is_companion_of(entry, files_)) return false;  // It goes.
  return std::ranges::all_of(files_, [&](const std::string& name) {
    return fs::exists(fs::path(path_) / name, error) && bytes_of(fs::path(path_) / name) == bytes_of(file(name));
  });
}

void OutputFolder::commit() {
  const bool unchanged = how_.if_changed && is_there_already();
  if (!unchanged) {
    keep_companions();
    take_name();
  }
  if (!how_.sync) return;
  std::vector<std::string> left{fs::absolute(path_).parent_path().string(), path_};
  // Of what was there already, too: another program may have left it in memory.
  for (const std::string& name : files_)
    if (unchanged) left.push_back(path_ + "/" + name);
  for (const std::string& path : left) {
    errno = synchronise(path);
    if (errno != 0) fail(path_);
  }
}

void OutputFolder::take_name() {
  struct stat there = {};
  const bool exchange = ::stat(target_.c_str(), &there) == 0;
  if (rename_at_once(hidden_, target_, exchange)) {
    if (!exchange) hidden_.clear();  // Else it now has what was there before, and goes.
    return;
  }
  // File systems of networks know no flags.
  if ((errno != EINVAL && errno != ENOSYS) || !rename_plainly(exchange)) fail(path_);
}

// For a moment there is no folder of that name.
bool OutputFolder::rename_plainly(bool exchange) {
  std::string before;
  if (exchange) {
    before = hidden_.substr(0, hidden_.size() - random_letters) + std::string(random_letters, 'X');
    if (!::mkdtemp(before.data()) || ::rename(target_.c_str(), before.c_str()) != 0) return false;
  }
  if (::rename(hidden_.c_str(), target_.c_str()) != 0) {
    const int why = errno;
    if (exchange) ::rename(before.c_str(), target_.c_str());
    errno = why;
    return false;
  }
  hidden_ = before;  // Which goes.
  return true;
}

}  // namespace envmap

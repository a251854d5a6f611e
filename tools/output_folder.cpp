#include "output_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "envmap/base/remove_on_signal.h"
#include "envmap/io/output_file.h"

namespace tools {
namespace {

using namespace envmap;
namespace fs = std::filesystem;

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

[[noreturn]] void fail(const std::string& path) {
  throw OutputError(path, fmt::format("not written: {}", std::strerror(errno)));
}

}  // namespace

OutputFolder::OutputFolder(std::string path, std::span<const std::string_view> files, const CommitOptions& how)
    : path_(std::move(path)), files_(files.begin(), files.end()), how_(how) {
  while (path_.size() > 1 && path_.ends_with('/')) path_.pop_back();
  std::error_code error;
  if (fs::exists(path_, error)) {
    if (!fs::is_directory(path_, error)) throw UsageError(path_, "is no folder; name another");
    for (const auto& entry : fs::directory_iterator(path_))
      if (const std::string name = entry.path().filename(); std::ranges::find(files_, name) == files_.end())
        throw UsageError(path_, fmt::format("holds {}, which would be lost; name another folder", name));
  }
  const fs::path full = fs::absolute(path_);
  hidden_ = (full.parent_path() / fmt::format(".{}-XXXXXX", full.filename().string())).string();
  remove_on_signal(hidden_.c_str());  // By the name that it is about to have.
  if (!::mkdtemp(hidden_.data())) {
    keep_on_signal(hidden_.c_str());
    hidden_.clear();
    fail(path_);
  }
  for (const std::string& name : files_) pending_.push_back(file(name));
  for (const std::string& name : pending_) remove_on_signal(name.c_str());
  const mode_t mask = ::umask(0);
  ::umask(mask);
  struct stat before = {};
  ::chmod(hidden_.c_str(), ::stat(path_.c_str(), &before) == 0 ? before.st_mode & 0777 : 0777 & ~mask);
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  if (!hidden_.empty()) fs::remove_all(hidden_, ignored);
  for (const std::string& name : pending_) keep_on_signal(name.c_str());
  keep_on_signal(hidden_.c_str());
}

std::string OutputFolder::file(std::string_view name) const { return hidden_ + "/" + std::string(name); }

OutputError OutputFolder::as_it_will_be(const OutputError& e, std::string_view name) const {
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
    throw as_it_will_be(e, name);
  }
}

bool OutputFolder::is_there_already() const {
  return std::ranges::all_of(files_, [&](const std::string& name) {
    std::error_code error;
    return fs::exists(fs::path(path_) / name, error) && bytes_of(fs::path(path_) / name) == bytes_of(file(name));
  });
}

void OutputFolder::commit() {
  if (how_.if_changed && is_there_already()) return;
  struct stat there = {};
  const bool exchange = ::stat(path_.c_str(), &there) == 0;
  if (::renameat2(AT_FDCWD, hidden_.c_str(), AT_FDCWD, path_.c_str(), exchange ? RENAME_EXCHANGE : RENAME_NOREPLACE) != 0)
    fail(path_);
  if (!exchange) hidden_.clear();  // Else it now has what was there before, and goes.
  if (!how_.sync) return;
  errno = synchronise(fs::absolute(path_).parent_path().string());
  if (errno != 0) fail(path_);
}

}  // namespace tools

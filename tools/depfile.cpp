#include "depfile.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "envmap/base/error.h"
#include "envmap/io/path.h"
#include "named_files.h"

namespace tools {
namespace {

using namespace envmap;
namespace fs = std::filesystem;

// As GCC writes names (mkdeps): a backslash before spaces and #, those before it doubled; $ doubled; other backslashes as
// they are. Beyond GCC, which leaves them, colons get a backslash, too: make and ninja read both.
std::string escaped(const std::string& name) {
  std::string out;
  std::size_t backslashes = 0;
  for (const char c : name) {
    if (c == '\n') throw UsageError(name, "a depfile cannot hold a name of two lines");
    if (c == ' ' || c == '\t' || c == '#') out += std::string(backslashes + 1, '\\');
    if (c == ':') out += '\\';
    if (c == '$') out += '$';
    out += c;
    backslashes = c == '\\' ? backslashes + 1 : 0;
  }
  return out;
}

// Each once, in the order in which they come.
std::vector<std::string> inputs_of(const std::vector<std::string>& paths) {
  std::vector<std::string> all;
  for (const std::string& path : paths)
    for (const std::string& file : files_of(path, std::max(1, count_level_files(path))))
      if (std::ranges::find(all, file) == all.end()) all.push_back(file);
  return all;
}

// The same for all names of a file; empty for devices and pipes, which may well be read and written.
std::string identity(const std::string& path) {
  struct stat status = {};
  if (::stat(path.c_str(), &status) == 0)
    return S_ISREG(status.st_mode) ? fmt::format("{} {}", status.st_dev, status.st_ino) : "";
  std::error_code error;
  return fs::weakly_canonical(fs::absolute(path, error), error).string();
}

}  // namespace

std::unique_ptr<OutputFile> open_depfile(const std::vector<std::string>& outputs,
                                         const std::vector<std::string>& inputs, const Common& common, int levels) {
  if (common.depfile.empty()) return nullptr;
  std::string text, phony;
  for (const std::string& output : outputs)
    for (const std::string& file : files_of(output, levels)) text += (text.empty() ? "" : " ") + escaped(file);
  if (text.empty()) throw UsageError("--depfile: no file is written that could depend on another");
  text += ":";
  std::vector<std::string> all = inputs;
  all.insert(all.end(), common.also_read->begin(), common.also_read->end());
  for (const std::string& input : inputs_of(all)) {
    text += " " + escaped(input);
    phony += escaped(input) + ":\n";
  }
  text += "\n" + phony;
  auto file = std::make_unique<OutputFile>(common.depfile, common.commit);
  file->write(text.data(), text.size());
  return file;
}

void check_files(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs, const Common& common) {
  if (std::ranges::count(inputs, "-") > 1) throw UsageError("-: standard input can be read once, and is named twice");
  std::set<std::string> written, read;
  for (const std::string& input : inputs_of(inputs)) read.insert(identity(input));
  read.erase("");
  std::vector<std::string> files{common.depfile};
  files.insert(files.end(), outputs.begin(), outputs.end());
  for (const std::string& output : files)
    for (const std::string& file : files_of(output, 1)) {
      const std::string id = identity(file);
      if (read.contains(id)) throw UsageError(file, "is read and would be overwritten: give the output another name");
      if (!id.empty() && !written.insert(id).second)
        throw UsageError(file, "would be written twice: give each output a name of its own");
    }
}

}  // namespace tools

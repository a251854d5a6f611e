#include "maps/depfile.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>

#include "cli/console.h"
#include "envmap/base/error.h"
#include "envmap/io/files/face_names.h"
#include "envmap/io/files/output_file.h"

namespace tools {
namespace {

using namespace envmap;
namespace fs = std::filesystem;

struct Depfile {
  std::vector<std::string> outputs, inputs;
  FaceNames faces;
  std::unique_ptr<OutputFile> file;
  bool opened = false;
};
Depfile& depfile() {
  static Depfile one;
  return one;
}

// As GCC writes names (mkdeps): a backslash before spaces and #, those before it doubled; $ doubled; other backslashes
// as they are. Beyond GCC, which leaves them, colons get a backslash, too: make and ninja read both.
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
std::vector<std::string> inputs_of(const std::vector<std::string>& paths, const std::string& faces) {
  std::vector<std::string> all;
  for (const std::string& path : paths)
    for (const std::string& file : files_of(path, std::max(1, count_level_files(path, face_files(faces))), faces))
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

std::vector<std::string> files_of(const std::string& path, int levels, const std::string& faces) {
  if (path.empty() || path == "-") return {};
  return files_named(path, levels, face_files(faces));
}

void check_files(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs,
                 const FaceNames& faces, const std::vector<std::string>& others) {
  depfile() = {outputs, inputs, faces, nullptr, false};
  if (settings().json && (std::ranges::find(outputs, "-") != outputs.end() || settings().depfile == "-"))
    throw UsageError("--json and the output cannot both be standard output: give a file name");
  if (std::ranges::count(inputs, "-") > 1) throw UsageError("-: standard input can be read once, and is named twice");
  std::set<std::string> written, read;
  for (const std::string& input : inputs_of(inputs, faces.read)) read.insert(identity(input));
  read.erase("");
  std::vector<std::string> files{settings().depfile};
  files.insert(files.end(), outputs.begin(), outputs.end());
  files.insert(files.end(), others.begin(), others.end());
  // How many levels will be written is not known yet: no name that one could have is free.
  for (const std::string& output : files) {
    for (const std::string& file : files_of(output, int(limits::levels.most), faces.written)) {
      const std::string id = identity(file);
      if (read.contains(id)) throw UsageError(file, "is both input and output: choose another output name");
      if (!id.empty() && !written.insert(id).second)
        throw UsageError(file, "would be written twice: give each output a name of its own");
    }
    // Else only what differs is replaced.
    if (!settings().commit.if_changed)
      for (const std::string& file : files_of(output, 1, faces.written)) check_replaceable(file, settings().commit);
  }
}

void open_depfile(int levels) {
  if (settings().depfile.empty() || depfile().opened) return;
  depfile().opened = true;
  std::string text, phony;
  for (const std::string& output : depfile().outputs)
    for (const std::string& file : files_of(output, levels, depfile().faces.written))
      text += (text.empty() ? "" : " ") + escaped(file);
  if (text.empty()) throw UsageError("--depfile: no file is written that could depend on another");
  text += ":";
  std::vector<std::string> all = depfile().inputs;
  all.insert(all.end(), settings().also_read.begin(), settings().also_read.end());
  for (const std::string& input : inputs_of(all, depfile().faces.read)) {
    text += " " + escaped(input);
    phony += escaped(input) + ":\n";
  }
  text += "\n" + phony;
  depfile().file = std::make_unique<OutputFile>(settings().depfile, settings().commit);
  depfile().file->write(text.data(), text.size());
  depfile().file->check();
  if (!depfile().file->is_stream()) return;
  // Devices and pipes have their bytes before the outputs.
  depfile().file->commit();
  depfile().file.reset();
}

void commit_depfile() {
  if (depfile().file) depfile().file->commit();
}

PendingDepfile::~PendingDepfile() { depfile() = {}; }

}  // namespace tools

#include "depfile.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "envmap/base/error.h"
#include "envmap/io/path.h"

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

// The files that a name with {face} and {level} stands for.
std::vector<std::string> files_of(const std::string& path, int levels) {
  std::vector<std::string> all;
  if (path.empty() || path == "-") return all;
  for (int level = 0; level < (has_level(path) ? levels : 1); ++level)
    for (int face = 0; face < (has_face(path) ? 6 : 1); ++face) {
      const std::string one = level_path(path, level);
      all.push_back(has_face(one) ? face_path(one, face) : one);
    }
  return all;
}

// Each once, in the order in which they come.
std::vector<std::string> inputs_of(const std::vector<std::string>& paths) {
  std::vector<std::string> all;
  for (const std::string& path : paths)
    for (const std::string& file : files_of(path, std::max(1, count_level_files(path))))
      if (std::ranges::find(all, file) == all.end()) all.push_back(file);
  return all;
}

// One file under two names? Devices and pipes may well be read and written.
bool same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  if (fs::exists(a, error) && fs::exists(b, error)) return fs::is_regular_file(a, error) && fs::equivalent(a, b, error);
  return fs::weakly_canonical(fs::absolute(a, error), error) == fs::weakly_canonical(fs::absolute(b, error), error);
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
  for (const std::string& input : inputs_of(inputs)) {
    text += " " + escaped(input);
    phony += escaped(input) + ":\n";
  }
  text += "\n" + phony;
  auto file = std::make_unique<OutputFile>(common.depfile);
  file->write(text.data(), text.size());
  return file;
}

void check_files(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs, const Common& common) {
  std::vector<std::string> written;
  if (!common.depfile.empty()) written.push_back(common.depfile);
  const std::vector<std::string> read = inputs_of(inputs);
  for (const std::string& output : outputs)
    for (const std::string& file : files_of(output, 1)) {
      for (const std::string& other : written)
        if (same_file(file, other))
          throw UsageError(file, "would be written twice: give each output a name of its own");
      written.push_back(file);
    }
  for (const std::string& file : written)
    for (const std::string& input : read)
      if (same_file(file, input))
        throw UsageError(file, "is read and would be overwritten: give the output another name");
}

}  // namespace tools

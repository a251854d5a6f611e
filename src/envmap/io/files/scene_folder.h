/// @file
/// The files that a scene names: they lie in its folder, or they are not read.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "envmap/base/error.h"

namespace envmap {

/// That there is no such file.
class MissingFile : public InputError {
 public:
  using InputError::InputError;
};

/// All bytes of a regular file of 1 byte to 4 GiB. @throws MissingFile, or InputError, without the name of the file.
std::vector<std::byte> file_bytes(const std::filesystem::path& path);

/// The same of what is left of standard input.
std::vector<std::byte> standard_input();

/// The folder that a scene's file lies in. A scene may come from anywhere: what it names is looked for in there and
/// below, whatever `..`, absolute names and symbolic links say. Where the scene itself is a link (a build system's
/// sandbox, for one) the folder of what it links to counts, too.
class SceneFolder {
 public:
  explicit SceneFolder(const std::string& scene);
  /// Of a scene in memory, which has none: file() throws.
  SceneFolder() = default;

  /// Where the file of that name is. @param below a folder in this one that the name is relative to.
  /// @throws InputError, without the name, where it leads out of the folder.
  [[nodiscard]] std::filesystem::path file(const std::string& name, const std::filesystem::path& below = {}) const;

 private:
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> allowed_;  // Without links.
};

}  // namespace envmap

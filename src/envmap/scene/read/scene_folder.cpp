#include "envmap/scene/read/scene_folder.h"

#include <algorithm>
#include <fstream>
#include <limits>

#include "envmap/base/error.h"

namespace envmap {

namespace fs = std::filesystem;

// A regular file: /dev/zero would go on for ever.
std::vector<std::byte> file_bytes(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) throw InputError("no such file");
  if (!fs::is_regular_file(path, error)) throw InputError("is not a file");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error || size == 0) throw InputError("is empty");
  if (size > std::numeric_limits<std::uint32_t>::max())
    throw InputError("has over 4 GiB, more than is read of a scene");
  std::vector<std::byte> bytes(size);
  std::ifstream stream(path, std::ios::binary);
  if (!stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size())))
    throw InputError("cannot be read");
  return bytes;
}

SceneFolder::SceneFolder(const std::string& scene) : folder_(fs::path(scene).parent_path()) {
  std::error_code error;
  allowed_.push_back(fs::canonical(folder_.empty() ? "." : folder_, error));
  allowed_.push_back(fs::canonical(scene, error).parent_path());
}

fs::path SceneFolder::file(const std::string& name, const fs::path& below) const {
  // The system would end the name there, and open another.
  if (name.find('\0') != name.npos) throw InputError("names no file");
  std::error_code error;
  const fs::path path = folder_ / below / name, real = fs::weakly_canonical(fs::absolute(path, error), error);
  const auto holds = [&](const fs::path& folder) {
    return !folder.empty() && std::ranges::mismatch(folder, real).in1 == folder.end();
  };
  if (error || std::ranges::none_of(allowed_, holds))
    throw InputError("lies outside the scene's folder, and is not read; put it into the folder");
  return path;
}

}  // namespace envmap

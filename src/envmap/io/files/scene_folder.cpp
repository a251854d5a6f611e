#include "envmap/io/files/scene_folder.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>

#include "envmap/base/error.h"

namespace envmap {

namespace fs = std::filesystem;

constexpr const char* too_large = "has over 4 GiB, more than is read of a scene";

// A regular file: /dev/zero would go on for ever.
std::vector<std::byte> file_bytes(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) throw MissingFile("no such file");
  if (!fs::is_regular_file(path, error)) throw InputError("is not a file");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error || size == 0) throw InputError("is empty");
  if (size > std::numeric_limits<std::uint32_t>::max()) throw InputError(too_large);
  std::vector<std::byte> bytes(size);
  std::ifstream stream(path, std::ios::binary);
  if (!stream.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size())))
    throw InputError("cannot be read");
  return bytes;
}

std::vector<std::byte> standard_input() {
  std::vector<std::byte> bytes;
  for (std::size_t size = 0;;) {
    bytes.resize(std::max<std::size_t>(1 << 16, size + size / 2));
    const ssize_t n = ::read(STDIN_FILENO, bytes.data() + size, bytes.size() - size);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw InputError(std::strerror(errno));
    size += std::size_t(n);
    if (size > std::numeric_limits<std::uint32_t>::max()) throw InputError(too_large);
    if (n > 0) continue;
    if (size == 0) throw InputError("is empty: what should have written it may have failed");
    bytes.resize(size);
    return bytes;
  }
}

SceneFolder::SceneFolder(const std::string& scene) : folder_(fs::path(scene).parent_path()) {
  std::error_code error;
  allowed_.push_back(fs::canonical(folder_.empty() ? "." : folder_, error));  // An empty path, if there is none.
  allowed_.push_back(fs::canonical(scene, error).parent_path());
}

fs::path SceneFolder::file(const std::string& name, const fs::path& below) const {
  // The system would end the name there, and open another.
  if (name.find('\0') != name.npos) throw InputError("names no file");
  if (allowed_.empty()) throw InputError("is a file that a scene in memory names: give the folder that it lies in");
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

#include "picture/font.h"

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

namespace tools {
namespace {

namespace fs = std::filesystem;

std::string setting(const char* name, const std::string& otherwise) {
  const char* value = std::getenv(name);
  return value != nullptr && *value != '\0' ? value : otherwise;
}

// XDG Base Directory Specification 0.8, and the folder that came before it.
std::vector<fs::path> font_folders() {
  const fs::path home = setting("HOME", "/");
  std::vector<fs::path> folders{fs::path(setting("XDG_DATA_HOME", home / ".local/share")) / "fonts", home / ".fonts"};
  std::istringstream shared(setting("XDG_DATA_DIRS", "/usr/local/share:/usr/share"));
  for (std::string folder; std::getline(shared, folder, ':');) folders.push_back(fs::path(folder) / "fonts");
  return folders;
}

// The first by its path, so that the order of a folder's entries does not count.
std::string find_below(const fs::path& folder, const std::string& name) {
  std::string found;
  std::error_code error;
  for (auto at = fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied, error);
       !error && at != fs::recursive_directory_iterator(); at.increment(error))
    if (at->path().filename() == name && (found.empty() || at->path() < found)) found = at->path();
  return found;
}

std::string find_font() {
  const std::vector<fs::path> folders = font_folders();
  for (const char* name : {"DejaVuSans.ttf", "LiberationSans-Regular.ttf", "NotoSans-Regular.ttf"})
    for (const fs::path& folder : folders)
      if (std::string found = find_below(folder, name); !found.empty()) return found;
  return {};
}

}  // namespace

const std::string& font_file() {
  static const std::string found = find_font();
  return found;
}

}  // namespace tools

#include "scenes/mirror_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "envmap/base/error.h"

namespace tools {
using namespace envmap;

MirrorWish mirror_wish(const Scene& scene, const std::string& text) {
  if (find_node(scene, text)) return {text};
  if (const auto colon = text.rfind(':'); colon != std::string::npos) {
    const std::string node = text.substr(0, colon), how = text.substr(colon + 1);
    const auto to = projection_named(how);
    if (find_node(scene, node)) {
      if (how == "off") return {.node = node, .off = true};
      if (to && std::ranges::find(map_names, name(*to)) != std::end(map_names)) return {node, to};
    }
  }
  throw UsageError(fmt::format(
      "--mirror: '{}' must be a node of the scene, or NODE:sphere, NODE:paraboloid, NODE:cube or NODE:off: {}", text,
      list_nodes(scene)));
}

std::vector<std::string> map_files(const std::string& folder, const Scene& scene, const std::vector<int>& nodes) {
  std::vector<std::string> files;
  if (std::error_code error; std::filesystem::exists(folder, error) && !std::filesystem::is_directory(folder, error))
    throw UsageError(folder, "is not a folder");
  for (const int node : nodes) {
    std::string name = scene.nodes[std::size_t(node)].name;
    const auto ends_names = [](unsigned char c) {
      return c < 32 || std::string_view("/\\{}%").find(static_cast<char>(c)) != std::string_view::npos;
    };
    std::ranges::replace_if(name, ends_names, '_');
    if (name.empty() || name.starts_with('.')) name = fmt::format("node {}{}", node, name);
    std::string path = (std::filesystem::path(folder) / (name + ".exr")).string();
    if (std::ranges::find(files, path) != files.end())
      path = (std::filesystem::path(folder) / fmt::format("{} (node {}).exr", name, node)).string();
    files.push_back(path);
  }
  return files;
}

std::vector<std::string> numbered(std::vector<std::string> files, int frame) {
  for (std::string& file : files) file.insert(file.size() - 4, fmt::format(".{:04}", frame));
  return files;
}

}  // namespace tools

#include "scenes/mirror_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "envmap/base/error.h"
#include "envmap/render/draw.h"

namespace tools {
namespace {

using namespace envmap;

// What --mirror says of a node: no projection, as --maps says.
struct MirrorWish {
  int node;
  bool off = false;
  std::optional<Projection> to = {};
};

// NODE, NODE:PROJECTION or NODE:off.
MirrorWish wish(const Scene& scene, const std::string& text) {
  if (const auto node = find_node(scene, text)) return {*node};
  if (const auto colon = text.rfind(':'); colon != std::string::npos) {
    const auto node = find_node(scene, text.substr(0, colon));
    const std::string how = text.substr(colon + 1);
    const auto to = projection_named(how);
    if (node && how == "off") return {*node, true};
    if (node && to && std::ranges::find(map_names, name(*to)) != std::end(map_names)) return {*node, false, to};
  }
  throw UsageError(
      fmt::format("--mirror: '{}' must be a node of the scene, or NODE:sphere, NODE:paraboloid, NODE:cube or NODE:off",
                  text));
}

}  // namespace

std::vector<Mirror> mirrors_of(const Scene& scene, const std::vector<std::string>& wishes, Projection maps) {
  std::vector<Mirror> all;
  std::vector<int> decided;
  for (const std::string& text : wishes) {
    const MirrorWish wished = wish(scene, text);
    const bool is_empty = std::ranges::none_of(
        instances(scene), [&](const Instance& instance) { return lies_under(scene, instance.node, wished.node); });
    if (is_empty) throw UsageError(fmt::format("--mirror: '{}' has no triangles", text));
    decided.push_back(wished.node);
    if (!wished.off) all.push_back(make_mirror(scene, wished.node, wished.to.value_or(maps)));
  }
  for (const Mirror& found : find_mirrors(scene, maps))
    if (std::ranges::none_of(decided, [&](int node) { return lies_under(scene, found.node, node); }))
      all.push_back(found);
  return all;
}

std::vector<std::string> map_files(const std::string& folder, const Scene& scene, const std::vector<int>& nodes) {
  std::vector<std::string> files;
  if (!std::filesystem::is_directory(folder)) throw UsageError(folder, "is not a folder: create it first");
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

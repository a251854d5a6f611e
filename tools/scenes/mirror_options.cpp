#include "scenes/mirror_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "cli/console.h"
#include "envmap/base/error.h"
#include "scenes/scene_options.h"

namespace tools {
using namespace envmap;

MirrorWish mirror_wish(const SceneGraph& scene, const std::string& text) {
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
      nodes_in_words(scene)));
}

std::vector<std::string> map_files(const std::string& folder, const SceneGraph& scene, const std::vector<int>& nodes,
                                   const std::string& extension) {
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
    std::string path = (std::filesystem::path(folder) / (name + "." + extension)).string();
    if (std::ranges::find(files, path) != files.end())
      path = (std::filesystem::path(folder) / fmt::format("{} (node {}).{}", name, node, extension)).string();
    files.push_back(path);
  }
  return files;
}

std::vector<std::string> numbered(std::vector<std::string> files, int frame) {
  for (std::string& file : files) file.insert(file.rfind('.'), fmt::format(".{:04}", frame));
  return files;
}

namespace {

std::string words(const MapUpdate& update, const Mirror& mirror, const std::string& node) {
  switch (update.outcome) {
    case MapUpdate::Outcome::unseen: return fmt::format("{}: not seen, not drawn", node);
    case MapUpdate::Outcome::unchanged:
      return fmt::format("{}: its surroundings did not change, not drawn again", node);
    case MapUpdate::Outcome::drawn: break;
  }
  return fmt::format("{}: {} of {}, {} of {} faces drawn in {:.1f} ms", node, name(mirror.to), update.size,
                     update.faces, faces(mirror.to), 1e3 * update.seconds);
}

}  // namespace

void tell(const MirrorUpdates& updates, const SceneGraph& scene, const std::vector<Mirror>& mirrors) {
  if (!settings().verbose) return;
  for (const MapUpdate& update : updates.maps) {
    const Mirror& mirror = mirrors[std::size_t(update.mirror)];
    note(words(update, mirror, scene.nodes[std::size_t(mirror.node)].name));
  }
  if (!updates.settled) note(fmt::format("mirrors go on changing each other after {} rounds", max_rounds));
}

void MirrorTable::add(const MirrorUpdates& of_frame) {
  for (const MapUpdate& update : of_frame.maps) {
    Row& row = rows_[std::size_t(update.mirror)];
    row.drawn += update.outcome == MapUpdate::Outcome::drawn;
    row.unchanged += update.outcome == MapUpdate::Outcome::unchanged;
    row.unseen += update.outcome == MapUpdate::Outcome::unseen;
    row.faces += update.faces, row.seconds += update.seconds;
    if (update.size > 0) row.size = update.size;
  }
}

void MirrorTable::put(Report& report) const {
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    report.append("mirrors[]");
    report.put("mirrors[].node", scene_.nodes[std::size_t(mirrors_[k].node)].name);
    report.put("mirrors[].map", name(mirrors_[k].to));
    report.put("mirrors[].size", rows_[k].size);
    report.put("mirrors[].drawn", rows_[k].drawn);
    report.put("mirrors[].faces", rows_[k].faces);
    report.put("mirrors[].unchanged", rows_[k].unchanged);
    report.put("mirrors[].unseen", rows_[k].unseen);
    report.put("mirrors[].seconds", rows_[k].seconds);
  }
}

}  // namespace tools

#include "envmap/scenes/choose_mirrors.h"

#include <fmt/format.h>

#include <algorithm>

#include "envmap/base/error.h"

namespace envmap {
namespace {

// A node of the scene that has something to show.
int mirror_node(const SceneGraph& scene, const MirrorWish& wish) {
  const auto node = find_node(scene, wish.node);
  if (!node) throw UsageError(fmt::format("mirror '{}' is no node of the scene: {}", wish.node, list_nodes(scene)));
  const auto all = instances(scene);
  if (std::ranges::none_of(all, [&](const Instance& i) { return lies_under(scene, i.node, *node); }))
    throw UsageError(fmt::format("mirror '{}' has no triangles", wish.node));
  return *node;
}

}  // namespace

std::vector<Mirror> choose_mirrors(const SceneGraph& scene, const std::vector<MirrorWish>& wishes, Projection maps) {
  std::vector<Mirror> all;
  std::vector<int> decided;
  for (const MirrorWish& wish : wishes) {
    decided.push_back(mirror_node(scene, wish));
    if (!wish.off) all.push_back(make_mirror(scene, decided.back(), wish.map.value_or(maps)));
  }
  for (const Mirror& found : find_mirrors(scene, maps))
    if (std::ranges::none_of(decided, [&](int node) { return lies_under(scene, found.node, node); }))
      all.push_back(found);
  return all;
}

}  // namespace envmap

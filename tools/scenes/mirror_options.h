// What --mirror says, the files of mirrors' maps, and what became of the maps: a line of --verbose for each, and a
// table of --json over all frames.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cli/report.h"
#include "envmap/scenes/render/mirrors.h"
#include "envmap/scenes/scene/scene_graph.h"
#include "envmap/scenes/view.h"

namespace tools {

// Projections of mirrors' maps.
inline constexpr std::string_view map_names[] = {"sphere", "paraboloid", "cube"};

// NODE, NODE:PROJECTION or NODE:off. @throws UsageError
envmap::MirrorWish mirror_wish(const envmap::SceneGraph& scene, const std::string& text);

// FOLDER/NODE.EXTENSION for each; names are told apart, and what would end them is replaced. @throws UsageError where
// there is no such folder.
std::vector<std::string> map_files(const std::string& folder, const envmap::SceneGraph& scene,
                                   const std::vector<int>& nodes, const std::string& extension);

// Of a frame: NODE.0001.exr.
std::vector<std::string> numbered(std::vector<std::string> files, int frame);

// Says it where --verbose is given.
void tell(const envmap::MirrorUpdates& updates, const envmap::SceneGraph& scene,
          const std::vector<envmap::Mirror>& mirrors);

class MirrorTable {
 public:
  MirrorTable(const envmap::SceneGraph& scene, const std::vector<envmap::Mirror>& mirrors)
      : scene_(scene), mirrors_(mirrors), rows_(mirrors.size()) {}

  void add(const envmap::MirrorUpdates& of_frame);
  // Keys mirrors[] of the report.
  void put(Report& report) const;

 private:
  struct Row {
    int size = 0, drawn = 0, faces = 0, unchanged = 0, unseen = 0;
    double seconds = 0;
  };
  const envmap::SceneGraph& scene_;
  const std::vector<envmap::Mirror>& mirrors_;
  std::vector<Row> rows_;
};

}  // namespace tools

// What --mirror says, and the files of mirrors' maps.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "envmap/offscreen/view.h"
#include "envmap/scene/scene.h"

namespace tools {

// Projections of mirrors' maps.
inline constexpr std::string_view map_names[] = {"sphere", "paraboloid", "cube"};

// NODE, NODE:PROJECTION or NODE:off. @throws UsageError
envmap::MirrorWish mirror_wish(const envmap::Scene& scene, const std::string& text);

// FOLDER/NODE.exr for each; names are told apart, and what would end them is replaced. @throws UsageError where there
// is no such folder.
std::vector<std::string> map_files(const std::string& folder, const envmap::Scene& scene,
                                   const std::vector<int>& nodes);

// Of a frame: NODE.0001.exr.
std::vector<std::string> numbered(std::vector<std::string> files, int frame);

}  // namespace tools

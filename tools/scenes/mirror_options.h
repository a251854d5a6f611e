// Which nodes are mirrors, and the files of their maps.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "envmap/render/mirrors.h"

namespace tools {

// Projections of mirrors' maps.
inline constexpr std::string_view map_names[] = {"sphere", "paraboloid", "cube"};

// Those that their material makes one, but for the wishes: NODE, NODE:PROJECTION or NODE:off. @param maps of those
// whose projection is not wished for. @throws UsageError
std::vector<envmap::Mirror> mirrors_of(const envmap::Scene& scene, const std::vector<std::string>& wishes,
                                       envmap::Projection maps);

// FOLDER/NODE.exr for each; names are told apart, and what would end them is replaced. @throws UsageError where there
// is no such folder.
std::vector<std::string> map_files(const std::string& folder, const envmap::Scene& scene,
                                   const std::vector<int>& nodes);

// Of a frame: NODE.0001.exr.
std::vector<std::string> numbered(std::vector<std::string> files, int frame);

}  // namespace tools

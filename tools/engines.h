// What engines load: one row for each.
#pragma once

#include <span>
#include <string_view>

#include "envmap/map/environment_map.h"

namespace tools {

/// A file of text beside the map, and what is in it.
struct TextFile {
  std::string_view name, text;
};

struct Engine {
  std::string_view name;     ///< As users type it.
  std::string_view title;    ///< As its makers write it.
  std::string_view version;  ///< What was read of it, and whether it was run.
  envmap::Frame frame;       ///< Of the map.
  std::string_view map;      ///< Its file.
  double largest;            ///< That the engine's loader keeps; 0: any.
  std::string_view turns;    ///< How the map's directions stand in the engine's world.
  std::string_view light;    ///< Who makes diffuse and rough light of it.
  TextFile text;             ///< What loads the map, or nothing.
  std::string_view steps;    ///< What to do with the folder.
};

/// All of them, by name.
std::span<const Engine> engines();

}  // namespace tools

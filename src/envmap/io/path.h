/// @file
/// `{face}` and `{level}` in file names.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

#include "envmap/map/layout.h"

namespace envmap {

inline constexpr std::string_view face_mark = "{face}", level_mark = "{level}";

inline bool has_face(const std::string& path) { return path.find(face_mark) != std::string::npos; }
inline bool has_level(const std::string& path) { return path.find(level_mark) != std::string::npos; }

/// The name of one face's file: px nx py ny pz nz for faces 0 to 5.
inline std::string face_path(std::string path, int face) {
  return path.replace(path.find(face_mark), face_mark.size(), cube_face_names[static_cast<std::size_t>(face)]);
}

/// The name of one level's file: its number, from 0; the path itself where it has no mark.
inline std::string level_path(std::string path, int level) {
  return has_level(path) ? path.replace(path.find(level_mark), level_mark.size(), std::to_string(level)) : path;
}

/// How many files of one level each there are, numbered from 0 without a gap.
inline int count_level_files(const std::string& path) {
  const auto there = [&](int level) {
    const std::string one = level_path(path, level);
    std::error_code unreadable;
    return std::filesystem::exists(has_face(one) ? face_path(one, 0) : one, unreadable);
  };
  int levels = 0;
  while (levels < 32 && there(levels)) ++levels;
  return levels;
}

}  // namespace envmap

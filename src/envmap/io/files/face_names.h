/// @file
/// `{face}`, `{half}` and `{level}` in file names.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/face_files.h"
#include "envmap/map/layout.h"

namespace envmap {

inline constexpr std::string_view face_mark = "{face}", half_mark = "{half}", level_mark = "{level}";
inline constexpr std::string_view half_names[] = {"front", "back"};

/// Whether it names paraboloids, a file for each half.
inline bool has_half(const std::string& path) {
  return path.find(half_mark) != std::string::npos && path.find(face_mark) == std::string::npos;
}
/// Whether it names a file for each face of a cube or a paraboloid.
inline bool has_face(const std::string& path) { return path.find(face_mark) != std::string::npos || has_half(path); }
inline Projection projection_of_faces(const std::string& path) {
  return has_half(path) ? Projection::paraboloid : Projection::cube;
}
inline bool has_level(const std::string& path) { return path.find(level_mark) != std::string::npos; }

/// The name of one face's file: as `files` has it for faces 0 to 5, front and back for halves.
inline std::string face_path(std::string path, int face, const FaceFiles& files) {
  const auto k = std::size_t(face);
  if (has_half(path)) return path.replace(path.find(half_mark), half_mark.size(), half_names[k]);
  return path.replace(path.find(face_mark), face_mark.size(), files[k].name);
}

/// The name of one level's file: its number, from 0; the path itself where it has no mark.
inline std::string level_path(std::string path, int level) {
  return has_level(path) ? path.replace(path.find(level_mark), level_mark.size(), std::to_string(level)) : path;
}

/// All files of a name with {face}, {half} and {level}, else the name. @param levels that there are.
inline std::vector<std::string> files_named(const std::string& path, int levels, const FaceFiles& files) {
  std::vector<std::string> all;
  for (int level = 0; level < (has_level(path) ? levels : 1); ++level) {
    const std::string one = level_path(path, level);
    if (!has_face(one)) all.push_back(one);
    for (int face = 0; has_face(one) && face < faces(projection_of_faces(one)); ++face)
      all.push_back(face_path(one, face, files));
  }
  return all;
}

/// @throws UsageError where faces are named that are not files of their own.
inline void check_faces(const std::string& path, const std::string& faces) {
  if (!faces.empty() && path.find(face_mark) == std::string::npos)
    throw UsageError(path, "is one file, and names of faces are for six: put {face} into the file name");
}

/// How many files of one level each there are, numbered from 0 without a gap.
inline int count_level_files(const std::string& path, const FaceFiles& files) {
  const auto there = [&](int level) {
    const std::string one = level_path(path, level);
    std::error_code unreadable;
    return std::filesystem::exists(has_face(one) ? face_path(one, 0, files) : one, unreadable);
  };
  int levels = 0;
  while (levels < 32 && there(levels)) ++levels;
  return levels;
}

}  // namespace envmap

/// @file
/// `{face}` in file names.
#pragma once

#include <string>

#include "envmap/map/layout.h"

namespace envmap {

inline constexpr std::string_view face_mark = "{face}";

inline bool has_face(const std::string& path) { return path.find(face_mark) != std::string::npos; }

/// The name of one face's file: px nx py ny pz nz for faces 0 to 5.
inline std::string face_path(std::string path, int face) {
  return path.replace(path.find(face_mark), face_mark.size(), cube_face_names[static_cast<std::size_t>(face)]);
}

}  // namespace envmap

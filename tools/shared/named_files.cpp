#include "shared/named_files.h"

#include "envmap/io/path.h"

namespace tools {

using namespace envmap;

std::vector<std::string> files_of(const std::string& path, int levels, const std::string& faces) {
  std::vector<std::string> all;
  if (path.empty() || path == "-") return all;
  const FaceFiles names = face_files(faces);
  const int count = has_face(path) ? envmap::faces(projection_of_faces(path)) : 1;
  for (int level = 0; level < (has_level(path) ? levels : 1); ++level)
    for (int face = 0; face < count; ++face) {
      const std::string one = level_path(path, level);
      all.push_back(has_face(one) ? face_path(one, face, names) : one);
    }
  return all;
}

}  // namespace tools

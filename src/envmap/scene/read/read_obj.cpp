#include "envmap/scene/read/read_obj.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <unordered_map>
#include <utility>

#include "envmap/base/error.h"
#include "envmap/io/scene_folder.h"
#include "envmap/scene/mesh.h"
#include "envmap/scene/read/obj_document.h"
#include "envmap/scene/read/read_mtl.h"
#include "envmap/scene/read/read_texture.h"
#include "envmap/scene/read/triangulate.h"

namespace envmap {
namespace {

namespace fs = std::filesystem;
using Corner = ObjDocument::Corner;
using Face = ObjDocument::Face;

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// ---- materials ------------------------------------------------------------------------------------------------------

// A material of a library, and the folder of that, which its textures are named from.
struct Listed {
  MtlMaterial material;
  fs::path folder;
};

struct Materials {
  const SceneFolder& folder;
  Scene& scene;
  std::uint64_t pixels_left;
  bool allow_missing;
  bool lacks_library = false;  // It has been said that materials are white.
  std::map<std::string, Listed> listed = {};
  std::map<std::pair<fs::path, bool>, int> textures = {};  // By place and whether they are clamped.
};

// An absolute name is of another computer: the file is looked for beside the scene, where people put it.
std::string beside(Materials& m, const std::string& name) {
  const bool has_drive = name.size() > 2 && name[1] == ':' && name[2] == '/';
  if (!has_drive && !name.starts_with('/')) return name;
  const std::string plain = name.substr(name.rfind('/') + 1);
  note_once(m.scene.remarks,
            fmt::format("'{}' is an absolute path, which is not followed: '{}' beside the scene is taken", name,
                        plain));
  return plain;
}

// @return whether there is such a file.
bool read_library(Materials& m, std::string name) {
  std::ranges::replace(name, '\\', '/');
  name = beside(m, name);
  try {
    const fs::path path = m.folder.file(name);
    std::error_code error;
    if (!fs::exists(path, error)) return false;
    for (auto& [key, material] : read_mtl(text_of(file_bytes(path))))
      m.listed.try_emplace(key, Listed{std::move(material), fs::path(name).parent_path()});
    m.scene.files.push_back(path.string());
    return true;
  } catch (const InputError& e) {
    throw InputError(fmt::format("'{}': {}", name, e.what()));
  }
}

// A line is one name that may hold spaces, or several.
void read_libraries(Materials& m, const std::string& line) {
  const bool are_absolute = line.find(" /") != line.npos;
  if (line.empty() || (!are_absolute && read_library(m, line))) return;
  for (std::size_t begin = 0; begin < line.size();) {
    const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
    const std::string name = line.substr(begin, end - begin);
    begin = end + 1;
    if (name.empty() || read_library(m, name)) continue;
    m.scene.remarks.push_back(fmt::format("'{}' is missing: its materials are white", name));
    m.lacks_library = true;
  }
}

int texture(Materials& m, const MtlMap& map, const fs::path& library_folder) {
  if (map.name.empty()) return -1;
  const auto read = [&](const auto& action) {
    try {
      return action();
    } catch (const MissingFile&) {
      throw MissingFile(
          fmt::format("names the texture '{}', which is missing: put it into the scene's folder", map.name));
    } catch (const InputError& e) {
      throw InputError(fmt::format("names the texture '{}': {}", map.name, e.what()));
    }
  };
  const std::string name = beside(m, map.name);
  const fs::path below = name == map.name ? library_folder : fs::path();
  const fs::path path = read([&] { return m.folder.file(name, below); });
  const auto [found, first] = m.textures.try_emplace({path, map.clamp}, int(m.scene.textures.size()));
  if (!first) return found->second;
  std::vector<std::byte> bytes;
  try {
    bytes = read([&] { return file_bytes(path); });
  } catch (const MissingFile& e) {
    if (!m.allow_missing) throw;
    note_once(m.scene.remarks, fmt::format("a material {}; its surfaces have no texture", e.what()));
    return found->second = -1;
  }
  Texture made =
      decode_colours(map.name, {text_of(bytes).begin(), text_of(bytes).end()}, m.pixels_left, m.scene.unsupported);
  if (map.clamp) made.wrap_u = made.wrap_v = Texture::Wrap::clamp;
  m.scene.textures.push_back(std::move(made));
  m.scene.files.push_back(path.string());
  return found->second;
}

Material white(const std::string& name) { return {.name = name, .ior = 1, .double_sided = true}; }

Material material(Materials& m, const std::string& name) {
  const auto found = m.listed.find(name);
  if (found == m.listed.end()) return white(name);
  const Listed& listed = found->second;
  Material made = listed.material.material;
  made.base_colour_texture = texture(m, listed.material.colour, listed.folder);
  made.emissive_texture = texture(m, listed.material.emission, listed.folder);
  for (const std::string& what : listed.material.unsupported) note_once(m.scene.unsupported, what);
  return made;
}

// Those that faces use, in the order of their names in the document, then a white one where faces have none.
void read_materials(const ObjDocument& d, const SceneFolder& folder, std::uint64_t max_pixels, bool allow_missing,
                    Scene& scene) {
  Materials m{folder, scene, max_pixels, allow_missing};
  for (const std::string& line : d.libraries) read_libraries(m, line);
  for (const std::string& name : d.materials) {
    if (!m.listed.contains(name) && !std::exchange(m.lacks_library, true))
      scene.remarks.push_back(fmt::format("no .mtl defines the material '{}': it is white", name));
    scene.materials.push_back(material(m, name));
  }
  scene.materials.push_back(white(""));
}

// ---- faces ----------------------------------------------------------------------------------------------------------

std::vector<Direction> corners_of(const ObjDocument& d, const Face& face) {
  std::vector<Direction> made;
  for (const Corner& c : std::span(d.corners).subspan(face.first, std::size_t(face.count)))
    made.push_back(d.positions[c.position]);
  return made;
}

// Where two corners coincide there is none: it counts as a right angle.
double angle_at(const Direction& before, const Direction& after) {
  if (before == Direction(0) || after == Direction(0)) return 0.5 * pi;
  return angle_between(before, after);
}

// Normals for the corners that have none.
void add_normals(ObjDocument& d) {
  std::map<std::pair<int, int>, int> smooth;  // By position and smoothing group.
  for (const Face& face : d.faces) {
    const auto corners = std::span(d.corners).subspan(face.first, std::size_t(face.count));
    if (std::ranges::none_of(corners, [](const Corner& c) { return c.normal < 0; })) continue;
    const std::vector<Direction> at = corners_of(d, face);
    const Direction normal = unit(area_vector(at));
    const int flat = int(d.normals.size());
    if (face.smoothing == 0) d.normals.push_back(normal);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      if (corners[k].normal >= 0) continue;
      if (face.smoothing == 0) {
        corners[k].normal = flat;
        continue;
      }
      const auto [found, first] = smooth.try_emplace({corners[k].position, face.smoothing}, int(d.normals.size()));
      if (first) d.normals.emplace_back(0);
      const Direction before = unit(at[(k + at.size() - 1) % at.size()] - at[k]),
                      after = unit(at[(k + 1) % at.size()] - at[k]);
      d.normals[found->second] += normal * angle_at(before, after);
      corners[k].normal = found->second;
    }
  }
}

struct CornerHash {
  std::size_t operator()(const Corner& c) const {
    std::size_t hash = 0;
    for (const int index : {c.position, c.coordinate, c.normal})
      hash = (hash ^ std::size_t(index)) * 0x9e3779b97f4a7c15ULL;  // 2^64 / golden ratio (Knuth, 6.4).
    return hash ^ hash >> 32;
  }
};

// A mesh in the making: corners that are alike are one vertex.
struct Part {
  Mesh mesh = {};
  std::unordered_map<Corner, std::uint32_t, CornerHash> vertices = {};
};

std::uint32_t vertex(const ObjDocument& d, Part& part, const Corner& c) {
  const auto number = std::uint32_t(part.mesh.positions.size());
  const auto [found, first] = part.vertices.try_emplace(c, number);
  if (!first) return found->second;
  part.mesh.positions.emplace_back(d.positions[c.position]);
  part.mesh.normals.emplace_back(d.normals[c.normal]);
  const Vec2<float> t = c.coordinate < 0 ? Vec2<float>(0, 1) : d.coordinates[c.coordinate];
  part.mesh.coordinates.emplace_back(t.x, 1 - t.y);  // Down from the upper edge, as in glTF.
  return number;
}

void add_face(const ObjDocument& d, const Face& face, Part& part) {
  const std::span corners = std::span(d.corners).subspan(face.first, std::size_t(face.count));
  try {
    for (const auto& triangle : triangulate(corners_of(d, face)))
      for (const std::uint32_t corner : triangle) part.mesh.indices.push_back(vertex(d, part, corners[corner]));
  } catch (const InputError& e) {
    throw InputError(fmt::format("line {}: {}", face.line, e.what()));
  }
}

// A node for each group with faces, a mesh for each of its materials.
void read_faces(const ObjDocument& d, Scene& scene) {
  std::map<std::pair<int, int>, Part> parts;
  for (const Face& face : d.faces) add_face(d, face, parts[{face.group, face.material}]);
  int last = -2;
  for (auto& [place, part] : parts) {
    const auto [group, material] = place;
    if (group != last) scene.nodes.push_back({.name = group < 0 ? "" : d.groups[group]});
    last = group;
    part.mesh.material = material < 0 ? int(scene.materials.size()) - 1 : material;
    complete(part.mesh);
    scene.nodes.back().meshes.push_back(int(scene.meshes.size()));
    scene.meshes.push_back(std::move(part.mesh));
  }
}

}  // namespace

Scene read_obj(std::span<const std::byte> file, const SceneFolder& folder, std::uint64_t max_pixels,
               bool allow_missing) {
  ObjDocument document = read_obj_text(text_of(file));
  Scene scene;
  for (const std::string& what : document.unsupported) note_once(scene.unsupported, what);
  read_materials(document, folder, max_pixels, allow_missing, scene);
  add_normals(document);
  read_faces(document, scene);
  return scene;
}

}  // namespace envmap

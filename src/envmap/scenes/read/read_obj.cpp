#include "envmap/scenes/read/read_obj.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <unordered_map>
#include <utility>

#include "envmap/base/error.h"
#include "envmap/io/files/scene_folder.h"
#include "envmap/scenes/read/read_mtl.h"
#include "envmap/scenes/read/read_texture.h"
#include "envmap/scenes/read/text_lines.h"
#include "envmap/scenes/read/triangulate.h"
#include "envmap/scenes/scene/mesh.h"

namespace envmap {
namespace {

// Names get numbers in the order of their coming.
struct Names {
  std::vector<std::string>& list;
  std::map<std::string, int> numbers = {};

  int operator[](const std::string& name) {
    const auto [found, first] = numbers.try_emplace(name, int(list.size()));
    if (first) list.push_back(name);
    return found->second;
  }
};

struct Reader {
  ObjDocument document = {};
  Names groups{document.groups}, materials{document.materials};
  ObjDocument::Face now = {};  // What the next face belongs to.

  void note_unsupported(const char* what) { note_once(document.unsupported, what); }
};

Direction vector(Words& words) {
  const double x = words.number(), y = words.number(), z = words.number();
  return {x, y, z};
}

Vec2<float> coordinate(Words& words) {
  const float u = words.number(), v = words.number(0);
  return {u, v};
}

// A vertex may have a weight, which only free-form surfaces use, or a colour.
void read_position(Reader& r, Words& words) {
  r.document.positions.push_back(vector(words));
  int more = 0;
  for (; words.more(); ++more) words.number();
  if (more >= 3) r.note_unsupported("colours of vertices");
}

// `index`, from 1, or backwards from the last: what is counted may come later in the file, so it is checked at its end.
int index(std::string_view text, std::size_t there, const Words& words) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const long place = value > 0 ? value - 1L : static_cast<long>(there) + value;
  if (error != std::errc() || end != text.data() + text.size() || value == 0 || place < 0)
    words.fail(quoted(text) + " is no index of a vertex");
  return int(place);
}

// v, v/vt, v//vn or v/vt/vn.
ObjDocument::Corner corner(const ObjDocument& d, std::string_view text, const Words& words) {
  ObjDocument::Corner made;
  const auto next = [&] {
    const std::string_view part = text.substr(0, text.find('/'));
    text.remove_prefix(std::min(part.size() + 1, text.size()));
    return part;
  };
  made.position = index(next(), d.positions.size(), words);
  if (const auto part = next(); !part.empty()) made.coordinate = index(part, d.coordinates.size(), words);
  if (const auto part = next(); !part.empty()) made.normal = index(part, d.normals.size(), words);
  if (!text.empty()) words.fail("a corner has more than three indices");
  return made;
}

void read_face(Reader& r, Words& words, int line) {
  ObjDocument& d = r.document;
  ObjDocument::Face face = r.now;
  face.first = d.corners.size();
  while (words.more()) d.corners.push_back(corner(d, words.word(), words));
  if (d.corners.size() > max_corners)
    words.fail(fmt::format("over {} million corners of faces", max_corners / 1000000));
  face.count = int(d.corners.size() - face.first);
  face.line = line;
  if (face.count == 0) words.fail("a face has no corners");
  if (face.count >= 3) return d.faces.push_back(face);
  d.corners.resize(face.first);
  r.note_unsupported("points and lines");
}

int smoothing(Words& words) {
  const std::string_view group = words.word();
  if (group.empty() || group == "off") return 0;
  int number = 0;
  const auto [end, error] = std::from_chars(group.data(), group.data() + group.size(), number);
  if (error != std::errc() || end != group.data() + group.size() || number < 0)
    words.fail(quoted(group) + " is no smoothing group");
  return number;
}

void read_statement(Reader& r, std::string_view key, Words& words, int line) {
  // Of surfaces and curves that are not polygons, and what only other programs obey.
  constexpr std::string_view free_form[] = {"curv", "curv2", "surf"};
  constexpr std::string_view passed_over[] = {"vp",       "cstype",     "deg",      "bmat",  "step",  "parm",
                                              "trim",     "hole",       "scrv",     "sp",    "end",   "con",
                                              "mg",       "bevel",      "lod",      "ctech", "stech", "c_interp",
                                              "d_interp", "shadow_obj", "trace_obj"};
  ObjDocument& d = r.document;
  if (key == "v")
    read_position(r, words);
  else if (key == "vt")
    d.coordinates.push_back(coordinate(words));
  else if (key == "vn")
    d.normals.push_back(vector(words));
  else if (key == "f" || key == "fo")
    read_face(r, words, line);
  else if (key == "g" || key == "o")
    r.now.group = r.groups[words.name()];
  else if (key == "s")
    r.now.smoothing = smoothing(words);
  else if (key == "usemtl")
    r.now.material = r.materials[words.name()];
  else if (key == "mtllib")
    d.libraries.push_back(words.name());
  else if (key == "l" || key == "p")
    r.note_unsupported("points and lines");
  else if (std::ranges::find(free_form, key) != std::end(free_form))
    r.note_unsupported("free-form curves and surfaces");
  else if (key == "usemap" || key == "maplib")
    r.note_unsupported("texture maps without a material");
  else if (std::ranges::find(passed_over, key) == std::end(passed_over))
    words.fail(quoted(key) + " is no statement of OBJ");
}

void check_indices(const ObjDocument& d) {
  for (const ObjDocument::Face& face : d.faces)
    for (std::size_t k = face.first; k < face.first + std::size_t(face.count); ++k) {
      const auto check = [&](int index, std::size_t count, const char* what) {
        if (index >= int(count))
          throw InputError(fmt::format("line {}: names {} {}, but there are {}", face.line, what, index + 1L, count));
      };
      check(d.corners[k].position, d.positions.size(), "vertex");
      check(d.corners[k].coordinate, d.coordinates.size(), "texture coordinate");
      check(d.corners[k].normal, d.normals.size(), "normal");
    }
}

}  // namespace

ObjDocument read_obj_text(std::string_view text) {
  check_text(text);
  Reader r;
  for (TextLines lines(text); lines.next();) {
    Words words(lines);
    if (const std::string_view key = words.word(); !key.empty()) read_statement(r, key, words, lines.number());
    if (std::max({r.document.positions.size(), r.document.normals.size(), r.document.coordinates.size()}) > max_corners)
      words.fail(fmt::format("over {} million vertices", max_corners / 1000000));
  }
  check_indices(r.document);
  return std::move(r.document);
}

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
  SceneGraph& scene;
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
                    SceneGraph& scene) {
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
void read_faces(const ObjDocument& d, SceneGraph& scene) {
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

SceneGraph read_obj(std::span<const std::byte> file, const SceneFolder& folder, std::uint64_t max_pixels,
                    bool allow_missing) {
  ObjDocument document = read_obj_text(text_of(file));
  SceneGraph scene;
  for (const std::string& what : document.unsupported) note_once(scene.unsupported, what);
  read_materials(document, folder, max_pixels, allow_missing, scene);
  add_normals(document);
  read_faces(document, scene);
  return scene;
}

}  // namespace envmap

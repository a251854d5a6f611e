#include "envmap/io/face_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <utility>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/base/words.h"
#include "envmap/map/layout.h"

namespace envmap {
namespace {

struct TurnWord {
  std::string_view word;
  Orientation stored;
};
constexpr TurnWord turn_words[] = {
    {"90", Orientation::left_bottom},         {"180", Orientation::bottom_right},
    {"270", Orientation::right_top},          {"mirror", Orientation::top_right},
    {"mirror:90", Orientation::right_bottom}, {"mirror:180", Orientation::bottom_left},
    {"mirror:270", Orientation::left_top},
};

// Sources, by row. The axes of a program's world are those of engines.cpp, unless stated.
// babylon: cubeTexture.ts (extensions _px ... _nz, the faces of WebGL). Its world has our X negated.
// camera: the pictures of a camera that looks along -Z, is turned right and left, up and down: by definition. Unreal
//   Wiki's page TerraGen has these headings and pitches: 0, 90 "looking right", 180, 270, then up 90 and down -90.
// gl: OpenGL 4.6, table 8.19; Vulkan and Direct3D have the same faces.
// quake: id Software's Quake-2, ref_gl/gl_warp.c: suf, skytexorder, st_to_vec, MakeSkyVec; Quake-III-Arena, tr_sky.c.
//   Its world is right-handed with Z up; our +X is its +X, our -Z its +Y, as where Blender reads a glTF file.
// three: backgroundCube.glsl.js, flipEnvMap * worldDirection.x with flipEnvMap = -1: cubes of six images are looked up
//   with X negated.
// unity: the shader Skybox/6 Sided names Left [+X], Right [-X]; SkyBoxGenerator of the Unify wiki renders these
//   textures by cameras whose Euler angles are (0,90,0), (0,-90,0), up (-90,0,0), down (90,0,0).
// unreal: docs.unrealengine.com 4.26, "Creating Cubemaps": +X turned 90 degrees counterclockwise, -X 90 clockwise, +Y
//   180, -Y not; +Z and -Z with the side next to +Y at the top. These are Direct3D's faces in Unreal's world.
// Not here: Source. VTFLib's VTFFormat.h has Quake's axes for its rt lf bk ft up dn; how up and dn lie was not found.
constexpr FaceConvention conventions[] = {
    {"babylon", "nx,px,py:180,ny:180,pz,nz", "Babylon.js, CubeTexture of six files"},
    {"camera", "right,left,up,down,back,front", "a camera that looks along -Z, turned right, left, up and down"},
    {"gl", "px:mirror,nx:mirror,py:mirror:180,ny:mirror:180,pz:mirror,nz:mirror",
     "OpenGL, Vulkan, Direct3D: seen from outside"},
    {"quake", "rt,lf,up:90,dn:270,ft,bk", "skies of Quake II and III"},
    {"three", "nx,px,py:180,ny:180,pz,nz", "three.js, CubeTextureLoader"},
    {"unity", "right,left,up:180,down:180,front,back", "Unity, shader Skybox/6 Sided"},
    {"unreal", "px:270,nx:90,pz,nz:180,py:180,ny", "Unreal Engine, faces of a cube before import"},
};

// @param part NAME or NAME:TURN.
FaceFile face_file(std::string_view text, std::string_view part) {
  const auto colon = part.find(':');
  FaceFile file{std::string(part.substr(0, colon))};
  if (file.name.empty()) throw UsageError(fmt::format("faces {}: a face has no name", text));
  if (colon == part.npos) return file;
  const std::string_view turn = part.substr(colon + 1);
  const auto* const found = std::ranges::find(turn_words, turn, &TurnWord::word);
  if (found == std::end(turn_words))
    throw UsageError(fmt::format("faces {}: '{}' is none of mirror, 90, 180, 270, mirror:90, mirror:180 and mirror:270",
                                 text, turn));
  file.stored = found->stored;
  return file;
}

FaceFiles listed(std::string_view text, std::string_view list) {
  const std::vector<std::string> parts = split(list, ',');
  FaceFiles files;
  if (parts.size() != files.size())
    throw UsageError(
        fmt::format("faces {}: {} names, and a cube has six faces: +X,-X,+Y,-Y,+Z,-Z", text, parts.size()));
  for (std::size_t k = 0; k < files.size(); ++k) {
    files[k] = face_file(text, parts[k]);
    if (std::find_if(files.begin(), files.begin() + std::ptrdiff_t(k),
                     [&](const FaceFile& f) { return f.name == files[k].name; }) != files.begin() + std::ptrdiff_t(k))
      throw UsageError(fmt::format("faces {}: {} is named twice", text, files[k].name));
  }
  return files;
}

const FaceConvention* find_convention(std::string_view name) {
  const auto* const found = std::ranges::find(conventions, name, &FaceConvention::name);
  return found == std::end(conventions) ? nullptr : found;
}

}  // namespace

std::span<const FaceConvention> face_conventions() { return conventions; }

std::string_view convention_of(std::string_view text) {
  const FaceConvention* const c = find_convention(text.substr(0, text.find(':')));
  return c ? c->name : std::string_view();
}

FaceFiles face_files(std::string_view text) {
  FaceFiles files;
  if (text.empty()) {
    for (std::size_t k = 0; k < files.size(); ++k) files[k].name = cube_face_names[k];
    return files;
  }
  const FaceConvention* const convention = find_convention(convention_of(text));
  if (!convention && text.find(',') == text.npos) {
    std::vector<std::string_view> names;
    for (const FaceConvention& c : conventions) names.push_back(c.name);
    throw UsageError(
        fmt::format("faces {}: is none of {}, nor six names with commas between them", text, fmt::join(names, ", ")));
  }
  if (!convention) return listed(text, text);
  files = listed(text, convention->files);
  if (text == convention->name) return files;
  const FaceFiles named = listed(text, text.substr(convention->name.size() + 1));
  for (std::size_t k = 0; k < files.size(); ++k) {
    if (named[k].stored != Orientation::upright)
      throw UsageError(fmt::format("faces {}: {} says how pictures lie: remove the turn of {}", text, convention->name,
                                   named[k].name));
    files[k].name = named[k].name;
  }
  return files;
}

namespace {

// Of "px", "PX" or "+X".
std::size_t face_named(std::string_view text, std::string_view name) {
  std::string plain(name);
  std::ranges::transform(plain, plain.begin(), [](unsigned char c) { return std::tolower(c); });
  if (plain.size() == 2 && (plain[0] == '+' || plain[0] == '-')) plain[0] = plain[0] == '+' ? 'p' : 'n';
  const auto* const found = std::ranges::find(cube_face_names, plain);
  if (found == std::end(cube_face_names))
    throw UsageError(fmt::format("faces {}: '{}' is none of {}: one image holds faces in the order of these names",
                                 text, name, fmt::join(cube_face_names, ", ")));
  return std::size_t(found - cube_face_names);
}

}  // namespace

std::array<FaceCell, 6> face_cells(std::string_view text) {
  const FaceFiles files = face_files(text);
  const std::string_view convention = convention_of(text);
  std::array<FaceCell, 6> cells;
  std::array<bool, 6> there = {};
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const std::size_t face = convention == text ? k : face_named(text, files[k].name);
    cells[k] = {face, convention.empty() ? files[k].stored : files[face].stored};
    if (std::exchange(there[face], true))
      throw UsageError(fmt::format("faces {}: {} is named twice", text, cube_face_names[face]));
  }
  return cells;
}

}  // namespace envmap

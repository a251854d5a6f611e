// The texts of `bake --for glsl` and `hlsl`, compiled and run as they stand in the folder, against the projections of
// the library, closed forms and integrals. HLSL runs as GLSL that spirv-cross makes of it, where that is installed.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "drawing.h"
#include "envmap/engine/bake.h"
#include "envmap/io/read.h"
#include "envmap/io/write_distances.h"
#include "envmap/map/layout.h"
#include "envmap/operate/generate.h"
#include "envmap/scenes/read/read_scene.h"
#include "envmap/scenes/render/gl.h"
#include "envmap/scenes/render/rays/raycast.h"

namespace lookup_shaders_test {
namespace {

using namespace envmap;
namespace fs = std::filesystem;

constexpr std::string_view glsl_main = R"(
#define SPECULAR specular
#define BRDF brdf
layout(local_size_x = 1) in;
layout(binding = 0) uniform samplerCube specular;
layout(binding = 1) uniform sampler2D brdf;
layout(std430, binding = 0) buffer In { vec4 vectors[]; };
layout(std430, binding = 1) buffer Out { vec4 found[]; };
layout(std430, binding = 2) buffer Colours { vec4 colours[]; };
void main() {
  vec3 d = vectors[gl_GlobalInvocationID.x].xyz;
  float w = vectors[gl_GlobalInvocationID.x].w;
  vec3 c[9];
  for (int k = 0; k < 9; ++k) c[k] = colours[k].xyz;
  found[gl_GlobalInvocationID.x] = )";
constexpr std::string_view hlsl_main = R"(
#define vec3 float3
#define vec4 float4
#define SPECULAR specular, specular_sampler
#define BRDF brdf, brdf_sampler
StructuredBuffer<float4> vectors : register(t0);
RWStructuredBuffer<float4> found : register(u1);
StructuredBuffer<float4> colours : register(t2);
TextureCube specular : register(t3);
Texture2D brdf : register(t4);
SamplerState specular_sampler : register(s5), brdf_sampler : register(s6);
[numthreads(1, 1, 1)] void main(uint3 id : SV_DispatchThreadID) {
  float3 d = vectors[id.x].xyz;
  float w = vectors[id.x].w;
  float3 c[9];
  for (int k = 0; k < 9; ++k) c[k] = colours[k].xyz;
  found[id.x] = )";

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

template <class T>
T value_at(const std::string& bytes, std::size_t offset) {
  T value{};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

// RGB = (d + 1) / 2, baked with a first level of `size`.
struct Folders {
  fs::path path;

  Folders(int size, std::initializer_list<const char*> languages) {
    std::string name = (fs::temp_directory_path() / "envmap-lookups-XXXXXX").string();
    path = ::mkdtemp(name.data());
    for (const char* language : languages)
      bake(generate(Directions(), Projection::cube, 64), engine_named(language), (path / language).string(),
           {.chain_size = size});
  }
  Folders(const Folders&) = delete;
  Folders& operator=(const Folders&) = delete;
  ~Folders() { fs::remove_all(path); }
};

std::vector<glm::vec4> random_directions(std::size_t count) {
  std::mt19937 random(7);
  std::normal_distribution<float> part;
  std::uniform_real_distribution<float> w;
  std::vector<glm::vec4> all;
  while (all.size() < count)
    all.emplace_back(glm::normalize(glm::vec3(part(random), part(random), part(random))), w(random));
  return all;
}

std::vector<Direction> directions_of(const std::vector<glm::vec4>& vectors) {
  std::vector<Direction> directions;
  for (const glm::vec4& v : vectors) directions.push_back(glm::normalize(Direction(v)));
  return directions;
}

// What envmap_lobe() looks up.
struct LobeLookup {
  glm::dvec3 axis;
  double roughness;
};

class Lookups : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (GetParam() == "hlsl" && std::system("which glslangValidator spirv-cross >/dev/null") != 0)
      GTEST_SKIP() << "needs glslangValidator and spirv-cross";
    drawing::context();
  }

  // What takes no time to bake, for texts and tables.
  [[nodiscard]] static const fs::path& folder() {
    static const Folders folders(32, {"glsl", "hlsl"});
    return folders.path;
  }

  // The text of the folder behind #version, and a main() that works out a vec4 of d and w.
  [[nodiscard]] static std::string source(const std::string& expression) {
    const std::string end = "vec4(" + expression + ");\n}\n";
    if (GetParam() == "glsl")
      return "#version 450 core\n" + contents(folder() / "glsl/envmap.glsl") + std::string(glsl_main) + end;
    const fs::path stem = folder() / "test";
    std::ofstream(stem.string() + ".hlsl") << contents(folder() / "hlsl/envmap.hlsl") << hlsl_main << end;
    const std::string command = fmt::format(
        "glslangValidator -D -V -S comp -e main {0}.hlsl -o {0}.spv >{0}.log && "
        "spirv-cross --version 450 {0}.spv --output {0}.glsl",
        stem.string());
    EXPECT_EQ(std::system(command.c_str()), 0) << contents(stem.string() + ".log");
    return contents(stem.string() + ".glsl");
  }

  [[nodiscard]] static std::vector<glm::vec4> evaluate(const std::string& expression, std::vector<glm::vec4> vectors,
                                                       const std::vector<glm::vec4>& colours = {}) {
    const std::string text = source(expression);
    const char* lines = text.c_str();
    const gl::Program program(glCreateShaderProgramv(GL_COMPUTE_SHADER, 1, &lines));
    std::array<char, 1000> log{};
    glGetProgramInfoLog(program, log.size(), nullptr, log.data());
    GLint linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    EXPECT_EQ(linked, GL_TRUE) << log.data();
    const gl::Buffer in = gl::make_buffer(vectors), out = gl::make_buffer(vectors, GL_DYNAMIC_STORAGE_BIT);
    const gl::Buffer third = gl::make_buffer(colours);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, in);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, out);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, third);
    glUseProgram(program);
    gl::set(program, "SPIRV_Cross_Combinedspecularspecular_sampler", 0);
    gl::set(program, "SPIRV_Cross_Combinedbrdfbrdf_sampler", 1);
    glDispatchCompute(GLuint(vectors.size()), 1, 1);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(out, 0, GLsizeiptr(vectors.size() * sizeof(glm::vec4)), vectors.data());
    gl::check("evaluating");
    return vectors;
  }

  // envmap_lobe() of a floor, its normal +Y. @param edge rides on the length of the vector.
  [[nodiscard]] static LobeLookup lobe_of(const glm::dvec3& v, double roughness, double edge) {
    const glm::vec4 found = evaluate("envmap_lobe(vec3(0.0, 1.0, 0.0), normalize(d), w, length(d) - 1.0)",
                                     {glm::vec4((1 + edge) * v, roughness)})[0];
    return {glm::normalize(glm::dvec3(found)), double(found.w)};
  }

  // A cube of half floats, as it stands in the KTX2 file: the level index begins at byte 80, base first.
  [[nodiscard]] static gl::Texture cube(const char* name) {
    static const Folders folders(256, {"glsl"});
    return cube_in(folders.path / "glsl" / name);
  }
  [[nodiscard]] static gl::Texture cube_in(const fs::path& path) {
    const std::string file = contents(path);
    const int size = value_at<int>(file, 20), levels = value_at<int>(file, 40);
    gl::Texture texture = gl::make_texture(GL_TEXTURE_CUBE_MAP);
    glTextureStorage2D(texture, levels, GL_RGBA16F, size, size);
    for (int k = 0; k < levels; ++k)
      glTextureSubImage3D(texture, k, 0, 0, 0, size >> k, size >> k, 6, GL_RGBA, GL_HALF_FLOAT,
                          file.data() + value_at<std::uint64_t>(file, 80 + 24 * std::size_t(k)));
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    gl::check("loading a cube");
    return texture;
  }

  // The split-sum table: its file is read as if it were an octahedral map.
  [[nodiscard]] static gl::Texture table() {
    const Source read_back =
        read((folder() / GetParam() / "brdf.exr").string(), {.projection = Projection::octahedral});
    const Level& level = read_back.map.base();
    gl::Texture texture = gl::make_texture(GL_TEXTURE_2D);
    glTextureStorage2D(texture, 1, GL_RGB32F, level.width(), level.height());
    for (int j = 0; j < level.height(); ++j)
      glTextureSubImage2D(texture, 0, 0, j, level.width(), 1, GL_RGB, GL_FLOAT, level.row(0, j).data());
    gl::interpolate(texture);
    return texture;
  }
};
INSTANTIATE_TEST_SUITE_P(All, Lookups, ::testing::Values("glsl", "hlsl"), [](const auto& p) { return p.param; });

struct Coordinates {
  Frame frame;
  std::string call;
};
const Coordinates all_coordinates[] = {
    {{Projection::latlong, Forward::plus_z}, "envmap_latlong(d, vec3(0.0, 0.0, 1.0)), 0.0, 0.0"},
    {{Projection::latlong, Forward::minus_z}, "envmap_latlong(d, vec3(0.0, 0.0, -1.0)), 0.0, 0.0"},
    {{Projection::latlong, Forward::plus_x}, "envmap_latlong(d, vec3(1.0, 0.0, 0.0)), 0.0, 0.0"},
    {{Projection::latlong, Forward::minus_x}, "envmap_latlong(d, vec3(-1.0, 0.0, 0.0)), 0.0, 0.0"},
    {{Projection::angular, Forward::plus_z}, "envmap_angular(d, vec3(0.0, 0.0, 1.0)), 0.0, 0.0"},
    {{Projection::angular, Forward::minus_z}, "envmap_angular(d, vec3(0.0, 0.0, -1.0)), 0.0, 0.0"},
    {{Projection::angular, Forward::plus_x}, "envmap_angular(d, vec3(1.0, 0.0, 0.0)), 0.0, 0.0"},
    {{Projection::angular, Forward::minus_x}, "envmap_angular(d, vec3(-1.0, 0.0, 0.0)), 0.0, 0.0"},
    {Projection::cube, "envmap_cube(d), 0.0"},
    {Projection::sphere, "envmap_sphere(d), 0.0, 0.0"},
    {Projection::paraboloid, "envmap_paraboloid(d), 0.0"},
    {Projection::octahedral, "envmap_octahedral(d), 0.0, 0.0"},
    {Projection::equal_area, "envmap_equal_area(d), 0.0, 0.0"}};

TEST_P(Lookups, CoordinatesAreThoseOfTheLibrary) {
  const std::vector<glm::vec4> vectors = random_directions(4096);
  for (const Coordinates& each : all_coordinates) {
    SCOPED_TRACE(each.call);
    std::vector<Direction> in_image = directions_of(vectors);
    for (Direction& d : in_image) d = glm::transpose(image_to_world(each.frame.forward)) * d;
    std::vector<Location<double>> wanted(vectors.size());
    locate(each.frame.projection, in_image, wanted);
    const std::vector<glm::vec4> found = evaluate(each.call, vectors);
    double worst = 0;
    for (std::size_t k = 0; k < vectors.size(); ++k) {
      ASSERT_EQ(int(found[k].z), wanted[k].face) << k;
      worst = std::max({worst, std::abs(found[k].x - wanted[k].u), std::abs(found[k].y - wanted[k].v)});
    }
    EXPECT_LT(worst, 1e-5);
  }
  for (const Projection p : all_projections)
    EXPECT_TRUE(std::ranges::any_of(all_coordinates, [p](const Coordinates& c) { return c.frame.projection == p; }))
        << name(p);
}

// The same by the formulae of three.js (+X at the centre), of OpenGL's sphere map, and of Clarberg.
TEST_P(Lookups, CoordinatesAreThoseOfClosedForms) {
  const std::vector<glm::vec4> vectors = random_directions(1000);
  const std::vector<Direction> directions = directions_of(vectors);
  const auto three = evaluate("envmap_latlong(d, vec3(1.0, 0.0, 0.0)), 0.0, 0.0", vectors);
  const auto ball = evaluate("envmap_sphere(d), 0.0, 0.0", vectors);
  const auto square = evaluate("envmap_equal_area(d), 0.0, 0.0", vectors);
  for (std::size_t k = 0; k < vectors.size(); ++k) {
    const auto [x, y, z] = std::array{directions[k].x, directions[k].y, directions[k].z};
    EXPECT_NEAR(three[k].x, 0.5 + std::atan2(z, x) / (2 * pi), 1e-5);
    EXPECT_NEAR(three[k].y, 0.5 - std::asin(y) / pi, 1e-5);
    const double m = 2 * std::sqrt(x * x + y * y + (z + 1) * (z + 1));
    EXPECT_NEAR(ball[k].x, x / m + 0.5, 1e-5 * (1 + 1 / m));
    EXPECT_NEAR(ball[k].y, 0.5 - y / m, 1e-5 * (1 + 1 / m));
    const double r = std::sqrt(1 - std::abs(y)), b = r * std::atan2(std::abs(z), std::abs(x)) * 2 / pi;
    EXPECT_NEAR(square[k].x, 0.5 + 0.5 * std::copysign(y < 0 ? 1 - b : r - b, x), 1e-5);
    EXPECT_NEAR(square[k].y, 0.5 - 0.5 * std::copysign(y < 0 ? 1 - (r - b) : b, z), 1e-5);
  }
}

// Axes, where formulae have their poles and seams: finite, and in a place that holds the direction.
TEST_P(Lookups, AxesAreFound) {
  std::vector<glm::vec4> vectors;
  for (int k = 0; k < 6; ++k) {
    glm::vec4 axis(0);
    axis[k / 2] = k % 2 == 0 ? 1.F : -1.F;
    vectors.push_back(axis);
  }
  for (const Coordinates& each : all_coordinates) {
    const std::vector<glm::vec4> found = evaluate(each.call, vectors);
    for (std::size_t k = 0; k < vectors.size(); ++k) {
      const Point2 at(found[k].x, found[k].y);
      std::array<Direction, 1> there{};
      directions(each.frame.projection, int(found[k].z), std::span(&at, 1), there);
      const Direction world = image_to_world(each.frame.forward) * there[0];
      EXPECT_LT(glm::distance(world, Direction(vectors[k])), 1e-3) << each.call << " " << k;
    }
  }
}

TEST_P(Lookups, FacesLieInImagesAsTheLibraryPutsThem) {
  std::vector<glm::vec4> places;
  for (int face = 0; face < 6; ++face)
    for (const glm::vec2 at : {glm::vec2(0.1, 0.2), glm::vec2(0.75, 0.5), glm::vec2(1, 1), glm::vec2(0, 0)})
      places.emplace_back(at, face, 0);
  for (const auto& [layout, call] :
       {std::pair(Layout::column, "envmap_column(d)"), std::pair(Layout::row, "envmap_row(d)"),
        std::pair(Layout::grid3x2, "envmap_3x2(d)"), std::pair(Layout::cross, "envmap_cross(d)"),
        std::pair(Layout::vcross, "envmap_vcross(d)"), std::pair(Layout::pair, "envmap_pair(d)")}) {
    const Grid wanted = grid(layout);
    const std::vector<glm::vec4> found = evaluate(std::string(call) + ", 0.0, 0.0", places);
    for (std::size_t k = 0; k < places.size() && std::size_t(places[k].z) < wanted.slots.size(); ++k) {
      const Slot& slot = wanted.slots[std::size_t(places[k].z)];
      const glm::vec2 at = slot.turned ? 1.F - glm::vec2(places[k]) : glm::vec2(places[k]);
      EXPECT_NEAR(found[k].x, (float(slot.column) + at.x) / float(wanted.columns), 1e-6) << call << k;
      EXPECT_NEAR(found[k].y, (float(slot.row) + at.y) / float(wanted.rows), 1e-6) << call << k;
    }
  }
  const std::vector<glm::vec4> inside = evaluate("envmap_inset(d, 4.0), 0.0", places);
  EXPECT_EQ(inside[0], glm::vec4(0.125, places[0].y, 0, 0));
  EXPECT_EQ(inside[2], glm::vec4(0.875, 0.875, 0, 0));
}

// Where a ray from p meets the wall of a box: in the nearest of the planes ahead.
glm::dvec3 met_in_box(const glm::dvec3& p, const glm::dvec3& r, const glm::dvec3& low, const glm::dvec3& high) {
  double nearest = 1e30;
  for (int k = 0; k < 3; ++k)
    if (r[k] != 0) nearest = std::min(nearest, ((r[k] > 0 ? high[k] : low[k]) - p[k]) / r[k]);
  return p + nearest * r;
}

const glm::dvec3 box_low(-2, -1, -3), box_high(2, 1.2, 1);
const std::array<glm::dvec3, 4> places_in_box{glm::dvec3(0), {0.3, -0.2, 0.4}, {-1.5, 0.9, -2}, {1.9, 1.1, 0.9}};

std::vector<glm::vec4> constants(const glm::dvec3& p) {
  std::vector<glm::vec4> all(9);
  all[0] = glm::vec4(p, 0), all[1] = glm::vec4(box_low, 0), all[2] = glm::vec4(box_high, 0);
  return all;
}

TEST_P(Lookups, ABoxHasItsWallsWhereTheyAre) {
  std::vector<glm::vec4> rays = random_directions(500);
  for (int k = 0; k < 3; ++k)
    for (const float along : {-1.F, 1.F}) rays.emplace_back(0), rays.back()[k] = along;
  for (const glm::dvec3& p : places_in_box) {
    const auto found = evaluate("envmap_box(c[0], d, c[1], c[2]), 0.0", rays, constants(p));
    for (std::size_t k = 0; k < rays.size(); ++k)
      EXPECT_LT(glm::distance(glm::dvec3(found[k]),
                              glm::normalize(met_in_box(p, glm::dvec3(rays[k]), box_low, box_high))),
                1e-5)
          << k;
  }
}

// A cube of floats, in the order of GL's faces.
template <class Value>
gl::Texture cube_of(int size, const Value& value) {
  gl::Texture texture = gl::make_texture(GL_TEXTURE_CUBE_MAP);
  glTextureStorage2D(texture, 1, GL_R32F, size, size);
  for (int face = 0; face < 6; ++face) {
    std::vector<float> texels;
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i) {
        const double s = (2 * i + 1.0) / size - 1, t = (2 * j + 1.0) / size - 1;
        const glm::dvec3 all[] = {{1, -t, -s}, {-1, -t, s}, {s, 1, t}, {s, -1, -t}, {s, -t, 1}, {-s, -t, -1}};
        texels.push_back(float(value(glm::normalize(all[face]))));
      }
    glTextureSubImage3D(texture, 0, 0, 0, face, size, size, 1, GL_RED, GL_FLOAT, texels.data());
  }
  gl::interpolate(texture);
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  return texture;
}

// How far envmap_parallax() is off in the box, of each ray from p, the least first.
template <class Evaluate>
std::vector<double> parallax_errors(const glm::dvec3& p, const Evaluate& evaluate) {
  const std::vector<glm::vec4> rays = random_directions(4000);
  const auto found = evaluate("envmap_parallax(SPECULAR, c[0], d), 0.0", rays, constants(p));
  std::vector<double> off;
  for (std::size_t k = 0; k < rays.size(); ++k)
    off.push_back(
        glm::distance(glm::dvec3(found[k]), glm::normalize(met_in_box(p, glm::dvec3(rays[k]), box_low, box_high))));
  std::ranges::sort(off);
  return off;
}

TEST_P(Lookups, DistancesSayWhereRaysMeetTheWalls) {
  const gl::Texture room = cube_of(256, [](const glm::dvec3& d) {
    return 1 / glm::length(met_in_box(glm::dvec3(0), d, box_low, box_high));
  });
  glBindTextureUnit(0, room);
  for (const glm::dvec3& p : places_in_box) {
    const std::vector<double> off = parallax_errors(p, evaluate);
    EXPECT_LT(off[off.size() * 99 / 100], 0.12 * pi / 180) << p.x;
    EXPECT_LT(off.back(), pi / 180) << p.x;
  }
}

// What `render --distance` and `convert --channels 1/Z --depth half` write.
TEST_P(Lookups, RenderedDistancesSayWhereRaysMeetTheWalls) {
  const fs::path scene_file = folder() / "box.obj", distances = folder() / "box.exr", nearness = folder() / "near.ktx2";
  std::ofstream obj(scene_file);
  for (int k = 0; k < 8; ++k)
    obj << fmt::format("v {} {} {}\n", k & 1 ? box_high.x : box_low.x, k & 2 ? box_high.y : box_low.y,
                       k & 4 ? box_high.z : box_low.z);
  obj << "f 1 2 4 3\nf 5 6 8 7\nf 1 2 6 5\nf 3 4 8 7\nf 1 3 7 5\nf 2 4 8 6\n" << std::flush;
  const SceneGraph scene = read_scene(scene_file.string());
  const Drawn drawn = raycast({.scene = scene, .pose = pose(scene, 0)}, {.to = Projection::cube, .size = 256});
  write_with_distances(distances.string(), drawn.radiance, drawn.distances);
  write(nearness.string(), read(distances.string(), {.choice = {.channels = "1/Z"}}).map, {.depth = Depth::half});
  const gl::Texture room = cube_in(nearness);
  glBindTextureUnit(0, room);
  for (const glm::dvec3& p : places_in_box) {
    const std::vector<double> off = parallax_errors(p, evaluate);
    EXPECT_LT(off[off.size() * 99 / 100], 0.3 * pi / 180) << p.x;
  }
}

// 1 / distance is 0 where nothing is: above a floor 1 below the centre, rays go on to infinity or meet the floor.
TEST_P(Lookups, RaysThatMeetNothingKeepTheirDirection) {
  const gl::Texture floor = cube_of(256, [](const glm::dvec3& d) { return std::max(0.0, -d.y); });
  glBindTextureUnit(0, floor);
  const glm::dvec3 p(0.2, 0.5, -0.3);
  const std::vector<glm::vec4> rays = random_directions(2000);
  const auto found = evaluate("envmap_parallax(SPECULAR, c[0], d), 0.0", rays, constants(p));
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const glm::dvec3 r(rays[k]), met = r.y < 0 ? glm::normalize(p - (1 + p.y) / r.y * r) : r;
    EXPECT_LT(glm::distance(glm::dvec3(found[k]), met), 5e-3) << r.x << " " << r.y << " " << r.z;
  }
}

// Of L = (d + 1) / 2 the lobe about d leaves (a d + 1) / 2, where a is the mean of cos over the lobe: D at half the
// angle, times the cosine.
double mean_cosine(double roughness) {
  const double a2 = std::pow(roughness, 4);
  double sum = 0, weight = 0;
  constexpr int steps = 200000;
  for (int k = 0; k < steps; ++k) {
    const double angle = pi / 2 * std::pow((k + 0.5) / steps, 3), c = std::cos(angle), h = (1 + c) / 2;
    const double w = std::pow((k + 0.5) / steps, 2) * std::sin(angle) * c / std::pow(h * (a2 - 1) + 1, 2);
    sum += w * c, weight += w;
  }
  return sum / weight;
}

TEST_P(Lookups, LevelsHoldTheLobeOfTheirRoughness) {
  const gl::Texture specular = cube("specular.ktx2");
  glBindTextureUnit(0, specular);
  // The tolerances are what filters add: linear ones in faces of 8 x 8 texels at roughness 1, and between the last two
  // levels, where the mean of two lobes is not the lobe of the roughness between.
  for (const auto& [roughness, tolerance] :
       {std::pair(0.0, 5e-4), std::pair(0.05, 1e-3), std::pair(0.105573, 5e-4), std::pair(0.3, 4e-3),
        std::pair(0.45, 5e-3), std::pair(0.552786, 5e-3), std::pair(0.7, 0.015), std::pair(1.0, 8e-3)}) {
    std::vector<glm::vec4> vectors = random_directions(200);
    for (glm::vec4& v : vectors) v.w = float(roughness);
    const std::vector<glm::vec4> found = evaluate("envmap_prefiltered(SPECULAR, d, w), 0.0", vectors);
    const double a = roughness == 0 ? 1 : mean_cosine(roughness);
    double worst = 0;
    for (std::size_t k = 0; k < vectors.size(); ++k)
      for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(found[k][c] - 0.5 * (1 + a * vectors[k][c])));
    EXPECT_LT(worst, tolerance) << roughness;
  }
}

// Karis' integral over half vectors by D cos(n,h), with Smith's height-correlated G: steps of (1 - u)^(1/3), which lie
// densely where half vectors graze, and azimuths. Right to 1e-4.
glm::dvec2 split_sum(double n_v, double roughness) {
  const double a2 = std::pow(roughness, 4), sine = std::sqrt(1 - n_v * n_v);
  const auto lambda = [&](double c) { return 0.5 * (std::sqrt(1 + a2 * (1 - c * c) / (c * c)) - 1); };
  constexpr int steps = 500, azimuths = 300;
  glm::dvec2 sum(0);
  for (int i = 0; i < steps; ++i)
    for (int k = 0; k < azimuths; ++k) {
      const double t = (i + 0.5) / steps, rest = t * t * t, h = std::sqrt(rest / (1 + (a2 - 1) * (1 - rest)));
      const double v_h = sine * std::sqrt(1 - h * h) * std::cos(pi * (k + 0.5) / azimuths) + n_v * h;
      const double n_l = 2 * v_h * h - n_v;
      if (n_l <= 0) continue;
      const double value = 3 * t * t * v_h / (n_v * h * (1 + lambda(n_v) + lambda(n_l)));
      const double fresnel = std::pow(1 - v_h, 5);
      sum += glm::dvec2(1 - fresnel, fresnel) * (value / (steps * azimuths));
    }
  return sum;
}

TEST_P(Lookups, ScaleAndBiasAreTheSplitSum) {
  const gl::Texture brdf = table();
  glBindTextureUnit(1, brdf);
  std::vector<glm::vec4> vectors;
  for (const float n_v : {0.03F, 0.1F, 0.237F, 0.5F, 0.77F, 1.F})
    for (const float roughness : {0.1F, 0.23F, 0.5F, 0.71F, 1.F}) vectors.emplace_back(n_v, 0, 0, roughness);
  const std::vector<glm::vec4> found = evaluate("envmap_scale_bias(BRDF, d.x, w), 0.0, 0.0", vectors);
  for (std::size_t k = 0; k < vectors.size(); ++k) {
    const glm::dvec2 wanted = split_sum(double(vectors[k].x), double(vectors[k].w));
    // Roughness 1 lies half a texel beyond the centres of the last row.
    const double tolerance = vectors[k].w == 1 ? 5e-3 : 1e-3;
    EXPECT_NEAR(found[k].x, wanted.x, tolerance) << vectors[k].x << " " << vectors[k].w;
    EXPECT_NEAR(found[k].y, wanted.y, 1.5e-3) << vectors[k].x << " " << vectors[k].w;
  }
}

// A floor, its normal +Y, seen from d: the mirrored direction is d turned half round Y.
TEST_P(Lookups, SpecularLightIsTheProductOfBoth) {
  const gl::Texture specular = cube("specular.ktx2"), brdf = table();
  glBindTextureUnit(0, specular);
  glBindTextureUnit(1, brdf);
  std::vector<glm::vec4> vectors = random_directions(40);
  for (glm::vec4& v : vectors) v = {glm::normalize(glm::vec3(v.x, 0.2F + std::abs(v.y), v.z)), v.w};
  const glm::dvec3 f0(0.04, 0.5, 1);
  const auto found =
      evaluate("envmap_specular(SPECULAR, BRDF, vec3(0.0, 1.0, 0.0), d, w, vec3(0.04, 0.5, 1.0)), 0.0", vectors);
  for (std::size_t k = 0; k < vectors.size(); ++k) {
    const double roughness = double(vectors[k].w);
    const glm::dvec2 part = split_sum(double(vectors[k].y), roughness);
    const double edge = part.y / (0.51333 * part.x + part.y);
    const LobeLookup lobe = lobe_of(glm::dvec3(vectors[k]), roughness, edge);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(found[k][c], 0.5 * (1 + mean_cosine(lobe.roughness) * lobe.axis[c]) * (f0[c] * part.x + part.y),
                  0.015)
          << k << " " << roughness;
  }
}

// ---- the lobe at an angle, beside integrals -------------------------------------------------------------------------

// The reflection of a floor by GGX over the disc of a sun of radiance 1, and of a level's lobe over the same disc.
struct DiscOfSun {
  glm::dvec3 towards;
  double radius;

  template <class F>
  [[nodiscard]] double integral(const F& f) const {
    constexpr int rings = 50, turns = 100;
    const glm::dvec3 side = glm::normalize(glm::cross(towards, glm::dvec3(0.1, 0.2, 1))),
                     up = glm::cross(towards, side);
    double sum = 0;
    for (int i = 0; i < rings; ++i)
      for (int j = 0; j < turns; ++j) {
        const double polar = radius * (i + 0.5) / rings, turn = 2 * pi * (j + 0.5) / turns;
        sum += std::sin(polar) *
               f(std::cos(polar) * towards + std::sin(polar) * (std::cos(turn) * side + std::sin(turn) * up));
      }
    return sum * radius * 2 * pi / (rings * turns);
  }
  [[nodiscard]] double reflected(const glm::dvec3& v, double roughness, double f0) const {
    const double a2 = std::pow(roughness, 4);
    const auto lambda = [&](double c) { return 0.5 * (std::sqrt(1 + a2 * (1 / (c * c) - 1)) - 1); };
    return integral([&](const glm::dvec3& l) {
      if (l.y <= 0) return 0.0;
      const glm::dvec3 h = glm::normalize(l + v);
      const double d = a2 / (pi * std::pow(h.y * h.y * (a2 - 1) + 1, 2)), fresnel = std::pow(1 - glm::dot(v, h), 5);
      return (f0 + (1 - f0) * fresnel) * d / (1 + lambda(v.y) + lambda(l.y)) / (4 * v.y);
    });
  }
  [[nodiscard]] double of_level(const LobeLookup& lobe) const {
    const double a2 = std::pow(lobe.roughness, 4);
    const auto value = [&](double c) { return c > 0 ? c / std::pow(0.5 * (1 + c) * (a2 - 1) + 1, 2) : 0; };
    double whole = 0;
    constexpr int steps = 4000;
    for (int k = 0; k < steps; ++k) {
      const double part = (k + 0.5) / steps, angle = pi / 2 * part * part * part;
      whole += value(std::cos(angle)) * std::sin(angle) * 2 * pi * pi / 2 * 3 * part * part / steps;
    }
    return integral([&](const glm::dvec3& l) { return value(glm::dot(l, lobe.axis)); }) / whole;
  }
};

// The rms over suns that pass the mirrored direction, over the rms of the truth.
double error_of(const glm::dvec3& v, double roughness, double f0, double radius, const LobeLookup& lobe) {
  const glm::dvec2 part = split_sum(v.y, roughness);
  const glm::dvec3 r(-v.x, v.y, -v.z), across = glm::normalize(glm::cross(r, glm::dvec3(0, 1, 0)));
  const double step = std::max(0.75 * roughness * roughness, radius / 2);
  double off = 0, all = 0;
  for (int k = -4; k <= 4; ++k)
    for (const glm::dvec3& side : {across, glm::cross(across, r)}) {
      const DiscOfSun sun{std::cos(k * step) * r + std::sin(k * step) * side, radius};
      const double truth = sun.reflected(v, roughness, f0);
      off += std::pow((f0 * part.x + part.y) * sun.of_level(lobe) - truth, 2), all += truth * truth;
    }
  return std::sqrt(off / all);
}

TEST_P(Lookups, TheLobeIsNearerToTheIntegralThanTheMirroredDirection) {
  for (const double f0 : {1.0, 0.04}) {
    double before = 0, after = 0, excess = 0;
    for (const double degrees : {30.0, 60.0, 75.0, 85.0})
      for (const double roughness : {0.3, 0.5, 0.8, 1.0}) {
        const double view = degrees * pi / 180;
        const glm::dvec3 v(std::sin(view), std::cos(view), 0);
        const glm::dvec2 part = split_sum(v.y, roughness);
        const LobeLookup lobe = lobe_of(v, roughness, part.y / (f0 * part.x + part.y));
        for (const double sun : {5.0, 20.0}) {
          const double radius = sun * pi / 360;
          const double old = error_of(v, roughness, f0, radius, {{-v.x, v.y, 0}, roughness}),
                       now = error_of(v, roughness, f0, radius, lobe);
          before += old, after += now, excess = std::max(excess, now - old);
        }
      }
    EXPECT_LT(after, 0.75 * before) << f0;
    EXPECT_LT(excess, 0.35) << f0;
  }
}

TEST_P(Lookups, ASmoothSurfaceLooksUpItsMirroredDirection) {
  const LobeLookup lobe = lobe_of({0.6, 0.8, 0}, 0, 0.3);
  EXPECT_EQ(lobe.roughness, 0);
  EXPECT_LT(glm::distance(lobe.axis, glm::dvec3(-0.6, 0.8, 0)), 1e-6);
}

// Degrees 0, 1 and 2 of radiance are 1, 2/3 and 1/4 of it in the irradiance over pi (Ramamoorthi and Hanrahan 2001).
TEST_P(Lookups, IrradianceIsThatOfTheHarmonics) {
  const auto degree1 = [](const Direction& d) { return 0.3 * d.x - 0.2 * d.y + 0.1 * d.z; };
  const auto degree2 = [](const Direction& d) {
    return 0.2 * d.x * d.y - 0.1 * d.y * d.z + 0.15 * d.z * d.x + 0.05 * (3 * d.z * d.z - 1) +
           0.1 * (d.x * d.x - d.y * d.y);
  };
  EnvironmentMap probe = blank_map(Projection::cube, 64);
  std::array<Direction, 64> row{};
  for (int face = 0; face < 6; ++face)
    for (int j = 0; j < 64; ++j) {
      texel_directions(Projection::cube, 64, face, j, 0, row);
      for (int i = 0; i < 64; ++i)
        *probe.base().texel(face, i, j) =
            Colour(1 + degree1(row[std::size_t(i)]) + degree2(row[std::size_t(i)])) * Colour(1, 2, 0.5);
    }
  const fs::path path = folder() / ("sh_" + GetParam());
  bake(std::move(probe), engine_named(GetParam()), path.string(), {.quality = qualities[0]});
  std::istringstream numbers(contents(path / "irradiance.txt"));
  std::vector<glm::vec4> colours(9, glm::vec4(0));
  for (glm::vec4& c : colours) ASSERT_TRUE(numbers >> c.x >> c.y >> c.z);
  const std::vector<glm::vec4> vectors = random_directions(200);
  const std::vector<glm::vec4> found = evaluate("envmap_irradiance(c, d), 0.0", vectors, colours);
  for (std::size_t k = 0; k < vectors.size(); ++k) {
    const Direction d(vectors[k]);
    const double wanted = 1 + 2.0 / 3 * degree1(d) + 0.25 * degree2(d);
    EXPECT_NEAR(found[k].x, wanted, 1e-4);
    EXPECT_NEAR(found[k].y, 2 * wanted, 2e-4);
    EXPECT_NEAR(found[k].z, 0.5 * wanted, 1e-4);
  }
  colours[0] = glm::vec4(-1);
  EXPECT_EQ(evaluate("envmap_irradiance(c, d), 0.0", {{0, 1, 0, 0}}, colours)[0].x, 0) << "no negative light";
}

// Strictly, for the oldest versions that are named.
TEST(LookupsText, CompilesAsGlsl330AndEs300) {
  drawing::context();
  const Folders folders(32, {"glsl", "hlsl"});
  const std::string text = contents(folders.path / "glsl/envmap.glsl");
  for (const std::string head : {"#version 330 core\n",
                                 "#version 300 es\nprecision highp float; precision highp samplerCube; "
                                 "precision highp sampler2D;\n"}) {
    const std::string whole = head + text + "out vec4 colour; void main() { colour = vec4(envmap_level(0.5)); }\n";
    const char* lines = whole.c_str();
    const gl::Program program(glCreateShaderProgramv(GL_FRAGMENT_SHADER, 1, &lines));
    std::array<char, 1000> log{};
    glGetProgramInfoLog(program, log.size(), nullptr, log.data());
    GLint linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    EXPECT_EQ(linked, GL_TRUE) << head << log.data();
    const std::string file = folders.path / "strict.frag", validate = "glslangValidator " + file + " >" + file + ".log";
    std::ofstream(file) << whole;
    if (std::system("which glslangValidator >/dev/null") != 0) continue;
    EXPECT_EQ(std::system(validate.c_str()), 0) << contents(file + ".log");
  }
}

// Both folders hold the same cubes: behind DDS's 148 bytes a face has all its levels.
TEST(LookupsText, BothFoldersHoldTheSameTexels) {
  const Folders folders(32, {"glsl", "hlsl"});
  for (const std::string name : {"background", "specular"}) {
    const std::string ktx2 = contents(folders.path / "glsl" / (name + ".ktx2"));
    const std::string dds = contents(folders.path / "hlsl" / (name + ".dds"));
    const int size = value_at<int>(ktx2, 20), levels = value_at<int>(ktx2, 40);
    std::size_t at = 148;
    for (std::size_t face = 0; face < 6; ++face)
      for (int k = 0; k < levels; ++k) {
        const auto bytes = std::size_t(size >> k) * std::size_t(size >> k) * 8;
        const auto from = value_at<std::uint64_t>(ktx2, 80 + 24 * std::size_t(k)) + face * bytes;
        EXPECT_EQ(ktx2.compare(from, bytes, dds, at, bytes), 0) << name << face << k;
        at += bytes;
      }
    EXPECT_EQ(at, dds.size());
  }
}

}  // namespace
}  // namespace lookup_shaders_test

// The shaders' formulae against those in C++, and that nothing is left out of a program without a word.
#include "envmap/scenes/render/shaders.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "drawing.h"
#include "envmap/projection/visit.h"
#include "envmap/scenes/render/choose_drawing.h"
#include "envmap/scenes/render/face_image.h"
#include "envmap/scenes/render/programs.h"

namespace shaders_test {
namespace {

using namespace envmap;

// Any directions, and those where formulae have their seams: axes, diagonals, and a little beside them.
std::vector<Direction> directions_to_try() {
  std::vector<Direction> all;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        for (const double beside : {0.0, 1e-3, -1e-3})
          if (x != 0 || y != 0 || z != 0)
            all.push_back(glm::normalize(Direction(x, y, z) + beside * Direction(1, 2, -1.5)));
  std::mt19937 random(1);
  std::normal_distribution<double> d;
  while (all.size() < 4096) all.push_back(glm::normalize(Direction(d(random), d(random), d(random))));
  for (Direction& each : all) each = Direction(glm::vec3(each));  // As shaders get them.
  return all;
}

// f(d), an expression of GLSL, of each vector.
std::vector<glm::vec4> evaluated(Projection p, const std::string& expression, const std::vector<Direction>& vectors) {
  drawing::context();
  const std::string text =
      fmt::format("#version 450 core\n#define PI 3.14159274\n{}", shader_source(identifier(p) + ".glsl")) +
      "layout(local_size_x = 1) in;\n"
      "layout(std430, binding = 0) buffer In { vec4 vectors[]; };\n"
      "layout(std430, binding = 1) buffer Out { vec4 found[]; };\n"
      "void main() {\n"
      "  vec3 d = vectors[gl_GlobalInvocationID.x].xyz;\n"
      "  found[gl_GlobalInvocationID.x] = vec4(" +
      expression +
      ");\n"
      "}\n";
  const char* lines = text.c_str();
  const gl::Program program(glCreateShaderProgramv(GL_COMPUTE_SHADER, 1, &lines));
  GLint linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  EXPECT_EQ(linked, GL_TRUE) << text;
  std::vector<glm::vec4> values;
  for (const Direction& d : vectors) values.emplace_back(glm::vec3(d), 0);
  const gl::Buffer in = gl::make_buffer(values), out = gl::make_buffer(values, GL_DYNAMIC_STORAGE_BIT);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, in);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, out);
  glUseProgram(program);
  glDispatchCompute(static_cast<GLuint>(values.size()), 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(out, 0, static_cast<GLsizeiptr>(values.size() * sizeof(glm::vec4)), values.data());
  gl::check("evaluating");
  return values;
}

class Shaders : public ::testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(All, Shaders, ::testing::ValuesIn(all_projections),
                         [](const auto& p) { return identifier(p.param); });

// There and back: where the shader finds a direction, C++ has that direction; and to find it there is what C++ says,
// but for directions that lie in two places.
TEST_P(Shaders, LocateAsProjectionsDo) {
  const Projection p = GetParam();
  ASSERT_TRUE(has_shader(p));
  const std::vector<Direction> directions = directions_to_try();
  const std::vector<glm::vec4> places = evaluated(p, fmt::format("{}_located(d), 0", identifier(p)), directions);
  std::vector<Location<double>> known(directions.size());
  locate(p, directions, known);
  double there = 0, back = 0;
  int elsewhere = 0;
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const int face = int(places[k].z);
    ASSERT_LT(face, faces(p));
    const Direction found = visit(p, [&](auto q) {
      return decltype(q)::template direction<double>(face, double(places[k].x),
                                                     double(places[k].y));
    });
    there = std::max(there, angle_between(found, directions[k]));
    const double off = std::hypot(places[k].x - known[k].u, places[k].y - known[k].v);
    if (face != known[k].face || off > 0.1)
      ++elsewhere;
    else
      back = std::max(back, off);
  }
  // Mesa's arctangents are off by 3e-5; a sphere map's rim spreads what is near -Z.
  EXPECT_LT(there, p == Projection::sphere ? 2e-3 : 2e-4);
  EXPECT_LT(back, 5e-5);
  EXPECT_LT(elsewhere, 60) << "seams alone";
}

TEST_P(Shaders, RadiiAreThoseOfTheDisc) {
  const Projection p = GetParam();
  if (image_shape(p) != ImageShape::disc) GTEST_SKIP() << "no disc";
  std::vector<Direction> angles;
  for (int k = 0; k <= 180; ++k) angles.emplace_back(k * pi / 180 * (filled_disc(p) ? 0.5 : 1), 0, 0);
  const std::vector<glm::vec4> radii = evaluated(p, fmt::format("{}_radius(d.x)", identifier(p)), angles);
  for (std::size_t k = 0; k < angles.size(); ++k) {
    const Direction d(std::sin(angles[k].x), 0, std::cos(angles[k].x));
    const Location<double> at = visit(p, [&](auto q) { return decltype(q)::template locate<double>(d); });
    EXPECT_NEAR(radii[k].x, std::hypot(2 * at.u - 1, 2 * at.v - 1), 1e-5) << k;
  }
}

TEST(Programs, AnUndefinedNameInAConditionIsAnError) {
  drawing::context();
  const auto make = [](const gl::Definitions& definitions) {
    try {
      gl::make_program({{GL_FRAGMENT_SHADER, {"instances.glsl", "triangle.glsl", "visible.glsl", "distort.frag.glsl"}}},
                       definitions);
    } catch (const std::runtime_error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  const gl::Definitions all{{"HOLES", "0"}, {"LAYERED", "0"}, {"FILLED", "0"}};
  for (const auto& [name, value] : all) {
    gl::Definitions others = all;
    others.erase(name);
    EXPECT_NE(make(others).find(name + " is not defined"), std::string::npos) << make(others);
  }
}

// A method that cannot draw a projection is neither chosen nor tried.
TEST(Programs, MethodsSayWhatTheyCannotDraw) {
  for (const Projection p : all_projections) {
    EXPECT_TRUE(can_draw(cheapest(p, 256, {.triangles = 1000}), p));
    EXPECT_TRUE(can_draw(DrawMethod::resample, p) && can_draw(DrawMethod::raycast, p));
  }
  EXPECT_FALSE(can_draw(DrawMethod::distort, Projection::latlong));
  EXPECT_FALSE(can_draw(DrawMethod::tessellate, Projection::latlong));
  for (const Projection p : {Projection::octahedral, Projection::equal_area})
    for (const DrawMethod m : {DrawMethod::exact, DrawMethod::distort, DrawMethod::tessellate})
      EXPECT_FALSE(can_draw(m, p));
}

}  // namespace
}  // namespace shaders_test

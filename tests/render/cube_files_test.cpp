// Six files written for OpenGL, uploaded as they are: a lookup by a direction returns the light from there.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <random>
#include <string>

#include "drawing.h"
#include "envmap/io/read.h"
#include "envmap/io/write.h"
#include "envmap/operate/generate.h"
#include "envmap/scenes/render/gl.h"

namespace cube_files_test {
namespace {

using namespace envmap;
namespace fs = std::filesystem;

constexpr int size = 64;

// In the order of GL_TEXTURE_CUBE_MAP_POSITIVE_X and on; each file is read as a square picture that is no face.
gl::Texture upload(const fs::path& folder) {
  gl::Texture cube = gl::make_texture(GL_TEXTURE_CUBE_MAP);
  glTextureStorage2D(cube, 1, GL_RGB32F, size, size);
  int face = 0;
  for (const char* name : {"px", "nx", "py", "ny", "pz", "nz"}) {
    const Source picture = read((folder / (std::string(name) + ".exr")).string(), {.projection = Projection::angular});
    std::vector<Colour> texels;
    for (int j = 0; j < size; ++j) {
      const auto row = picture.map.base().row(0, j);
      texels.insert(texels.end(), row.begin(), row.end());
    }
    glTextureSubImage3D(cube, 0, 0, 0, face++, size, size, 1, GL_RGB, GL_FLOAT, texels.data());
  }
  gl::interpolate(cube);
  gl::check("upload of six files");
  return cube;
}

std::vector<glm::vec4> looked_up(const gl::Texture& cube, const std::vector<glm::vec4>& directions) {
  const char* text =
      "#version 450 core\n"
      "layout(local_size_x = 1) in;\n"
      "layout(binding = 0) uniform samplerCube cube;\n"
      "layout(std430, binding = 0) buffer In { vec4 directions[]; };\n"
      "layout(std430, binding = 1) buffer Out { vec4 found[]; };\n"
      "void main() {\n"
      "  uint k = gl_GlobalInvocationID.x;\n"
      "  found[k] = textureLod(cube, directions[k].xyz, 0);\n"
      "}\n";
  const gl::Program program(glCreateShaderProgramv(GL_COMPUTE_SHADER, 1, &text));
  const gl::Buffer in = gl::make_buffer(directions), out = gl::make_buffer(directions, GL_DYNAMIC_STORAGE_BIT);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, in);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, out);
  glBindTextureUnit(0, cube);
  glUseProgram(program);
  glDispatchCompute(GLuint(directions.size()), 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  std::vector<glm::vec4> found(directions.size());
  glGetNamedBufferSubData(out, 0, GLsizeiptr(found.size() * sizeof(glm::vec4)), found.data());
  gl::check("lookups");
  return found;
}

TEST(CubeFiles, ShowDirectionsToOpenGL) {
  drawing::context();
  const fs::path folder = fs::temp_directory_path() / ("envmap-cube-files-" + std::to_string(::getpid()));
  fs::create_directory(folder);
  write((folder / "{face}.exr").string(), generate(Directions{}, {Projection::cube}, size), {.faces = "gl"});
  std::vector<glm::vec4> directions;
  std::mt19937 random(1);
  std::normal_distribution<float> d;
  while (directions.size() < 4096) {
    const glm::vec3 each(d(random), d(random), d(random));
    directions.emplace_back(glm::normalize(each), 0);
  }
  const std::vector<glm::vec4> found = looked_up(upload(folder), directions);
  fs::remove_all(folder);
  for (std::size_t k = 0; k < found.size(); ++k)
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(found[k][c], 0.5F + 0.5F * directions[k][c], 0.01)
          << "towards " << directions[k][0] << ' ' << directions[k][1] << ' ' << directions[k][2];
}

}  // namespace
}  // namespace cube_files_test

#include "envmap/scenes/render/environment_texture.h"

#include <algorithm>

#include "envmap/operate/convert.h"
#include "envmap/projection/matching_size.h"
#include "envmap/sample/padded_level.h"
#include "envmap/scenes/render/programs.h"
#include "envmap/scenes/render/shading/sheen_brdf.h"

namespace envmap {
namespace {

// Seen from outside: X and Z mirrored left to right, Y top to bottom.
std::vector<Colour> as_gl_turns(const PaddedLevel& cube, int face) {
  const int n = cube.height();
  const bool y = face / 2 == 1;
  std::vector<Colour> all;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) all.push_back(*cube.texel(face, y ? i : n - 1 - i, y ? n - 1 - j : j));
  return all;
}

// @param levels each half as high as the one before.
gl::Texture upload_cube(const std::vector<PaddedLevel>& levels) {
  gl::Texture cube = gl::make_texture(GL_TEXTURE_CUBE_MAP);
  const int size = levels[0].height();
  glTextureStorage2D(cube, GLsizei(levels.size()), GL_RGB32F, size, size);
  for (int level = 0; level < int(levels.size()); ++level)
    for (int face = 0; face < 6; ++face)
      glTextureSubImage3D(cube, level, 0, 0, face, size >> level, size >> level, 1, GL_RGB, GL_FLOAT,
                          as_gl_turns(levels[std::size_t(level)], face).data());
  gl::interpolate(cube);
  glTextureParameteri(cube, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  return cube;
}

// Square, of floats.
gl::Texture upload_table(int size, GLenum stored, GLenum given, const void* values) {
  gl::Texture table = gl::make_texture(GL_TEXTURE_2D);
  glTextureStorage2D(table, 1, stored, size, size);
  glTextureSubImage2D(table, 0, 0, 0, size, size, given, GL_FLOAT, values);
  gl::interpolate(table);
  return table;
}

}  // namespace

gl::Texture upload_split_sum() { return upload_table(split_sum_size, GL_RGB32F, GL_RGB, split_sum_table().data()); }
gl::Texture upload_sheen_table() { return upload_table(sheen_table_size, GL_R32F, GL_RED, sheen_table().data()); }

LightTexture upload(const EnvironmentLight& light) {
  LightTexture out{gl::make_texture(GL_TEXTURE_CUBE_MAP_ARRAY), light.roughnesses, {}, light.irradiance};
  int size = 0;
  for (const auto& cube : light.glossy) size = std::max(size, cube->height());
  const auto mip_of = [&](const PaddedLevel& cube) { return size / cube.height() / 2; };  // 0, 1, 2 of 1, 2, 4.
  for (const auto& cube : light.glossy) out.mips.push_back(float(mip_of(*cube)));
  glTextureStorage3D(out.glossy, 1 + int(std::ranges::max(out.mips)), GL_RGB32F, size, size, 6 * int(out.mips.size()));
  for (std::size_t layer = 0; layer < light.glossy.size(); ++layer) {
    const PaddedLevel& cube = *light.glossy[layer];
    for (int face = 0; face < 6; ++face)
      glTextureSubImage3D(out.glossy, mip_of(cube), 0, 0, 6 * int(layer) + face, cube.height(), cube.height(), 1,
                          GL_RGB, GL_FLOAT, as_gl_turns(cube, face).data());
  }
  gl::interpolate(out.glossy);
  glTextureParameteri(out.glossy, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_NEAREST);
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  if (!light.sampled.empty()) out.sampled = upload_cube(light.sampled);
  gl::check("upload of the environment's light");
  return out;
}

EnvironmentTexture upload(const EnvironmentMap& map) {
  constexpr int aprons = 2 * Level::padding;
  GLint largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  const bool too_large = std::max(map.base().width(), map.base().height()) + aprons > largest;
  const bool as_it_is = map.projection() != Projection::sphere && has_shader(map.projection()) && !too_large;
  const int dense = matching_size(map.projection(), map.base().height(), Projection::cube);
  const PaddedLevel level(
      as_it_is ? map.base().clone()
               : std::move(convert(map, {.to = Projection::cube, .size = std::min(dense, largest - aprons)}).base()));
  const Forward forward = as_it_is ? map.forward : Forward::plus_z;
  EnvironmentTexture out{gl::make_texture(GL_TEXTURE_2D_ARRAY), level.projection(),
                         glm::transpose(image_to_world(forward)),
                         pi / matching_size(level.projection(), level.height(), Projection::latlong)};
  const int width = level.width() + aprons, height = level.height() + aprons;
  glTextureStorage3D(out.texture, 1, GL_RGB32F, width, height, level.faces());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  for (int face = 0; face < level.faces(); ++face)
    glTextureSubImage3D(out.texture, 0, 0, 0, face, width, height, 1, GL_RGB, GL_FLOAT,
                        level.texel(face, -Level::padding, -Level::padding));
  gl::interpolate(out.texture);
  gl::check("upload of the environment");
  return out;
}

}  // namespace envmap

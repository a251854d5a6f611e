#include "envmap/render/environment_texture.h"

#include <algorithm>

#include "envmap/map/gutter.h"
#include "envmap/operate/convert.h"

namespace envmap {
namespace {

// Seen from outside: X and Z mirrored left to right, Y top to bottom.
std::vector<Colour> as_gl_turns(const Level& cube, int face) {
  const int n = cube.height();
  const bool y = face / 2 == 1;
  std::vector<Colour> all;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) all.push_back(*cube.texel(face, y ? i : n - 1 - i, y ? n - 1 - j : j));
  return all;
}

}  // namespace

LightTexture upload(const EnvironmentLight* light) {
  LightTexture out{gl::make_texture(GL_TEXTURE_CUBE_MAP_ARRAY), gl::make_texture(GL_TEXTURE_2D)};
  glTextureStorage2D(out.split_sum, 1, GL_RGB32F, split_sum_size, split_sum_size);
  glTextureSubImage2D(out.split_sum, 0, 0, 0, split_sum_size, split_sum_size, GL_RGB, GL_FLOAT, split_sum_table().data());
  gl::interpolate(out.split_sum);
  if (light == nullptr) return out;
  out.irradiance = light->irradiance;
  const int size = light->glossy.front().height(), levels = static_cast<int>(light->glossy.size());
  glTextureStorage3D(out.glossy, 1, GL_RGB32F, size, size, 6 * levels);
  for (int level = 0; level < levels; ++level)
    for (int face = 0; face < 6; ++face)
      glTextureSubImage3D(out.glossy, 0, 0, 0, 6 * level + face, size, size, 1, GL_RGB, GL_FLOAT,
                          as_gl_turns(light->glossy[static_cast<std::size_t>(level)], face).data());
  gl::interpolate(out.glossy);
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  gl::check("upload of the environment's light");
  return out;
}

EnvironmentTexture upload(const EnvironmentMap& map) {
  EnvironmentMap copy{{map.base()}, map.forward};
  GLint largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  const auto side = [](const Level& level) { return std::max(level.width(), level.height()) + 2 * Level::gutter; };
  if (copy.projection() == Projection::sphere || side(copy.base()) > largest) {
    const int dense = matching_size(copy.projection(), copy.base().height(), Projection::cube);
    copy = convert(copy, {.to = Projection::cube, .size = std::min(dense, largest - 2 * Level::gutter)});
  }
  Level& level = copy.base();
  fill_gutter(level);
  EnvironmentTexture out{gl::make_texture(GL_TEXTURE_2D_ARRAY), copy.projection(),
                         glm::transpose(image_to_world(copy.forward))};
  const int width = level.width() + 2 * Level::gutter, height = level.height() + 2 * Level::gutter;
  glTextureStorage3D(out.texture, 1, GL_RGB32F, width, height, level.faces());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  for (int face = 0; face < level.faces(); ++face)
    glTextureSubImage3D(out.texture, 0, 0, 0, face, width, height, 1, GL_RGB, GL_FLOAT,
                        level.texel(face, -Level::gutter, -Level::gutter));
  gl::interpolate(out.texture);
  gl::check("upload of the environment");
  return out;
}

}  // namespace envmap

#include "envmap/render/environment_texture.h"

#include <algorithm>

#include "envmap/map/gutter.h"
#include "envmap/operate/convert.h"

namespace envmap {

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
  glTextureParameteri(out.texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(out.texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTextureParameteri(out.texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTextureParameteri(out.texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  gl::check("upload of the environment");
  return out;
}

}  // namespace envmap

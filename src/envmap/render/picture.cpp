#include "envmap/map/image_view.h"
#include "envmap/render/renderer.h"

namespace envmap {

std::vector<Colour> draw_picture(Renderer& renderer, const Viewpoint& from, const Shot& shot) {
  MapTexture picture(from.lens->width, from.size);
  renderer.draw(from, shot, DrawMethod::distort, picture);
  std::vector<glm::vec4> texels(ImageView<glm::vec4>::count(picture.width, picture.size));
  glGetTextureImage(picture.texture, 0, GL_RGBA, GL_FLOAT, static_cast<GLsizei>(texels.size() * sizeof(glm::vec4)),
                    texels.data());
  gl::check("reading the picture");
  std::vector<Colour> out;
  out.reserve(texels.size());
  for (const glm::vec4& t : texels) out.emplace_back(t);
  return out;
}

}  // namespace envmap

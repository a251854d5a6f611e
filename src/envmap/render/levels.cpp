// Levels of detail of what mirrors show, made on the card each time it is drawn.
#include "envmap/render/renderer.h"

namespace envmap {
namespace {

// One level as an array of faces, whatever the texture is: what a shader reads while it draws the next.
gl::Texture level_of(const MapTexture& map, int level) {
  GLuint name = 0;
  glGenTextures(1, &name);  // Views take no texture that has a target yet.
  gl::Texture view(name);
  glTextureView(view, GL_TEXTURE_2D_ARRAY, map.texture, GL_RGBA32F, static_cast<GLuint>(level), 1, 0,
                static_cast<GLuint>(faces(map.projection)));
  glTextureParameteri(view, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  return view;
}

}  // namespace

void Renderer::make_levels(const MapTexture& map, unsigned which, bool surfaces) {
  gl::Program& program = levels_[map.projection];
  if (program == 0) program = level_program(map.projection);
  gpu_.bind();  // Nothing is drawn without an array of vertices.
  const gl::Framebuffer to = gl::make_framebuffer();
  glBindFramebuffer(GL_FRAMEBUFFER, to);
  glDisable(GL_STENCIL_TEST);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  glUseProgram(program);
  for (int level = 1; level < map.levels; ++level) {
    const gl::Texture finer = level_of(map, level - 1);
    glBindTextureUnit(unit_mirror, finer);
    glViewport(0, 0, std::max(1, map.width >> level), std::max(1, map.size >> level));
    for (int face = 0; face < faces(map.projection); ++face) {
      if ((which >> face & 1U) == 0) continue;
      glNamedFramebufferTextureLayer(to, GL_COLOR_ATTACHMENT0, map.texture, level, map.layer(face));
      gl::set(program, "layer", map.layer(face));
      gl::set(program, "surfaces", surfaces && level == 1 ? 1 : 0);
      glDrawArrays(GL_TRIANGLES, 0, 3);
    }
  }
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  gl::check("levels of a map");
}

}  // namespace envmap

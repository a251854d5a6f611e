#include "envmap/render/canvas.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "envmap/base/error.h"
#include "envmap/render/draw.h"

namespace envmap {
namespace {

std::vector<glm::vec4> rays_of(Projection p, int size, int face, const Vec2<double>& offset) {
  const int width = size * aspect(p);
  std::vector<glm::vec4> rays(static_cast<std::size_t>(width) * static_cast<std::size_t>(size), glm::vec4(0));
  tbb::parallel_for(0, size, [&](int row) {
    const Columns in = columns(p, size, row);
    std::vector<Direction> found(static_cast<std::size_t>(in.end - in.first));
    sample_directions(p, size, face, row, offset, found);
    glm::vec4* to = &rays[static_cast<std::size_t>(row) * static_cast<std::size_t>(width)];
    for (std::size_t k = 0; k < found.size(); ++k)
      to[static_cast<std::size_t>(in.first) + k] = {glm::vec3(found[k]), 0};
  });
  return rays;
}

gl::Texture uploaded(const std::vector<glm::vec4>& rays, int width, int height) {
  gl::Texture texture = gl::make_texture(GL_TEXTURE_2D);
  glTextureStorage2D(texture, 1, GL_RGBA32F, width, height);
  glTextureSubImage2D(texture, 0, 0, 0, width, height, GL_RGBA, GL_FLOAT, rays.data());
  glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  return texture;
}

}  // namespace

void check_face(int width, int height) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (std::max(width, height) > largest)
    throw UsageError(fmt::format("a face of {}x{}: this renderer draws up to {}", width, height, largest));
}

Canvas::Canvas(int w, int h)
    : width(w),
      height(h),
      surfaces(gl::make_texture(GL_TEXTURE_2D)),
      seen(gl::make_framebuffer()),
      lit(gl::make_framebuffer()) {
  check_face(w, h);
  glTextureStorage2D(surfaces, 1, GL_RG32UI, width, height);
  glTextureParameteri(surfaces, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  // Without this a texture of integers is incomplete.
  glTextureParameteri(surfaces, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  GLuint name = 0;
  glCreateRenderbuffers(1, &name);
  depth = gl::Renderbuffer(name);
  glNamedRenderbufferStorage(depth, GL_DEPTH32F_STENCIL8, width, height);
  glNamedFramebufferTexture(seen, GL_COLOR_ATTACHMENT0, surfaces, 0);
  glNamedFramebufferRenderbuffer(seen, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER, depth);
  glNamedFramebufferRenderbuffer(lit, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER, depth);
  gl::check("canvas");
}

gl::Texture make_rays(Projection p, int size, int face, const Vec2<double>& offset) {
  return uploaded(rays_of(p, size, face, offset), size * aspect(p), size);
}

gl::Texture make_rays(const Lens& lens, int height, const Vec2<double>& offset) {
  std::vector<glm::vec4> rays(static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(height));
  tbb::parallel_for(0, height, [&](int row) {
    for (int i = 0; i < lens.width; ++i)
      rays[static_cast<std::size_t>(row) * static_cast<std::size_t>(lens.width) + static_cast<std::size_t>(i)] =
          glm::vec4(glm::vec3(lens.ray((i + 0.5 + offset.x) / lens.width, (row + 0.5 + offset.y) / height)), 0);
  });
  return uploaded(rays, lens.width, height);
}

}  // namespace envmap

#include "envmap/scenes/render/visibility_buffer.h"

#include <fmt/format.h>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/map/image_view.h"
#include "envmap/scenes/render/draw.h"

namespace envmap {
namespace {

std::vector<glm::vec4> rays_of(Projection p, int size, int face, const Vec2<double>& offset) {
  const int width = size * aspect(p);
  std::vector<glm::vec4> rays(ImageView<glm::vec4>::count(width, size), glm::vec4(0));
  const ImageView<glm::vec4> image(rays, width, size);
  parallel_for(size, [&](int row) {
    const Columns in = columns(p, size, row);
    std::vector<Direction> found(in.count());
    sample_directions(p, size, face, row, offset, found);
    std::ranges::transform(found, in.of(image.row(0, row)).begin(), [](const Direction& d) { return glm::vec4(d, 0); });
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

gl::Texture depth_stencil(int width, int height) {
  gl::Texture texture = gl::make_texture(GL_TEXTURE_2D);
  glTextureStorage2D(texture, 1, GL_DEPTH32F_STENCIL8, width, height);
  glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  return texture;
}

}  // namespace

void check_face(int width, int height) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (std::max(width, height) > largest)
    throw UsageError(fmt::format("a face of {}x{}: this renderer draws up to {}", width, height, largest));
}

VisibilityBuffer::VisibilityBuffer(int w, int h)
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
  depth = depth_stencil(width, height);
  glNamedFramebufferTexture(seen, GL_COLOR_ATTACHMENT0, surfaces, 0);
  glNamedFramebufferTexture(seen, GL_DEPTH_STENCIL_ATTACHMENT, depth, 0);
  glNamedFramebufferTexture(lit, GL_DEPTH_STENCIL_ATTACHMENT, depth, 0);
  gl::check("canvas");
}

DepthPeeling::DepthPeeling(const VisibilityBuffer& canvas) : sample(gl::make_texture(GL_TEXTURE_2D)) {
  glTextureStorage2D(sample, 1, GL_RGBA32F, canvas.width, canvas.height);
  glTextureParameteri(sample, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  for (int k = 0; k < 2; ++k) {
    depth[k] = depth_stencil(canvas.width, canvas.height);
    seen[k] = gl::make_framebuffer();
    glNamedFramebufferTexture(seen[k], GL_COLOR_ATTACHMENT0, canvas.surfaces, 0);
    glNamedFramebufferTexture(seen[k], GL_DEPTH_STENCIL_ATTACHMENT, depth[k], 0);
    lit[k] = gl::make_framebuffer();
    glNamedFramebufferTexture(lit[k], GL_COLOR_ATTACHMENT0, sample, 0);
    glNamedFramebufferTexture(lit[k], GL_DEPTH_STENCIL_ATTACHMENT, depth[k], 0);
  }
  gl::check("layers");
}

gl::Texture make_rays(Projection p, int size, int face, const Vec2<double>& offset) {
  return uploaded(rays_of(p, size, face, offset), size * aspect(p), size);
}

gl::Texture make_rays(const Lens& lens, int height, const Vec2<double>& offset) {
  std::vector<glm::vec4> rays(ImageView<glm::vec4>::count(lens.width, height));
  const ImageView<glm::vec4> image(rays, lens.width, height);
  parallel_for(height, [&](int row) {
    for (int i = 0; i < lens.width; ++i) {
      const double u = (i + 0.5 + offset.x) / lens.width, v = (row + 0.5 + offset.y) / height;
      image(i, row) = glm::vec4(lens.parallel ? lens.origin(u, v) : lens.ray(u, v), lens.parallel ? 1 : 0);
    }
  });
  return uploaded(rays, lens.width, height);
}

}  // namespace envmap

#include "envmap/scenes/render/shadow_maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "envmap/base/error.h"

namespace envmap {
namespace {

// As shadow_view.glsl reads it.
struct GpuShadowView {
  std::array<glm::vec4, 3> axes;  // w: of the centre, from the viewpoint.
  glm::vec4 lens;                 // Half the width; 1 for parallel rays; the depth that nothing may lie before.
};

// Nothing nearer to a light than this part of the scene casts a shadow of it: depth buffers of floats do not mind.
constexpr double nearest = 1e-6;

}  // namespace

void ShadowMaps::make(std::size_t faces) {
  GLint layers = 0;
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &layers);
  if (faces > std::min(std::size_t(layers), max_shadow_texels / 4096))
    throw UsageError(fmt::format("shadow maps of {} faces: this renderer takes {}", faces, layers),
                     Remedy::leave_out_shadows);
  size_ = shadow_map_size(faces);
  maps_ = gl::make_texture(GL_TEXTURE_2D_ARRAY);
  glTextureStorage3D(maps_, 1, GL_RGBA32F, size_, size_, static_cast<GLsizei>(faces));
  glTextureParameteri(maps_, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(maps_, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  depth_ = gl::make_renderbuffer(GL_DEPTH_COMPONENT32F, size_, size_);
  seen_ = gl::make_framebuffer();
  glNamedFramebufferRenderbuffer(seen_, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
  const std::size_t held = std::max<std::size_t>(faces, max_distant_lights);  // A block has its size.
  face_buffer_ = gl::make_buffer(nullptr, held * sizeof(GpuShadowView), GL_DYNAMIC_STORAGE_BIT);
  gl::check("shadow maps");
}

void ShadowMaps::place(const Direction& eye) const {
  std::vector<GpuShadowView> faces;
  for (const ShadowView& f : faces_) {
    GpuShadowView face{.lens = glm::vec4(f.half, f.parallel ? 1 : 0, nearest, 0)};
    for (int k = 0; k < 3; ++k) face.axes[k] = glm::vec4(f.axes[k], (f.centre - eye)[k]);
    faces.push_back(face);
  }
  glNamedBufferSubData(face_buffer_, 0, static_cast<GLsizeiptr>(faces.size() * sizeof(GpuShadowView)), faces.data());
}

void ShadowMaps::bind(const Direction& eye, Unit unit, GLenum target, Unit binding) const {
  if (faces_.empty()) return;
  place(eye);
  glBindBufferBase(target, binding, face_buffer_);
  glBindTextureUnit(unit, maps_);
}

// The scene is placed as seen from the face's centre, along the axes of the world.
void ShadowMaps::draw_face(std::size_t face, const GpuScene& gpu, const FrameState& shot) {
  glNamedFramebufferTextureLayer(seen_, GL_COLOR_ATTACHMENT0, maps_, 0, static_cast<GLint>(face));
  glBindFramebuffer(GL_FRAMEBUFFER, seen_);
  constexpr std::array<float, 4> nothing{0, 0, -1e30F, 0};
  constexpr float far = 0;
  glClearNamedFramebufferfv(seen_, GL_COLOR, 0, nothing.data());
  glClearNamedFramebufferfv(seen_, GL_DEPTH, 0, &far);
  const ShadowView& f = faces_[face];
  for (const bool holes : {false, true}) {
    const gl::Program& with = programs_->shadow(holes);
    glUseProgram(with);
    gl::set(with, "light_face", int(face));
    gl::set(with, "pixel", std::array{2.0F / float(size_), 2.0F / float(size_)});
    for (std::size_t k = 0; k < gpu.parts().size(); ++k) {
      const Part& part = gpu.parts()[k];
      const Ball& ball = gpu.placed()[k].ball;
      if (part.holes != holes || !part.casts_shadow || part.indices == 0) continue;
      if (f.but >= 0 && lies_under(shot.scene, part.node, f.but)) continue;
      if (!f.parallel && glm::dot(ball.centre, f.axes[2]) + ball.radius < 0) continue;
      if (holes) {
        const Group& group = gpu.groups()[std::size_t(part.group)];
        gpu.bind(group);
        gl::set(with, "material", part.material);
        gl::set(with, "textured", group.is_painted() ? 1 : 0);
      }
      gl::set(with, "to_map", gpu.placed()[k].to_map);
      gl::set(with, "instance", int(k));
      gl::set(with, "first_triangle", int(part.first_index / 3));
      gpu.draw(part);
    }
  }
}

void ShadowMaps::draw(GpuScene& gpu, const FrameState& shot, std::vector<ShadowView> faces) {
  pose_ = shot.pose;
  faces_ = std::move(faces);
  if (faces_.empty()) return;
  if (size_ == 0) make(faces_.size());
  glViewport(0, 0, size_, size_);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_GREATER);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  for (const GLenum off : {GL_STENCIL_TEST, GL_BLEND, GL_CULL_FACE}) glDisable(off);
  for (std::size_t k = 0; k < faces_.size(); ++k) {
    gpu.place(shot.scene, shot.pose, faces_[k].centre, Rotation(1));
    gpu.bind();
    place(faces_[k].centre);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, buffer_shadow_views, face_buffer_);
    draw_face(k, gpu, shot);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  gl::check("drawing shadow maps");
}

}  // namespace envmap

/// @file
/// Shadow maps: what each punctual light sees, as shaders/shadow.glsl looks it up.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "envmap/scenes/render/gl.h"
#include "envmap/scenes/render/gpu_scene.h"
#include "envmap/scenes/render/programs.h"
#include "envmap/scenes/render/shadow_view.h"

namespace envmap {

/// Needs a current context, and goes before it. Source: Williams 1978, "Casting curved shadows on curved surfaces".
class ShadowMaps {
 public:
  explicit ShadowMaps(std::shared_ptr<ProgramCache> programs) : programs_(std::move(programs)) {}

  /// Draws them. The scene must be placed anew after this.
  /// @param faces as many as before. @throws UsageError where the renderer has no room for so many.
  void draw(GpuScene& gpu, const FrameState& shot, std::vector<ShadowView> faces);

  /// Whether they are of this moment.
  [[nodiscard]] bool are_of(const Pose& pose) const { return pose == pose_; }

  /// That something in them changed.
  void forget() { pose_.clear(); }

  /// For shading, seen from `eye`: maps to a unit, faces to a binding of GL_SHADER_STORAGE_BUFFER or GL_UNIFORM_BUFFER.
  void bind(const Direction& eye, Unit unit, GLenum target, Unit binding) const;

 private:
  void make(std::size_t faces);
  void place(const Direction& eye) const;
  void draw_face(std::size_t face, const GpuScene& gpu, const FrameState& shot);

  std::shared_ptr<ProgramCache> programs_;
  Pose pose_;  // Of what is drawn.
  std::vector<ShadowView> faces_;
  int size_ = 0;
  gl::Texture maps_;  // A layer a face: see shadow.glsl.
  gl::Renderbuffer depth_;
  gl::Framebuffer seen_;
  gl::Buffer face_buffer_;
};

}  // namespace envmap

// What each texel sees.
#include <array>
#include <cmath>

#include "envmap/scenes/render/face_image.h"
#include "envmap/scenes/render/renderer.h"

namespace envmap {
namespace {

constexpr double tessellation_tolerance = 0.25;  // Pixels.

// How near to -Z a vertex may come: the values of Heidrich's and later implementations. Small pieces may come nearer.
float singularity(DrawMethod method, Projection p) {
  if (filled_disc(p)) return 0.5F;
  return method == DrawMethod::tessellate ? 0.01F : 0.05F;
}

// Whether a sphere can be seen in a face at all.
bool in_face(const Viewpoint& from, const Direction& centre, double radius) {
  if (from.lens) {
    const Vec2<double> zoom = 1.0 / from.lens->tangents;
    const double shift = from.lens->shift;
    if (from.lens->parallel)
      return centre.z >= -radius && std::abs(centre.x) - radius <= from.lens->tangents.x &&
             std::abs(centre.y) - radius <= from.lens->tangents.y;
    const auto beyond = [&](double slope, double x, double ahead) {
      return slope * x > ahead * centre.z + std::hypot(slope, ahead) * radius;
    };
    return centre.z >= -radius && !beyond(zoom.x, centre.x, 1 - shift) && !beyond(-zoom.x, centre.x, 1 + shift) &&
           !beyond(zoom.y, centre.y, 1) && !beyond(-zoom.y, centre.y, 1);
  }
  const Projection p = from.to;
  if (image_shape(p) == ImageShape::plane)
    return centre.z >= -radius &&
           std::max(std::abs(centre.x), std::abs(centre.y)) - centre.z <= std::sqrt(2.0) * radius;
  const double distance = glm::length(centre);
  if (image_shape(p) != ImageShape::disc || distance <= radius) return true;
  return std::atan2(std::hypot(centre.x, centre.y), centre.z) - std::asin(radius / distance) <= reach(p) + 0.01;
}

// Of the world, as the frame of a map has it.
glm::vec4 in_frame(const Plane& plane, const Viewpoint& from) {
  const Direction normal(plane);
  return {glm::transpose(from.axes) * normal, plane.w + glm::dot(normal, from.at)};
}

}  // namespace

bool is_in_picture(const Viewpoint& from, const Direction& centre, double radius) {
  const Direction seen = glm::transpose(from.axes) * (centre - from.at);
  return in_face(from, {seen.x, seen.y, -seen.z}, radius);
}

// Of opaque surfaces the nearest, of blended ones the furthest.
void Renderer::begin_finding(GLuint into, bool blended) const {
  glBindFramebuffer(GL_FRAMEBUFFER, into);
  glViewport(0, 0, canvas_->width, canvas_->height);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glDepthFunc(blended ? GL_LESS : GL_GREATER);
  glEnable(GL_STENCIL_TEST);
  glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
  glStencilMask(0xff);
  glDisable(GL_BLEND);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  constexpr std::array<GLuint, 4> nothing{};
  glClearNamedFramebufferuiv(into, GL_COLOR, 0, nothing.data());
  glClearNamedFramebufferfi(into, GL_DEPTH_STENCIL, 0, blended ? 1 : 0, 0);
  glPatchParameteri(GL_PATCH_VERTICES, 3);
}

void Renderer::find_surfaces(const Viewpoint& from, const FrameState& shot, DrawMethod method, const Pass& pass) {
  const auto [face, sample, into, blended, counts] = pass;
  const Projection image = from.lens ? Projection::cube : from.to;
  const bool tessellated = method == DrawMethod::tessellate && image_shape(image) == ImageShape::disc;
  const bool by_triangle = method == DrawMethod::exact || image_shape(image) == ImageShape::disc;
  const Rotation to_face = from.lens ? Rotation(1, 0, 0, 0, 1, 0, 0, 0, -1) : map_to_face(from.to, face);
  const Vec2<double> tangents = from.lens ? from.lens->tangents : Vec2<double>(1);
  // The near plane touches the near sphere from inside, at the corners.
  const double nearest = 0.98 * from.near / std::sqrt(1 + glm::dot(tangents, tangents));
  const glm::vec4 frame(1.0 / tangents.x, 1.0 / tangents.y, from.lens ? from.lens->shift : 0, nearest);
  const bool parallel = from.lens && from.lens->parallel;
  begin_finding(into, blended);
  (from.lens ? glEnable : glDisable)(GL_CLIP_DISTANCE0);
  const std::array<float, 2> range{float(from.near), float(from.far)};
  const std::array<float, 2> pixel{2.0F / float(canvas_->width), 2.0F / float(canvas_->height)};
  const Vec2<double> offset = sample_offset(sample, from.samples);
  const std::array<float, 2> shift{-float(offset.x) * pixel[0], -float(offset.y) * pixel[1]};
  for (const bool holes : {false, true}) {
    const gl::Program* program = nullptr;
    for (std::size_t k = 0; k < gpu_.parts().size(); ++k) {
      const Part& part = gpu_.parts()[k];
      const InstanceTransform& placed = gpu_.placed()[k];
      if (part.blended != blended || (part.holes && !blended) != holes || part.indices == 0) continue;
      if (from.without >= 0 && lies_under(shot.scene, part.node, from.without)) continue;
      if ((parallel ? -placed.ball.centre.z : glm::length(placed.ball.centre)) - placed.ball.radius > from.far)
        continue;
      if (from.cull && !in_face(from, to_face * placed.ball.centre, placed.ball.radius)) continue;
      if (program == nullptr) {
        program = &programs_->visibility(method, image, holes, blended);
        gl::set(*program, "range", range);
        gl::set(*program, "pixel", pixel);
        gl::set(*program, "shift", shift);
        gl::set(*program, "to_face", to_face);
        gl::set(*program, "frame", frame);
        gl::set(*program, "parallel", parallel ? 1 : 0);
        gl::set(*program, "before", in_frame(from.before, from));
        gl::set(*program, "singularity", from.epsilon > 0 ? float(from.epsilon) : singularity(method, image));
        gl::set(*program, "counts", counts ? 1 : 0);
        gl::set(*program, "tolerance", float(tessellation_tolerance));
        glUseProgram(*program);
      }
      if (holes) {
        const Group& group = gpu_.groups()[part.group];
        gpu_.bind(group);
        gl::set(*program, "material", part.material);
        gl::set(*program, "textured", group.is_painted() ? 1 : 0);
      }
      gl::set(*program, "to_map", placed.to_map);
      gl::set(*program, "instance", int(k));
      gl::set(*program, "first_triangle", int(part.first_index / 3));
      gl::set(*program, "facing", part.double_sided ? 0 : placed.mirrored ? -1 : 1);
      glStencilFunc(GL_ALWAYS, part.stencil, 0xff);
      // Geometry shaders see to sides themselves. Images that show the world mirrored turn those of the others round.
      (by_triangle || part.double_sided ? glDisable : glEnable)(GL_CULL_FACE);
      glFrontFace((glm::determinant(to_face) < 0) != placed.mirrored ? GL_CW : GL_CCW);
      tessellated ? gpu_.draw_patches(part) : gpu_.draw(part);
    }
  }
  glDisable(GL_CULL_FACE);
  glDisable(GL_CLIP_DISTANCE0);
}

}  // namespace envmap

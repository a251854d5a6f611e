#include "envmap/map/image_view.h"
#include "envmap/scenes/render/mirrors.h"
#include "envmap/scenes/scene/camera.h"

namespace envmap {
namespace {

// What the eye sees in a flat mirror, seen from behind it: the ray of a pixel mirrored is that of the pixel on the
// other side of the picture's middle.
Viewpoint mirrored(const Viewpoint& from, const Plane& mirror, int node, const Ball& scene) {
  const Direction normal(mirror);
  Viewpoint other = from;
  other.at = from.at - 2 * (glm::dot(normal, from.at) + mirror.w) * normal;
  other.axes = Rotation(-glm::reflect(from.axes[0], normal), glm::reflect(from.axes[1], normal),
                        glm::reflect(from.axes[2], normal));
  other.lens->shift = -from.lens->shift;
  other.near = std::min(from.near, 0.5 * std::abs(glm::dot(mirror, Plane(from.at, 1))));
  // A camera's far plane is not its mirrors'.
  other.far = std::max(from.far, glm::length(scene.centre - other.at) + scene.radius);
  other.before = mirror;
  other.without = node;
  other.show_ambient = true;
  return other;
}

bool is_before(const Plane& mirror, const Viewpoint& eye) {
  return glm::dot(mirror, eye.lens->parallel ? Plane(eye.axes[2], 0) : Plane(eye.at, 1)) > 0;
}

// How often flat mirrors show each other by pictures: two of them take turns, more of them branch.
int depth_of(const FrameState& shot) {
  if (shot.look.tinted) return 0;  // Tints are of maps.
  const auto flat = std::ranges::count_if(shot.mirrors, [](const MirrorMap& m) { return m.flat.has_value(); });
  return flat <= 2 ? shot.look.pictures : std::min(shot.look.pictures, flat <= 4 ? 2 : 1);
}

// Pictures in mirrors first. @param ball round the scene. @param depth how often mirrors show mirrors so.
void draw(Renderer& renderer, const Viewpoint& from, const FrameState& shot, const Ball& ball, int depth,
          MapTexture& to) {
  std::vector<std::optional<MapTexture>> pictures(shot.mirrors.size());
  std::vector<const MapTexture*> reflections(shot.mirrors.size());
  for (std::size_t k = 0; depth > 0 && k < pictures.size(); ++k) {
    const MirrorMap& mirror = shot.mirrors[k];
    const int node = renderer.mirrors()[k];
    if (!mirror.flat || node == from.without) continue;
    const Plane plane = mirror.double_sided && !is_before(*mirror.flat, from) ? -*mirror.flat : *mirror.flat;
    if (!is_before(plane, from)) continue;
    if (!is_in_picture(from, mirror.centre, mirror.radius)) continue;
    draw(renderer, mirrored(from, plane, node, ball), shot, ball, depth - 1,
         pictures[k].emplace(from.lens->width, from.size));
    reflections[k] = &*pictures[k];
  }
  FrameState with_pictures = shot;
  with_pictures.reflections = reflections;
  renderer.draw(from, with_pictures, DrawMethod::distort, to);
}

}  // namespace

std::vector<Colour> draw_picture(Renderer& renderer, const Viewpoint& from, const FrameState& shot) {
  MapTexture picture(from.lens->width, from.size);
  draw(renderer, from, shot, bounds(shot.scene, shot.pose), depth_of(shot), picture);
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

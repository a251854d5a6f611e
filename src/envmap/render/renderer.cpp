#include "envmap/render/renderer.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>

#include "envmap/base/error.h"
#include "envmap/render/image.h"

namespace envmap {
namespace {

constexpr double tessellation_tolerance = 0.25;  // Pixels.

template <class M>
std::array<float, 9> floats(const M& m) {
  std::array<float, 9> out{};
  for (int k = 0; k < 9; ++k) out[k] = static_cast<float>(m[k / 3][k % 3]);
  return out;
}

// How near to -Z a vertex may come: the figures of Heidrich's and later implementations.
float singularity(Projection p) { return filled_disc(p) ? 0.5F : 0.05F; }

// Whether a sphere can be seen in a face at all.
bool in_face(const Viewpoint& from, const Direction& centre, double radius) {
  if (from.lens) {
    const Vec2<double> zoom = 1.0 / from.lens->tangents;
    const double shift = from.lens->shift;
    const auto beyond = [&](double slope, double x, double ahead) {
      return slope * x > ahead * centre.z + std::hypot(slope, ahead) * radius;
    };
    return centre.z >= -radius && !beyond(zoom.x, centre.x, 1 - shift) && !beyond(-zoom.x, centre.x, 1 + shift) &&
           !beyond(zoom.y, centre.y, 1) && !beyond(-zoom.y, centre.y, 1);
  }
  const Projection p = from.to;
  if (image_shape(p) == ImageShape::plane)
    return centre.z >= -radius && std::max(std::abs(centre.x), std::abs(centre.y)) - centre.z <= std::sqrt(2.0) * radius;
  const double distance = glm::length(centre);
  if (image_shape(p) != ImageShape::disc || distance <= radius) return true;
  return std::atan2(std::hypot(centre.x, centre.y), centre.z) - std::asin(radius / distance) <= reach(p) + 0.01;
}

// What a group's mirror shows; null for what is none, or has no map yet.
const MirrorMap* map_of(const Group& group, const Shot& shot) {
  if (group.mirror < 0 || shot.mirrors.empty()) return nullptr;
  const MirrorMap& map = shot.mirrors[group.mirror];
  return map.texture ? &map : nullptr;
}

// What there is where there is no environment.
const Environment& darkness() {
  static const Environment black = [] {
    EnvironmentMap map;
    map.levels.emplace_back(Projection::cube, 1);
    return Environment(std::move(map), 1);
  }();
  return black;
}

void finish_drawing() {
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  gl::check("drawing");
}

}  // namespace

MapTexture::MapTexture(Projection p, int n)
    : projection(p),
      width(n * aspect(p)),
      size(n),
      texture(gl::make_texture(p == Projection::cube ? GL_TEXTURE_CUBE_MAP : GL_TEXTURE_2D_ARRAY)) {
  check_face(width, n);
  if (p == Projection::cube)
    glTextureStorage2D(texture, 1, GL_RGBA32F, n, n);
  else
    glTextureStorage3D(texture, 1, GL_RGBA32F, width, n, faces(p));
  gl::interpolate(texture);
  glClearTexImage(texture, 0, GL_RGBA, GL_FLOAT, nullptr);
  gl::check("map");
}

MapTexture::MapTexture(int w, int n)
    : projection(Projection::latlong), width(w), size(n), texture(gl::make_texture(GL_TEXTURE_2D_ARRAY)) {
  check_face(w, n);
  glTextureStorage3D(texture, 1, GL_RGBA32F, w, n, 1);
  gl::check("picture");
}

Renderer::Renderer(const Scene& scene, const Environment* environment, std::vector<int> mirrors)
    : mirrors_(std::move(mirrors)),
      gpu_(scene, mirrors_),
      environment_(upload((environment != nullptr ? *environment : darkness()).map)),
      light_(upload((environment != nullptr ? *environment : darkness()).light)),
      split_sum_(upload_split_sum()),
      background_(background_program(environment_.projection)) {
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
}

const gl::Program& Renderer::shading(const Group& group, const Shot& shot) {
  int textures = 0;
  for (std::size_t k = 0; k < group.textures.size(); ++k) textures |= group.textures[k] >= 0 ? 1 << k : 0;
  Shading wanted{.environment = environment_.projection, .textures = textures};
  if (const MirrorMap* mirror = map_of(group, shot)) {
    wanted.mirror = mirror->texture->projection;
    wanted.lookup = shot.look.lookup;
  }
  gl::Program& program = shading_[wanted];
  if (program == 0) program = shading_program(wanted);
  return program;
}

// What shines on a group from all round: the environment and ambient light, or the group's own map as far as that goes.
void Renderer::set_light(const gl::Program& program, const MirrorMap* mirror, const Viewpoint& from, const Shot& shot) const {
  const bool own = mirror != nullptr && mirror->glossy;
  const LightTexture& light = own ? *mirror->glossy : light_;
  const Colour none(0);
  gl::set(program, "shadows", shot.shadows ? 1 : 0);
  // A map of its own shows what is round it.
  gl::set(program, "distant_count", own ? 0 : static_cast<int>(shot.distant.size()));
  gl::set(program, "ambient", own ? none : shot.ambient);
  gl::set(program, "reflected_ambient", mirror != nullptr ? none : shot.ambient);
  gl::set(program, "blur", mirror != nullptr && !own ? 0.0F : 1.0F);
  glProgramUniform3fv(program, glGetUniformLocation(program, "irradiance"), 9, &light.irradiance[0].x);
  glBindTextureUnit(unit_glossy, light.glossy);
  if (mirror == nullptr) return;
  gl::set(program, "to_mirror", floats(glm::transpose(mirror->axes)));
  gl::set(program, "from_middle", Colour(from.at - mirror->at));
  gl::set(program, "tinted", shot.look.tinted ? 1 : 0);
  glBindTextureUnit(unit_mirror, mirror->texture->texture);
}

const gl::Program& Renderer::visibility(DrawMethod method, Projection p, bool holes) {
  gl::Program& program = visibility_[{method, p, holes}];
  if (program == 0) program = visibility_program(method, p, holes);
  return program;
}

const gl::Texture& Renderer::rays(const Viewpoint& from, int face, int sample) {
  if (from.lens) return sample_rays_ = make_rays(*from.lens, from.size, sample_offset(sample, from.samples));
  if (from.samples > 1) return sample_rays_ = make_rays(from.to, from.size, face, sample_offset(sample, from.samples));
  gl::Texture& known = rays_[{from.to, from.size, face}];
  if (known == 0) known = make_rays(from.to, from.size, face, Vec2<double>(0));
  return known;
}

void Renderer::find_surfaces(const Viewpoint& from, const Shot& shot, DrawMethod method, int face, int sample) {
  const Projection image = from.lens ? Projection::cube : from.to;
  const bool tessellated = method == DrawMethod::tessellate && image_shape(image) == ImageShape::disc;
  const Rotation to_face = from.lens ? Rotation(1, 0, 0, 0, 1, 0, 0, 0, -1) : map_to_face(from.to, face);
  const Vec2<double> tangents = from.lens ? from.lens->tangents : Vec2<double>(1);
  // The near plane touches the near sphere from inside, at the corners.
  const double nearest = 0.98 * from.near / std::sqrt(1 + glm::dot(tangents, tangents));
  const glm::vec4 frame(1.0 / tangents.x, 1.0 / tangents.y, from.lens ? from.lens->shift : 0, nearest);
  glBindFramebuffer(GL_FRAMEBUFFER, canvas_->seen);
  glViewport(0, 0, canvas_->width, canvas_->height);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_GREATER);
  glEnable(GL_STENCIL_TEST);
  glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
  glStencilMask(0xff);
  glDisable(GL_BLEND);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  constexpr std::array<GLuint, 4> nothing{};
  glClearNamedFramebufferuiv(canvas_->seen, GL_COLOR, 0, nothing.data());
  glClearNamedFramebufferfi(canvas_->seen, GL_DEPTH_STENCIL, 0, 0, 0);
  glPatchParameteri(GL_PATCH_VERTICES, 3);
  const std::array<float, 2> range{static_cast<float>(from.near), static_cast<float>(from.far)};
  const std::array<float, 2> pixel{2.0F / static_cast<float>(canvas_->width), 2.0F / static_cast<float>(canvas_->height)};
  const Vec2<double> offset = sample_offset(sample, from.samples);
  const std::array<float, 2> shift{-static_cast<float>(offset.x) * pixel[0], -static_cast<float>(offset.y) * pixel[1]};
  for (const bool holes : {false, true}) {
    const gl::Program* program = nullptr;
    for (std::size_t k = 0; k < gpu_.parts().size(); ++k) {
      const Part& part = gpu_.parts()[k];
      const Placed& placed = gpu_.placed()[k];
      if (part.holes != holes || part.indices == 0) continue;
      if (from.without >= 0 && lies_under(shot.scene, part.node, from.without)) continue;
      if (glm::length(placed.ball.centre) - placed.ball.radius > from.far) continue;
      if (from.cull && !in_face(from, to_face * placed.ball.centre, placed.ball.radius)) continue;
      if (program == nullptr) {
        program = &visibility(method, image, holes);
        gl::set(*program, "range", range);
        gl::set(*program, "pixel", pixel);
        gl::set(*program, "shift", shift);
        gl::set(*program, "to_face", floats(to_face));
        gl::set(*program, "frame", frame);
        gl::set(*program, "singularity", singularity(image));
        gl::set(*program, "tolerance", static_cast<float>(tessellation_tolerance));
        glUseProgram(*program);
      }
      if (holes) {
        const Group& group = gpu_.groups()[part.group];
        gpu_.bind(group);
        gl::set(*program, "material", part.material);
        gl::set(*program, "textured", group.is_painted() ? 1 : 0);
      }
      gl::set(*program, "to_map", placed.to_map);
      gl::set(*program, "instance", static_cast<int>(k));
      gl::set(*program, "first_triangle", static_cast<int>(part.first_index / 3));
      gl::set(*program, "facing", part.double_sided ? 0 : placed.mirrored ? -1 : 1);
      glStencilFunc(GL_ALWAYS, part.stencil, 0xff);
      // Exact sees to its sides itself. Images that show the world mirrored turn those of the others round.
      (method == DrawMethod::exact || part.double_sided ? glDisable : glEnable)(GL_CULL_FACE);
      glFrontFace((glm::determinant(to_face) < 0) != placed.mirrored ? GL_CW : GL_CCW);
      tessellated ? gpu_.draw_patches(part) : gpu_.draw(part);
    }
  }
  glDisable(GL_CULL_FACE);
}

// The texels of a layer whose stencil says so.
void Renderer::begin_shading(const MapTexture& to, int face, int sample) {
  glNamedFramebufferTextureLayer(canvas_->lit, GL_COLOR_ATTACHMENT0, to.texture, 0, to.layer(face));
  glBindFramebuffer(GL_FRAMEBUFFER, canvas_->lit);
  glViewport(0, 0, canvas_->width, canvas_->height);
  glDisable(GL_DEPTH_TEST);
  glDepthMask(GL_FALSE);
  glEnable(GL_STENCIL_TEST);
  glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
  glStencilMask(0);
  // Radiance of all samples, distance of the first.
  (sample > 0 ? glEnable : glDisable)(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, sample > 0 ? GL_FALSE : GL_TRUE);
  glBindTextureUnit(unit_environment, environment_.texture);
  glBindTextureUnit(unit_surfaces, canvas_->surfaces);
  glBindTextureUnit(unit_split_sum, split_sum_);
}

void Renderer::light(const gl::Program& program, const Viewpoint& from, int stencil) const {
  gl::set(program, "to_world", floats(from.axes));
  gl::set(program, "to_environment", floats(environment_.to_map));
  gl::set(program, "weight", static_cast<float>(1.0 / from.samples));
  gl::set(program, "spread", static_cast<float>(1 / std::sqrt(from.samples)));
  gl::set(program, "light_count", gpu_.lights());
  glUseProgram(program);
  glStencilFunc(GL_EQUAL, stencil, 0xff);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void Renderer::shade_background(const Viewpoint& from, const Shot& shot) {
  gl::set(background_, "behind", from.show_ambient ? shot.ambient : Colour(0));
  light(background_, from, 0);
}

void Renderer::shade_group(const Viewpoint& from, const Shot& shot, std::size_t k) {
  const Group& group = gpu_.groups()[k];
  // What is left out is not shaded: its map may be what is being drawn.
  if (group.mirror >= 0 && lies_under(shot.scene, mirrors_[group.mirror], from.without))
    return;
  gpu_.bind(group);
  const gl::Program& program = shading(group, shot);
  set_light(program, map_of(group, shot), from, shot);
  light(program, from, static_cast<int>(1 + k));
}

// Maps that are not of this moment yet.
void Renderer::draw_shadows(const Shot& shot) {
  if (shot.shadows && gpu_.lights() > 0 && !shadows_.are_of(shot.pose))
    shadows_.draw(gpu_, shot, light_images(placed_lights(shot.scene, shot.pose), bounds(shot.scene, shot.pose)));
  if (shot.distant.empty() || distant_shadows_.are_of(shot.pose)) return;
  const Ball ball = bounds(shot.scene, shot.pose);
  std::vector<LightFace> faces;
  std::vector<glm::vec4> light;
  for (const DistantLight& each : shot.distant) {
    faces.push_back(parallel_image(-each.from, ball));
    light.emplace_back(each.irradiance, 0);
  }
  light.resize(most_distant_lights);  // A block has its size.
  distant_lights_ = gl::make_buffer(light);
  distant_shadows_.draw(gpu_, shot, std::move(faces));
}

void Renderer::bind_shadows(const Shot& shot, const Direction& eye) const {
  if (shot.shadows) shadows_.bind(eye, unit_shadows, GL_SHADER_STORAGE_BUFFER, buffer_light_faces);
  if (shot.distant.empty()) return;
  distant_shadows_.bind(eye, unit_distant_shadows, GL_UNIFORM_BUFFER, block_distant_faces);
  glBindBufferBase(GL_UNIFORM_BUFFER, block_distant_lights, distant_lights_);
}

void Renderer::prepare_canvas(const Viewpoint& from) {
  const int width = from.lens ? from.lens->width : from.size * aspect(from.to);
  if (!canvas_ || canvas_->width != width || canvas_->height != from.size) canvas_.emplace(width, from.size);
}

void Renderer::draw(const Viewpoint& from, const Shot& shot, DrawMethod method, MapTexture& to,
                    std::vector<std::uint32_t>* surfaces) {
  if (!from.lens && !can_draw(method, from.to))
    throw UsageError(
        fmt::format("{} cannot draw {} maps", draw_method_names[static_cast<std::size_t>(method)], name(from.to)));
  prepare_canvas(from);
  const std::size_t texels = static_cast<std::size_t>(canvas_->width) * static_cast<std::size_t>(from.size);
  std::vector<glm::uvec2> seen;
  draw_shadows(shot);
  gpu_.place(shot.scene, shot.pose, from.at, from.axes);
  gpu_.bind();
  bind_shadows(shot, from.at);
  const int count = from.lens ? 1 : faces(from.to);
  for (int face = 0; face < count; ++face) {
    if ((from.which >> face & 1U) == 0) continue;
    for (int sample = 0; sample < from.samples; ++sample) {
      glBindTextureUnit(unit_rays, rays(from, face, sample));
      find_surfaces(from, shot, method, face, sample);
      if (surfaces != nullptr && sample == 0) {
        seen.resize(texels);
        glGetTextureImage(canvas_->surfaces, 0, GL_RG_INTEGER, GL_UNSIGNED_INT, static_cast<GLsizei>(8 * texels),
                          seen.data());
        surfaces->resize(texels * static_cast<std::size_t>(count));
        for (std::size_t k = 0; k < texels; ++k) (*surfaces)[static_cast<std::size_t>(face) * texels + k] = seen[k].x;
      }
      begin_shading(to, face, sample);
      shade_background(from, shot);
      for (std::size_t k = 0; k < gpu_.groups().size(); ++k) shade_group(from, shot, k);
    }
  }
  finish_drawing();
}

void Renderer::draw_background(const Viewpoint& from, const Shot& shot, MapTexture& to) {
  prepare_canvas(from);
  gpu_.bind();
  for (int face = 0; face < faces(from.to); ++face) {
    if ((from.which >> face & 1U) == 0) continue;
    glBindTextureUnit(unit_rays, rays(from, face, 0));
    glStencilMask(0xff);
    glClearNamedFramebufferfi(canvas_->seen, GL_DEPTH_STENCIL, 0, 0, 0);
    begin_shading(to, face, 0);
    shade_background(from, shot);
  }
  finish_drawing();
}

}  // namespace envmap

#include "envmap/scenes/render/renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/map/image_view.h"
#include "envmap/operate/convert.h"
#include "envmap/scenes/render/choose_drawing.h"
#include "envmap/scenes/render/face_image.h"

namespace envmap {

// Prefiltered levels of a map of a mirror.

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
  const gl::Program& program = programs_->level(map.projection);
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

// Reading back what was drawn.

namespace {

constexpr float nowhere = std::numeric_limits<float>::infinity();

// A cube of the same size, which is at least as dense as any of the others nearly everywhere, and the bilinear filter.
// Distance and surface are those of the cube's texel in that direction.
Drawn resample(Renderer& renderer, const Viewpoint& from, const FrameState& shot) {
  Viewpoint all_round = from;
  all_round.to = Projection::cube;
  Drawn cube = draw(renderer, all_round, shot, DrawMethod::distort);
  Drawn out{convert(cube.radiance, {.to = from.to, .size = from.size, .filter = Filter::bilinear}), {}, {}, 0};
  const int width = from.size * aspect(from.to);
  out.distances.assign(ImageView<float>::count(width, from.size, faces(from.to)), nowhere);
  out.surfaces.assign(out.distances.size(), 0);
  const ImageView<const float> cube_distances(cube.distances, from.size, from.size, 6);
  const ImageView<const std::uint32_t> cube_surfaces(cube.surfaces, from.size, from.size, 6);
  const ImageView<float> distances(out.distances, width, from.size, faces(from.to));
  const ImageView<std::uint32_t> surfaces(out.surfaces, width, from.size, faces(from.to));
  parallel_for(faces(from.to) * from.size, [&](int line) {
    const int face = line / from.size, row = line % from.size;
    const Columns in = columns(from.to, from.size, row);
    std::vector<Direction> rays(in.count());
    texel_directions(from.to, from.size, face, row, in.first, rays);
    std::vector<Location<double>> places(rays.size());
    locate(Projection::cube, rays, places);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const auto at = [&](double u) { return std::min(int(u * from.size), from.size - 1); };
      const int i = at(places[k].u), j = at(places[k].v);
      in.of(distances.row(face, row))[k] = cube_distances(places[k].face, i, j);
      in.of(surfaces.row(face, row))[k] = cube_surfaces(places[k].face, i, j);
    }
  });
  return out;
}

}  // namespace

EnvironmentMap read_back(const MapTexture& map, std::vector<float>* distances) {
  EnvironmentMap out;
  Level& level = out.levels.emplace_back(map.projection, map.size);
  if (distances != nullptr) distances->resize(ImageView<float>::count(level.width(), level.height(), level.faces()));
  std::vector<glm::vec4> drawn(ImageView<glm::vec4>::count(level.width(), level.height()));
  const ImageView<const glm::vec4> image(drawn, level.width(), level.height());
  for (int face = 0; face < level.faces(); ++face) {
    glGetTextureSubImage(map.texture, 0, 0, 0, map.layer(face), level.width(), level.height(), 1, GL_RGBA, GL_FLOAT,
                         static_cast<GLsizei>(drawn.size() * sizeof(glm::vec4)), drawn.data());
    parallel_for(level.height(), [&](int row) {
      std::ranges::transform(image.row(0, row), level.row(face, row).begin(),
                             [](const glm::vec4& t) { return Colour(t); });
      if (distances == nullptr) return;
      const ImageView<float> to(*distances, level.width(), level.height(), level.faces());
      std::ranges::transform(image.row(0, row), to.row(face, row).begin(),
                             [](const glm::vec4& t) { return t.w < 100 * least_nearness ? nowhere : 1 / t.w; });
    });
  }
  gl::check("reading a map back");
  return out;
}

Drawn draw(Renderer& renderer, const Viewpoint& from, const FrameState& shot, DrawMethod method) {
  if (method == DrawMethod::resample && from.to != Projection::cube) return resample(renderer, from, shot);
  if (method == DrawMethod::resample) method = DrawMethod::distort;
  MapTexture map(from.to, from.size);
  Drawn out;
  out.missing_solid_angle = renderer.draw(from, shot, method, map, &out.surfaces);
  out.radiance = read_back(map, &out.distances);
  return out;
}

namespace {

// What a group's mirror shows; null for what is none, or has no map yet.
const MirrorMap* map_of(const Group& group, const FrameState& shot) {
  if (group.mirror < 0 || shot.mirrors.empty()) return nullptr;
  const MirrorMap& map = shot.mirrors[group.mirror];
  return map.texture ? &map : nullptr;
}

// What it shows in this picture; null for what shows a map or the environment.
const MapTexture* reflection_of(const Group& group, const FrameState& shot) {
  return group.mirror < 0 || shot.reflections.empty() ? nullptr : shot.reflections[group.mirror];
}

// Whether what a group reflects counts as its image in the map that is drawn, whether it has a map itself yet or not.
bool shows_image(const Group& group, const FrameState& shot) {
  return shot.look.images && group.mirror >= 0 && !shot.mirrors.empty() && shot.mirrors[group.mirror].metal &&
         shot.mirrors[group.mirror].flat;
}

// What there is where there is no environment.
const Environment& darkness() {
  static const Environment black = [] {
    EnvironmentMap map;
    map.levels.emplace_back(Projection::cube, 1);
    return Environment(std::move(map), 1, {}, {1});
  }();
  return black;
}

// What distort.geom.glsl counted, in steradians.
double counted(const gl::Buffer& missing) {
  GLuint units = 0;
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(missing, 0, sizeof(units), &units);
  return std::ldexp(units, -20);
}

void finish_drawing() {
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  gl::check("drawing");
}

}  // namespace

MapTexture::MapTexture(Projection p, int n, int count)
    : projection(p),
      width(n * aspect(p)),
      size(n),
      levels(count),
      texture(gl::make_texture(p == Projection::cube ? GL_TEXTURE_CUBE_MAP : GL_TEXTURE_2D_ARRAY)) {
  check_face(width, n);
  if (p == Projection::cube)
    glTextureStorage2D(texture, levels, GL_RGBA32F, n, n);
  else
    glTextureStorage3D(texture, levels, GL_RGBA32F, width, n, faces(p));
  gl::interpolate(texture);
  if (levels > 1) glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glClearTexImage(texture, 0, GL_RGBA, GL_FLOAT, nullptr);
  gl::check("map");
}

MapTexture::MapTexture(int w, int n)
    : projection(Projection::latlong), width(w), size(n), texture(gl::make_texture(GL_TEXTURE_2D_ARRAY)) {
  check_face(w, n);
  glTextureStorage3D(texture, 1, GL_RGBA32F, w, n, 1);
  gl::check("picture");
}

Renderer::Renderer(const SceneGraph& scene, const Environment* environment, std::vector<int> mirrors,
                   std::shared_ptr<ProgramCache> programs)
    : programs_(programs ? std::move(programs) : std::make_shared<ProgramCache>()),
      mirrors_(std::move(mirrors)),
      gpu_(scene, mirrors_,
           environment != nullptr ? sun_lights(environment->light.suns, maps_per_sun) : std::vector<PlacedLight>{}),
      shadows_(programs_),
      distant_shadows_(programs_),
      environment_(upload((environment != nullptr ? *environment : darkness()).map)),
      light_(upload((environment != nullptr ? *environment : darkness()).light)),
      split_sum_(upload_split_sum()) {
  if (std::ranges::any_of(gpu_.groups(), &Group::sheen)) sheen_table_ = upload_sheen_table();
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
}

void Renderer::update(const SceneGraph& scene, int mesh) {
  gpu_.update(scene, mesh);
  if (!casts_shadow(scene.materials[scene.meshes[mesh].material])) return;
  shadows_.forget();
  distant_shadows_.forget();
}

const gl::Program& Renderer::shading(const Group& group, const FrameState& shot) {
  int textures = 0;
  for (std::size_t k = 0; k < group.textures.size(); ++k) textures |= group.textures[k] >= 0 ? 1 << k : 0;
  Shading wanted{.environment = environment_.projection,
                 .textures = textures,
                 .coated = group.coated,
                 .sheen = group.sheen,
                 .sampled = light_of(group, shot).sampled != 0};
  if (reflection_of(group, shot) != nullptr) {
    wanted.by_picture = true;
  } else if (const MirrorMap* mirror = map_of(group, shot)) {
    wanted.mirror = mirror->texture->projection;
    wanted.lookup = shot.look.lookup;
  }
  return programs_->shading(wanted);
}

// The environment's, or that of a rough mirror's own map.
const LightTexture& Renderer::light_of(const Group& group, const FrameState& shot) const {
  const MirrorMap* mirror = reflection_of(group, shot) == nullptr ? map_of(group, shot) : nullptr;
  return mirror != nullptr && mirror->glossy ? *mirror->glossy : light_;
}

// What shines on a group from all round: the environment and ambient light, or the group's own map as far as that goes.
void Renderer::set_light(const gl::Program& program, const Group& group, const Viewpoint& from,
                         const FrameState& shot) const {
  const MapTexture* picture = reflection_of(group, shot);
  const MirrorMap* mirror = picture == nullptr ? map_of(group, shot) : nullptr;
  const bool image = shows_image(group, shot);
  const LightTexture& light = light_of(group, shot);
  const bool own = &light != &light_;
  const Colour none(0);
  // Of punctual lights a mirror without roughness shows glints that are smaller than texels,
  // and not where the image is.
  // A map of its own shows what is round it, suns, too.
  gl::set(program, "light_count", image ? 0 : gpu_.lights() + (own ? 0 : gpu_.suns()));
  gl::set(program, "shadows", shot.shadows ? 1 : 0);
  gl::set(program, "distant_count", own ? 0 : int(shot.distant.size()));
  gl::set(program, "ambient", own ? none : shot.ambient);
  gl::set(program, "reflected_ambient", mirror != nullptr || picture != nullptr ? none : shot.ambient);
  gl::set(program, "blur", (mirror != nullptr && !own) || picture != nullptr ? 0.0F : 1.0F);
  glProgramUniform3fv(program, glGetUniformLocation(program, "irradiance"), 9, &light.irradiance[0].x);
  glProgramUniform1fv(program, glGetUniformLocation(program, "glossy_roughness"), GLsizei(light.roughnesses.size()),
                      light.roughnesses.data());
  glProgramUniform1fv(program, glGetUniformLocation(program, "glossy_mip"), GLsizei(light.mips.size()),
                      light.mips.data());
  gl::set(program, "glossy_count", int(light.roughnesses.size()));
  glBindTextureUnit(unit_glossy, light.glossy);
  glBindTextureUnit(unit_sampled, light.sampled);
  if (picture != nullptr) glBindTextureUnit(unit_mirror, picture->texture);
  if (mirror == nullptr) return;
  gl::set(program, "to_mirror", glm::transpose(mirror->axes));
  gl::set(program, "from_middle", Colour(from.at - mirror->at));
  gl::set(program, "images", image ? 1 : 0);
  gl::set(program, "behind", shot.ambient);
  gl::set(program, "environment_texel", float(environment_.texel));
  gl::set(program, "tinted", shot.look.tinted ? 1 : 0);
  glBindTextureUnit(unit_mirror, mirror->texture->texture);
}

const gl::Texture& Renderer::rays(const Viewpoint& from, int face, int sample) {
  sample_below_ = float(sample_offset(sample, from.samples).y);
  if (from.lens) return sample_rays_ = make_rays(*from.lens, from.size, sample_offset(sample, from.samples));
  if (from.samples > 1) return sample_rays_ = make_rays(from.to, from.size, face, sample_offset(sample, from.samples));
  gl::Texture& known = rays_[{from.to, from.size, face}];
  if (known == 0) known = make_rays(from.to, from.size, face, Vec2<double>(0));
  return known;
}

// Samples are added: radiance of all of them, distance of the first.
void Renderer::bind_map(const MapTexture& to, int face, int sample) const {
  glNamedFramebufferTextureLayer(canvas_->lit, GL_COLOR_ATTACHMENT0, to.texture, 0, to.layer(face));
  glBindFramebuffer(GL_FRAMEBUFFER, canvas_->lit);
  (sample > 0 ? glEnable : glDisable)(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, sample > 0 ? GL_FALSE : GL_TRUE);
}

// Where something is blended, a sample comes to be by itself first.
void Renderer::bind_sample() const {
  glNamedFramebufferTexture(canvas_->lit, GL_COLOR_ATTACHMENT0, layers_->sample, 0);
  glBindFramebuffer(GL_FRAMEBUFFER, canvas_->lit);
  glDisable(GL_BLEND);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

// The texels whose stencil says so.
void Renderer::begin_shading() const {
  glViewport(0, 0, canvas_->width, canvas_->height);
  glDisable(GL_DEPTH_TEST);
  glDepthMask(GL_FALSE);
  glEnable(GL_STENCIL_TEST);
  glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
  glStencilMask(0);
  glBindTextureUnit(unit_environment, environment_.texture);
  glBindTextureUnit(unit_surfaces, canvas_->surfaces);
  glBindTextureUnit(unit_split_sum, split_sum_);
  glBindTextureUnit(unit_sheen_table, sheen_table_);
}

void Renderer::light(const gl::Program& program, const Viewpoint& from, int stencil) const {
  gl::set(program, "to_world", from.axes);
  gl::set(program, "to_environment", environment_.to_map);
  gl::set(program, "weight", layers_ ? 1.0F : float(1.0 / from.samples));
  gl::set(program, "spread", float(1 / std::sqrt(from.samples)));
  gl::set(program, "below_centre", sample_below_);
  glUseProgram(program);
  glStencilFunc(GL_EQUAL, stencil, 0xff);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void Renderer::shade_background(const Viewpoint& from, const FrameState& shot) {
  const gl::Program& program = programs_->background(environment_.projection);
  gl::set(program, "behind", from.show_ambient ? shot.ambient : Colour(0));
  gl::set(program, "environment_texel", from.mean_background ? float(environment_.texel) : 1e9F);
  light(program, from, 0);
}

void Renderer::shade_group(const Viewpoint& from, const FrameState& shot, std::size_t k, bool blended) {
  const Group& group = gpu_.groups()[k];
  if (group.blended != blended) return;
  // What is left out is not shaded: its map may be what is being drawn.
  if (group.mirror >= 0 && lies_under(shot.scene, mirrors_[group.mirror], from.without)) return;
  gpu_.bind(group);
  const gl::Program& program = shading(group, shot);
  set_light(program, group, from, shot);
  gl::set(program, "blended", blended ? 1 : 0);
  light(program, from, int(1 + k));
}

// Maps that are not of this moment yet.
void Renderer::draw_shadows(const FrameState& shot) {
  if (shot.shadows && gpu_.lights() + gpu_.suns() > 0 && !shadows_.are_of(shot.pose))
    shadows_.draw(gpu_, shot, shadow_views(gpu_.lights_at(shot.scene, shot.pose), bounds(shot.scene, shot.pose)));
  if (shot.distant.empty() || distant_shadows_.are_of(shot.pose)) return;
  const Ball ball = bounds(shot.scene, shot.pose);
  std::vector<ShadowView> faces;
  std::vector<glm::vec4> light;
  for (const DistantLight& each : shot.distant) {
    faces.push_back(parallel_image(-each.from, ball));
    light.emplace_back(each.irradiance, 0);
  }
  light.resize(max_distant_lights);  // A block has its size.
  distant_lights_ = gl::make_buffer(light);
  distant_shadows_.draw(gpu_, shot, std::move(faces));
}

void Renderer::bind_shadows(const FrameState& shot, const Direction& eye) const {
  if (shot.shadows) shadows_.bind(eye, unit_shadows, GL_SHADER_STORAGE_BUFFER, buffer_shadow_views);
  if (shot.distant.empty()) return;
  distant_shadows_.bind(eye, unit_distant_shadows, GL_UNIFORM_BUFFER, block_distant_faces);
  glBindBufferBase(GL_UNIFORM_BUFFER, block_distant_lights, distant_lights_);
}

void Renderer::prepare_canvas(const Viewpoint& from) {
  const int width = from.lens ? from.lens->width : from.size * aspect(from.to);
  if (!canvas_ || canvas_->width != width || canvas_->height != from.size) {
    canvas_.emplace(width, from.size);
    layers_.reset();
  }
  if (gpu_.blends() && !layers_) layers_.emplace(*canvas_);
}

double Renderer::draw(const Viewpoint& from, const FrameState& shot, DrawMethod method, MapTexture& to,
                      std::vector<std::uint32_t>* surfaces) {
  if (!from.lens && !can_draw(method, from.to))
    throw UsageError(fmt::format("{} cannot draw {} maps", draw_method_names[std::size_t(method)], name(from.to)));
  prepare_canvas(from);
  const std::size_t texels = std::size_t(canvas_->width) * std::size_t(from.size);
  std::vector<glm::uvec2> seen;
  draw_shadows(shot);
  gpu_.place(shot.scene, shot.pose, from.at, from.axes);
  gpu_.bind();
  bind_shadows(shot, from.at);
  // Images of planes lack nothing, and reading back waits for the card.
  const bool may_lack = method != DrawMethod::exact && !from.lens && image_shape(from.to) == ImageShape::disc;
  gl::Buffer missing;
  if (may_lack) {
    missing = gl::make_buffer(std::vector<GLuint>{0});
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, buffer_missing, missing);
  }
  const int count = from.lens ? 1 : faces(from.to);
  for (int face = 0; face < count; ++face) {
    if ((from.which >> face & 1U) == 0) continue;
    for (int sample = 0; sample < from.samples; ++sample) {
      glBindTextureUnit(unit_rays, rays(from, face, sample));
      find_surfaces(from, shot, method, {face, sample, canvas_->seen, false, sample == 0});
      if (surfaces != nullptr && sample == 0) {
        seen.resize(texels);
        glGetTextureImage(canvas_->surfaces, 0, GL_RG_INTEGER, GL_UNSIGNED_INT, static_cast<GLsizei>(8 * texels),
                          seen.data());
        surfaces->resize(texels * std::size_t(count));
        for (std::size_t k = 0; k < texels; ++k) (*surfaces)[std::size_t(face) * texels + k] = seen[k].x;
      }
      layers_ ? bind_sample() : bind_map(to, face, sample);
      begin_shading();
      shade_background(from, shot);
      for (std::size_t k = 0; k < gpu_.groups().size(); ++k) shade_group(from, shot, k, false);
      if (!layers_) continue;
      blend(from, shot, method, face, sample);
      add_sample(to, face, sample, from.samples);
    }
  }
  finish_drawing();
  return may_lack ? counted(missing) : 0;
}

void Renderer::draw_background(const Viewpoint& from, const FrameState& shot, MapTexture& to) {
  prepare_canvas(from);
  gpu_.bind();
  for (int face = 0; face < faces(from.to); ++face) {
    if ((from.which >> face & 1U) == 0) continue;
    glBindTextureUnit(unit_rays, rays(from, face, 0));
    glStencilMask(0xff);
    glClearNamedFramebufferfi(canvas_->seen, GL_DEPTH_STENCIL, 0, 0, 0);
    bind_map(to, face, 0);
    begin_shading();
    shade_background(from, shot);
  }
  finish_drawing();
}

}  // namespace envmap

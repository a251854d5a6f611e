#include "envmap/scenes/render/gpu_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "envmap/base/error.h"
#include "envmap/scenes/render/programs.h"
#include "envmap/scenes/render/shading/shading.h"
#include "envmap/scenes/render/shadow_view.h"

namespace envmap {
namespace {

// As the shaders read them: triangle.glsl and shading.glsl.
struct GpuCorner {
  glm::vec3 position;
  float u;
  glm::vec3 normal;
  float v;
  glm::vec4 colour;
};
static_assert(sizeof(GpuCorner) == corner_texels * sizeof(glm::vec4));
struct GpuInstance {
  std::array<glm::vec4, 3> to_map, normals;  // Rows.
};
struct GpuMaterial {
  glm::vec4 base_colour, emissive;
  float metallic, roughness, transmission, ior;
  glm::vec4 rest;   // How light bends (shading.glsl), Material::normal_scale, occlusion_strength.
  glm::vec4 sheen;  // And its roughness.
  glm::vec4 coat;   // How much, its roughness, Material::coat_normal_scale.
  glm::vec4 volume;  // Material::absorption and thickness.
};
static_assert(sizeof(GpuMaterial) == material_texels * sizeof(glm::vec4));
struct GpuLight {
  glm::vec4 position, direction, intensity, cone;
};

template <class T>
const T& at(const std::vector<T>& all, int index) {
  return all[index];
}

GLint wrap(Texture::Wrap w) {
  switch (w) {
    case Texture::Wrap::mirror: return GL_MIRRORED_REPEAT;
    case Texture::Wrap::clamp: return GL_CLAMP_TO_EDGE;
    case Texture::Wrap::repeat: break;
  }
  return GL_REPEAT;
}

gl::Texture upload(const Texture& image) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (std::max(image.width, image.height) > largest)
    throw UsageError(fmt::format("a texture of {}x{}: this renderer takes {}", image.width, image.height, largest));
  gl::Texture texture = gl::make_texture(GL_TEXTURE_2D);
  const int levels = 1 + int(std::log2(std::max(image.width, image.height)));
  glTextureStorage2D(texture, levels, image.srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8, image.width, image.height);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTextureSubImage2D(texture, 0, 0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE, image.texels.data());
  glGenerateTextureMipmap(texture);
  glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_S, wrap(image.wrap_u));
  glTextureParameteri(texture, GL_TEXTURE_WRAP_T, wrap(image.wrap_v));
  return texture;
}

// The sphere round the box of the vertices that are used.
void set_bounds(const Mesh& mesh, Part& part) {
  Vec3<double> low(1e300), high(-1e300);
  for (const glm::vec3& p : mesh.positions) {
    low = glm::min(low, Vec3<double>(p));
    high = glm::max(high, Vec3<double>(p));
  }
  part.centre = 0.5 * (low + high);
  part.radius = mesh.positions.empty() ? 0 : 0.5 * glm::length(high - low);
}

std::vector<GpuMaterial> materials_of(const SceneGraph& scene) {
  std::vector<GpuMaterial> all;
  for (const Material& m : scene.materials)
    all.push_back({m.base_colour,
                   {m.emissive, m.alpha_cutoff},
                   m.metallic,
                   m.roughness,
                   m.transmission,
                   m.ior,
                   glm::vec4(m.solid ? 1 / std::max(1.0F, m.ior) : 1, m.normal_scale, m.occlusion_strength, 0),
                   glm::vec4(m.sheen, m.sheen_roughness),
                   glm::vec4(m.coat, m.coat_roughness, m.coat_normal_scale, 0),
                   glm::vec4(m.absorption, m.thickness)});
  return all;
}

int mirror_of(const SceneGraph& scene, int node, std::span<const int> mirrors) {
  for (std::size_t k = 0; k < mirrors.size(); ++k)
    if (lies_under(scene, node, mirrors[k])) return int(k);
  return -1;
}

int group_of(const Material& m, int mirror, std::vector<Group>& groups) {
  const Group group{{m.base_colour_texture, m.metallic_roughness_texture, m.emissive_texture, m.normal_texture,
                     m.occlusion_texture, m.coat_texture, m.coat_roughness_texture, m.coat_normal_texture,
                     m.sheen_texture, m.sheen_roughness_texture},
                    mirror,
                    m.blended,
                    m.coat > 0,
                    m.sheen != Colour(0)};
  const auto known = std::ranges::find(groups, group);
  const auto number = int(known - groups.begin());
  if (known == groups.end()) groups.push_back(group);
  return number;
}

void add_corners(const Mesh& mesh, std::vector<GpuCorner>& corners) {
  for (const std::uint32_t k : mesh.indices)
    corners.push_back({mesh.positions[k], mesh.coordinates[k].x, mesh.normals[k], mesh.coordinates[k].y,
                       mesh.colours.empty() ? glm::vec4(1) : mesh.colours[k]});
}

void add_tangents(const Mesh& mesh, std::vector<glm::vec4>& tangents) {
  for (const std::uint32_t k : mesh.indices)
    tangents.push_back(mesh.tangents.empty() ? glm::vec4(0) : mesh.tangents[k]);
}

bool has_tangents(const SceneGraph& scene) {
  return std::ranges::any_of(scene.meshes, [](const Mesh& mesh) { return !mesh.tangents.empty(); });
}

// Tangents of all corners. Empty if no mesh has tangents.
std::vector<glm::vec4> tangents_of(const SceneGraph& scene) {
  std::vector<glm::vec4> tangents;
  if (!has_tangents(scene)) return tangents;
  for (const Mesh& mesh : scene.meshes) add_tangents(mesh, tangents);
  return tangents;
}

// Elements of a buffer from a first one on.
template <class T>
void replace(const gl::Buffer& buffer, std::size_t first, const std::vector<T>& by) {
  glNamedBufferSubData(buffer, static_cast<GLintptr>(first * sizeof(T)), static_cast<GLsizeiptr>(by.size() * sizeof(T)),
                       by.data());
}

// Four floats a texel.
gl::Texture texels_of(const gl::Buffer& buffer) {
  gl::Texture texture = gl::make_texture(GL_TEXTURE_BUFFER);
  glTextureBuffer(texture, GL_RGBA32F, buffer);
  return texture;
}

GpuLight from_viewpoint(const PlacedLight& light, const Direction& eye, int first_face) {
  return {{glm::vec3(light.position - eye), float(light.kind)},
          {glm::vec3(light.direction), float(light.range)},
          {light.intensity, light.spread},
          {light.inner, light.outer, first_face, shadow_view_count(light)}};
}

}  // namespace

GpuScene::GpuScene(const SceneGraph& scene, std::span<const int> mirrors, std::vector<PlacedLight> suns)
    : lights_(int(scene.lights.size())), suns_(std::move(suns)) {
  std::vector<glm::vec3> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<GpuCorner> corners;
  for (const Mesh& mesh : scene.meshes) {
    const auto base = std::uint32_t(vertices.size());
    first_.push_back({vertices.size(), indices.size()});
    vertices.insert(vertices.end(), mesh.positions.begin(), mesh.positions.end());
    for (const std::uint32_t k : mesh.indices) indices.push_back(base + k);
    add_corners(mesh, corners);
  }
  for (const Instance& instance : instances(scene)) {
    const Mesh& mesh = at(scene.meshes, instance.mesh);
    const Material& material = at(scene.materials, mesh.material);
    const int group = group_of(material, mirror_of(scene, instance.node, mirrors), groups_);
    Part part{.node = instance.node,
              .mesh = instance.mesh,
              .indices = static_cast<GLsizei>(mesh.indices.size()),
              .first_index = at(first_, instance.mesh).index,
              .stencil = std::uint8_t(1 + group),
              .material = mesh.material,
              .group = group,
              .holes = material.alpha_cutoff > 0,
              .blended = material.blended,
              .double_sided = material.double_sided,
              .casts_shadow = casts_shadow(material)};
    set_bounds(mesh, part);
    parts_.push_back(part);
  }
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
  if (corner_texels * corners.size() > std::size_t(most))
    throw UsageError(
        fmt::format("{} triangles: this renderer takes {}", corners.size() / 3, most / (3 * corner_texels)));
  if (groups_.size() > 255)
    throw UsageError(
        fmt::format("materials with {} sets of textures and mirrors: this renderer takes 255", groups_.size()));
  vertices_ = gl::make_buffer(vertices, GL_DYNAMIC_STORAGE_BIT);
  indices_ = gl::make_buffer(indices);
  corners_ = gl::make_buffer(corners, GL_DYNAMIC_STORAGE_BIT);
  tangents_ = gl::make_buffer(tangents_of(scene), GL_DYNAMIC_STORAGE_BIT);
  materials_ = gl::make_buffer(materials_of(scene));
  instances_ = gl::make_buffer(nullptr, parts_.size() * sizeof(GpuInstance), GL_DYNAMIC_STORAGE_BIT);
  light_buffer_ =
      gl::make_buffer(nullptr, (scene.lights.size() + suns_.size()) * sizeof(GpuLight), GL_DYNAMIC_STORAGE_BIT);
  corner_texels_ = texels_of(corners_);
  tangent_texels_ = texels_of(tangents_);
  material_texels_ = texels_of(materials_);
  instance_texels_ = texels_of(instances_);
  for (const Texture& image : scene.textures) textures_.push_back(upload(image));
  layout_ = gl::make_vertex_array();
  glVertexArrayVertexBuffer(layout_, 0, vertices_, 0, sizeof(glm::vec3));
  glVertexArrayElementBuffer(layout_, indices_);
  glEnableVertexArrayAttrib(layout_, 0);
  glVertexArrayAttribFormat(layout_, 0, 3, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribBinding(layout_, 0, 0);
  gl::check("upload of the scene");
}

void GpuScene::update(const SceneGraph& scene, int number) {
  const Mesh& mesh = at(scene.meshes, number);
  const First& first = at(first_, number);
  std::vector<GpuCorner> corners;
  add_corners(mesh, corners);
  replace(vertices_, first.vertex, mesh.positions);
  replace(corners_, first.index, corners);
  if (has_tangents(scene)) {
    std::vector<glm::vec4> tangents;
    add_tangents(mesh, tangents);
    replace(tangents_, first.index, tangents);
  }
  for (Part& part : parts_)
    if (part.mesh == number) set_bounds(mesh, part);
  gl::check("upload of a mesh");
}

void GpuScene::place(const SceneGraph& scene, const Pose& pose, const Direction& eye, const Rotation& axes) {
  std::vector<GpuInstance> rows;
  placed_.clear();
  const Matrix turn(glm::transpose(axes));
  for (const Part& part : parts_) {
    // The difference of two places, in double: a map far from the world's origin is as sharp as one at it.
    Matrix world = at(pose, part.node);
    world[3] = {Direction(world[3]) - eye, 1};
    const Rotation linear(world);
    const double sign = glm::determinant(linear) < 0 ? -1 : 1;
    const Rotation normals = sign * cofactors(linear);
    // Frobenius' norm is at least the largest factor by which a length grows.
    double norm = 0;
    for (int axis = 0; axis < 3; ++axis) norm += glm::dot(linear[axis], linear[axis]);
    const Matrix to_map = turn * world;
    placed_.push_back(
        {glm::mat4(to_map),
         sign < 0,
         {Direction(to_map * glm::vec<4, double, glm::highp>(part.centre, 1)), std::sqrt(norm) * part.radius}});
    const glm::mat4 to_map_rows = glm::transpose(glm::mat4(to_map));
    const glm::mat3 normal_rows = glm::transpose(glm::mat3(normals));
    rows.push_back(
        {{to_map_rows[0], to_map_rows[1], to_map_rows[2]},
         {glm::vec4(normal_rows[0], part.material), glm::vec4(normal_rows[1], sign), glm::vec4(normal_rows[2], 0)}});
  }
  glNamedBufferSubData(instances_, 0, static_cast<GLsizeiptr>(rows.size() * sizeof(GpuInstance)), rows.data());
  std::vector<GpuLight> lights;
  int face = 0;
  for (const PlacedLight& light : lights_at(scene, pose)) {
    lights.push_back(from_viewpoint(light, eye, face));
    face += shadow_view_count(light);
  }
  glNamedBufferSubData(light_buffer_, 0, static_cast<GLsizeiptr>(lights.size() * sizeof(GpuLight)), lights.data());
}

std::vector<PlacedLight> GpuScene::lights_at(const SceneGraph& scene, const Pose& pose) const {
  std::vector<PlacedLight> all = placed_lights(scene, pose);
  all.insert(all.end(), suns_.begin(), suns_.end());
  return all;
}

void GpuScene::bind() const {
  glBindVertexArray(layout_);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, buffer_lights, light_buffer_);
  glBindTextureUnit(unit_corners, corner_texels_);
  glBindTextureUnit(unit_tangents, tangent_texels_);
  glBindTextureUnit(unit_instances, instance_texels_);
  glBindTextureUnit(unit_materials, material_texels_);
}

void GpuScene::bind(const Group& group) const {
  for (GLuint unit = unit_base_colour; const int texture : group.textures)
    glBindTextureUnit(unit++, texture < 0 ? 0 : static_cast<GLuint>(at(textures_, texture)));
}

void GpuScene::draw(const Part& part) const {
  glDrawElements(GL_TRIANGLES, part.indices, GL_UNSIGNED_INT,
                 reinterpret_cast<const void*>(part.first_index * sizeof(std::uint32_t)));
}

void GpuScene::draw_patches(const Part& part) const {
  glDrawArrays(GL_PATCHES, static_cast<GLint>(part.first_index), part.indices);
}

}  // namespace envmap

#include "envmap/render/gpu_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "envmap/error.h"

namespace envmap {
namespace {

// As the shaders declare them: std430 of instances.glsl, triangle.glsl and shading.glsl.
struct GpuVertex {
  glm::vec3 position, normal;
  glm::vec2 coordinates;
};
struct GpuInstance {
  glm::mat4 to_map, normals;
  std::int32_t material, first_index, facing, mirrored;
};
struct GpuMaterial {
  glm::vec4 base_colour, emissive;
  float metallic, roughness, transmission, ior;
  std::int32_t base_colour_texture, metallic_roughness_texture, emissive_texture, group;
};
struct GpuLight {
  glm::vec4 position, direction, intensity, cone;
};
static_assert(sizeof(GpuVertex) == 32 && sizeof(GpuInstance) == 144 && sizeof(GpuMaterial) == 64);

template <class T>
const T& at(const std::vector<T>& all, int index) {
  return all[static_cast<std::size_t>(index)];
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
  const int levels = 1 + static_cast<int>(std::log2(std::max(image.width, image.height)));
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

std::vector<GpuMaterial> materials_of(const Scene& scene, std::vector<Group>& groups) {
  std::vector<GpuMaterial> all;
  for (const Material& m : scene.materials) {
    const Group group{m.base_colour_texture, m.metallic_roughness_texture, m.emissive_texture};
    const auto known = std::ranges::find(groups, group);
    const auto number = static_cast<std::int32_t>(known - groups.begin());
    if (known == groups.end()) groups.push_back(group);
    all.push_back({m.base_colour,
                   {m.emissive, m.alpha_cutoff},
                   m.metallic,
                   m.roughness,
                   m.transmission,
                   m.ior,
                   m.base_colour_texture + 1,
                   m.metallic_roughness_texture + 1,
                   m.emissive_texture + 1,
                   number});
  }
  return all;
}

GpuLight light_of(const Light& light, const Matrix& world, const Direction& eye) {
  const Direction towards = -Direction(world[2]);
  return {{glm::vec3(Direction(world[3]) - eye), static_cast<float>(light.kind)},
          {glm::vec3(towards / std::max(1e-300, glm::length(towards))), static_cast<float>(light.range)},
          {light.intensity, 0},
          {static_cast<float>(std::cos(light.inner)), static_cast<float>(std::cos(light.outer)), 0, 0}};
}

}  // namespace

GpuScene::GpuScene(const Scene& scene) : lights_(static_cast<int>(scene.lights.size())) {
  std::vector<GpuVertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<std::size_t> first_index;
  for (const Mesh& mesh : scene.meshes) {
    const auto base = static_cast<std::uint32_t>(vertices.size());
    first_index.push_back(indices.size());
    for (std::size_t k = 0; k < mesh.positions.size(); ++k)
      vertices.push_back({mesh.positions[k], mesh.normals[k], mesh.coordinates[k]});
    for (const std::uint32_t index : mesh.indices) indices.push_back(base + index);
  }
  const std::vector<GpuMaterial> materials = materials_of(scene, groups_);
  for (const Instance& instance : instances(scene)) {
    const Mesh& mesh = at(scene.meshes, instance.mesh);
    Part part{.node = instance.node,
              .mesh = instance.mesh,
              .indices = static_cast<GLsizei>(mesh.indices.size()),
              .first_index = at(first_index, instance.mesh),
              .stencil = static_cast<std::uint8_t>(1 + at(materials, mesh.material).group % 255),
              .group = at(materials, mesh.material).group,
              .holes = at(scene.materials, mesh.material).alpha_cutoff > 0,
              .double_sided = at(scene.materials, mesh.material).double_sided};
    set_bounds(mesh, part);
    triangles_ += mesh.indices.size() / 3;
    parts_.push_back(part);
  }
  vertices_ = gl::make_buffer(vertices);
  indices_ = gl::make_buffer(indices);
  materials_ = gl::make_buffer(materials);
  instances_ = gl::make_buffer(nullptr, parts_.size() * sizeof(GpuInstance), GL_DYNAMIC_STORAGE_BIT);
  light_buffer_ = gl::make_buffer(nullptr, scene.lights.size() * sizeof(GpuLight), GL_DYNAMIC_STORAGE_BIT);
  for (const Texture& image : scene.textures) textures_.push_back(upload(image));
  layout_ = gl::make_vertex_array();
  glVertexArrayVertexBuffer(layout_, 0, vertices_, 0, sizeof(GpuVertex));
  glVertexArrayElementBuffer(layout_, indices_);
  glEnableVertexArrayAttrib(layout_, 0);
  glVertexArrayAttribFormat(layout_, 0, 3, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribBinding(layout_, 0, 0);
  gl::check("upload of the scene");
}

Ball GpuScene::ball(const Part& part, const Pose& pose) const {
  const Matrix& world = at(pose, part.node);
  // Frobenius' norm is at least the largest factor by which a length grows.
  double norm = 0;
  for (int axis = 0; axis < 3; ++axis) norm += glm::dot(Direction(world[axis]), Direction(world[axis]));
  return {Direction(world * glm::vec<4, double, glm::highp>(part.centre, 1)), std::sqrt(norm) * part.radius};
}

void GpuScene::place(const Scene& scene, const Pose& pose, const Direction& eye, const Rotation& axes) {
  std::vector<GpuInstance> placed;
  const Matrix turn(glm::transpose(axes));
  for (const Part& part : parts_) {
    // The difference of two places, in double: a map far from the world's origin is as sharp as one at it.
    Matrix world = at(pose, part.node);
    world[3] = {Direction(world[3]) - eye, 1};
    const Rotation linear(world);
    const bool mirrored = glm::determinant(linear) < 0;
    const Mesh& mesh = at(scene.meshes, part.mesh);
    const bool both = at(scene.materials, mesh.material).double_sided;
    // Cofactors: the inverse transpose but for a factor, and there for matrices that have no inverse.
    const Rotation normals(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                           glm::cross(linear[0], linear[1]));
    placed.push_back({glm::mat4(turn * world), glm::mat4(glm::mat3(mirrored ? -normals : normals)), mesh.material,
                      static_cast<std::int32_t>(part.first_index),
                      both       ? 0
                      : mirrored ? -1
                                 : 1,
                      mirrored});
  }
  glNamedBufferSubData(instances_, 0, static_cast<GLsizeiptr>(placed.size() * sizeof(GpuInstance)), placed.data());
  std::vector<GpuLight> lights;
  for (const Light& light : scene.lights) lights.push_back(light_of(light, at(pose, light.node), eye));
  glNamedBufferSubData(light_buffer_, 0, static_cast<GLsizeiptr>(lights.size() * sizeof(GpuLight)), lights.data());
}

void GpuScene::bind() const {
  glBindVertexArray(layout_);
  const GLuint buffers[] = {instances_, materials_, indices_, vertices_, light_buffer_};
  glBindBuffersBase(GL_SHADER_STORAGE_BUFFER, 0, 5, buffers);
}

void GpuScene::bind(const Group& group) const {
  const int wanted[] = {group.base_colour, group.metallic_roughness, group.emissive};
  for (GLuint unit = 1; const int texture : wanted) {
    glBindTextureUnit(unit, texture < 0 ? 0 : at(textures_, texture));
    ++unit;
  }
}

void GpuScene::draw(const Part& part, GLenum mode) const {
  glDrawElements(mode, part.indices, GL_UNSIGNED_INT,
                 reinterpret_cast<const void*>(part.first_index * sizeof(std::uint32_t)));
}

}  // namespace envmap

#include "envmap/render/raycast.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <memory>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/map/image_view.h"
#include "envmap/render/shading.h"
#include "envmap/render/texture_sample.h"

namespace envmap {
namespace {

using Device = std::unique_ptr<RTCDeviceTy, decltype(&rtcReleaseDevice)>;
using Tree = std::unique_ptr<RTCSceneTy, decltype(&rtcReleaseScene)>;

// A mesh in its place, the viewpoint at the origin, axes the world's; counter-clockwise from the front.
struct Placed {
  const Scene* scene = nullptr;
  const Mesh* mesh = nullptr;
  const Material* material = nullptr;
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> indices;
  Rotation normals{1};
};

Placed place(const Shot& shot, const Viewpoint& from, const Instance& instance) {
  Placed p{.scene = &shot.scene, .mesh = &shot.scene.meshes[instance.mesh]};
  p.material = &shot.scene.materials[p.mesh->material];
  const Matrix& world = shot.pose[instance.node];
  const Rotation linear(world);
  const Direction offset = Direction(world[3]) - from.at;
  p.positions.reserve(p.mesh->positions.size() + 1);
  for (const glm::vec3& v : p.mesh->positions) p.positions.emplace_back(linear * Direction(v) + offset);
  p.indices = p.mesh->indices;
  // The cofactors are the inverse transposed but for its scale, and also there where a node is squashed flat.
  p.normals =
      Rotation(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]), glm::cross(linear[0], linear[1]));
  if (glm::determinant(linear) < 0) {
    // The front of a mirrored triangle is where its corners run clockwise (glTF 2.0, 3.7.4).
    for (std::size_t k = 0; k + 2 < p.indices.size(); k += 3) std::swap(p.indices[k + 1], p.indices[k + 2]);
    p.normals *= -1;
  }
  return p;
}

// Where a ray from the origin meets the plane of a triangle: what each corner counts for, and whether from the back.
struct Meeting {
  std::uint32_t corners[3];
  Direction weights;
  double distance;
  bool back;

  template <class T>
  [[nodiscard]] T of(const std::vector<T>& values) const {
    T sum(0);
    for (int k = 0; k < 3; ++k) sum += static_cast<float>(weights[k]) * values[corners[k]];
    return sum;
  }
};

// Volumes of the ray with the sides (Moeller and Trumbore 1997, symmetric); Embree's own are float32.
Meeting meet(const Placed& p, std::size_t triangle, const Direction& ray) {
  Meeting m{};
  Direction corner[3];
  for (std::size_t k = 0; k < 3; ++k) {
    m.corners[k] = p.indices[3 * triangle + k];
    corner[k] = Direction(p.positions[m.corners[k]]);
  }
  const Direction normal = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
  const double slope = glm::dot(normal, ray);
  m.back = slope > 0;
  m.distance = glm::dot(normal, corner[0]) / slope;
  for (int k = 0; k < 3; ++k)
    m.weights[k] = std::abs(glm::dot(ray, glm::cross(corner[(k + 1) % 3], corner[(k + 2) % 3])));
  const double sum = m.weights.x + m.weights.y + m.weights.z;
  m.weights = sum > 0 ? m.weights / sum : Direction(1.0 / 3);
  return m;
}

glm::vec4 sample(const Placed& p, int texture, const glm::vec2& at) {
  return texture < 0 ? glm::vec4(1) : texture_at(p.scene->textures[texture], at);
}

// Called for each hit: a side that is not drawn and a hole let the ray through.
void filter(const RTCFilterFunctionNArguments* call) {
  const Placed& p = *static_cast<const Placed*>(call->geometryUserPtr);
  if (call->N != 1) return;
  const Direction ray(RTCRayN_dir_x(call->ray, 1, 0), RTCRayN_dir_y(call->ray, 1, 0), RTCRayN_dir_z(call->ray, 1, 0));
  const Meeting m = meet(p, RTCHitN_primID(call->hit, 1, 0), ray);
  bool shown = !m.back || p.material->double_sided;
  if (shown && p.material->alpha_cutoff > 0)
    shown = p.material->base_colour.w * sample(p, p.material->base_colour_texture, m.of(p.mesh->coordinates)).w >=
            p.material->alpha_cutoff;
  if (!shown) call->valid[0] = 0;
}

Surface surface_at(const Placed& p, const Meeting& m, const Direction& position, const Direction& ray) {
  const Material& material = *p.material;
  const glm::vec2 at = m.of(p.mesh->coordinates);
  const glm::vec4 rough = sample(p, material.metallic_roughness_texture, at);
  const Flux emissive = Flux(material.emissive) * Flux(Colour(sample(p, material.emissive_texture, at)));
  Direction normal = p.normals * Direction(m.of(p.mesh->normals)) * (m.back ? -1.0 : 1.0);
  if (const double length = glm::length(normal); length > 0)
    normal /= length;
  else
    normal = -ray;
  return {.position = position,
          .normal = normal,
          .base_colour = material.base_colour * sample(p, material.base_colour_texture, at),
          .metallic = material.metallic * rough.z,
          .roughness = material.roughness * rough.y,
          .emissive = Colour(emissive),
          .transmission = material.transmission,
          .ior = material.ior};
}

struct World {
  Device device{nullptr, &rtcReleaseDevice};
  Tree tree{nullptr, &rtcReleaseScene};
  std::vector<Placed> placed;  // By number of instance; empty where it is left out.

  void check() const {
    const RTCError error = rtcGetDeviceError(device.get());
    if (error != RTC_ERROR_NONE)
      throw UsageError(fmt::format("Embree cannot hold the scene (error {})", static_cast<int>(error)));
  }
};

World build(const Shot& shot, const Viewpoint& from) {
  World w;
  w.device.reset(rtcNewDevice(nullptr));
  if (!w.device) throw UsageError("Embree does not start");
  w.tree.reset(rtcNewScene(w.device.get()));
  rtcSetSceneFlags(w.tree.get(), RTC_SCENE_FLAG_ROBUST);
  const std::vector<Instance> all = instances(shot.scene);
  w.placed.resize(all.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (from.without >= 0 && lies_under(shot.scene, all[k].node, from.without)) continue;
    Placed& p = w.placed[k];
    p = place(shot, from, all[k]);
    RTCGeometry geometry = rtcNewGeometry(w.device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, p.positions.data(), 0,
                               sizeof(glm::vec3), p.positions.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, p.indices.data(), 0,
                               3 * sizeof(std::uint32_t), p.indices.size() / 3);
    rtcSetGeometryUserData(geometry, &p);
    if (!p.material->double_sided || p.material->alpha_cutoff > 0)
      rtcSetGeometryIntersectFilterFunction(geometry, filter);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(w.tree.get(), geometry, static_cast<unsigned>(k));
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(w.tree.get());
  w.check();
  return w;
}

struct Seen {
  Colour radiance{0};
  float distance = std::numeric_limits<float>::infinity();
  std::uint32_t surface = 0;
};

Seen look(const World& w, const Lighting& lighting, const Viewpoint& from, const Direction& ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit hit{};
  const glm::vec3 along(ray);
  hit.ray = {.dir_x = along.x, .dir_y = along.y, .dir_z = along.z, .tfar = static_cast<float>(from.far), .mask = ~0U};
  hit.ray.tnear = static_cast<float>(from.near);
  hit.hit.geomID = hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(w.tree.get(), &context, &hit);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID)
    return {.radiance = background(lighting.environment, ray) + (from.show_ambient ? lighting.ambient : Colour(0))};
  const Placed& p = w.placed[hit.hit.geomID];
  const Meeting m = meet(p, hit.hit.primID, ray);
  // A ray along the triangle's plane meets it where Embree says.
  const double distance = m.distance > 0 && std::isfinite(m.distance) ? m.distance : static_cast<double>(hit.ray.tfar);
  return {.radiance = shade(surface_at(p, m, from.at + distance * ray, ray), -ray, lighting),
          .distance = static_cast<float>(distance),
          .surface = hit.hit.geomID + 1};
}

}  // namespace

Drawn raycast(const Shot& shot, const Viewpoint& from, const Progress& progress) {
  const World world = build(shot, from);
  const Lighting light = lighting(shot);
  Drawn drawn{.radiance = blank_map(from.to, from.size)};
  Level& level = drawn.radiance.base();
  drawn.distances.assign(ImageView<float>::count(level.width(), level.height(), level.faces()),
                         std::numeric_limits<float>::infinity());
  drawn.surfaces.assign(drawn.distances.size(), 0);
  const ImageView<float> distances(drawn.distances, level.width(), level.height(), level.faces());
  const ImageView<std::uint32_t> surfaces(drawn.surfaces, level.width(), level.height(), level.faces());
  for_each_row(level.faces(), level.height(), progress, [&](int face, int row) {
    if ((from.which >> face & 1) == 0) return;
    const Columns in = columns(from.to, from.size, row);
    std::vector<Direction> rays(in.count());
    std::vector<Flux> sums(rays.size(), Flux(0));
    const auto distance = in.of(distances.row(face, row));
    const auto surface = in.of(surfaces.row(face, row));
    for (int k = 0; k < from.samples; ++k) {
      sample_directions(from.to, from.size, face, row, sample_offset(k, from.samples), rays);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const Seen seen = look(world, light, from, from.axes * rays[i]);
        sums[i] += Flux(seen.radiance);
        if (k > 0) continue;
        distance[i] = seen.distance;
        surface[i] = seen.surface;
      }
    }
    for (std::size_t i = 0; i < rays.size(); ++i)
      *level.texel(face, in.first + static_cast<int>(i), row) = Colour(sums[i] / static_cast<double>(from.samples));
  });
  return drawn;
}

}  // namespace envmap

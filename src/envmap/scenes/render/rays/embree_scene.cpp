#include "envmap/scenes/render/rays/embree_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "envmap/base/error.h"
#include "envmap/maths/portable.h"
#include "envmap/scenes/render/rays/embree_version.h"
#include "envmap/scenes/render/rays/texture_sample.h"

namespace envmap {
namespace {

using Device = std::unique_ptr<RTCDeviceTy, decltype(&rtcReleaseDevice)>;
using Tree = std::unique_ptr<RTCSceneTy, decltype(&rtcReleaseScene)>;

// A mesh in its place, the tree's centre at the origin, axes the world's; counter-clockwise from the front.
struct InstanceTransform {
  const SceneGraph* scene = nullptr;
  const Mesh* mesh = nullptr;
  const Material* material = nullptr;
  const TextureSampler* textures = nullptr;
  int node = 0;
  bool seen = true;  // Else it only casts shadows.
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> indices;
  Rotation tangents{1}, normals{1};  // Into the world's axes.
  double handed = 1;                 // -1: mirrored.
  double scale = 1;                  // Of lengths, the mean of all directions'.
};

InstanceTransform place(const FrameState& shot, const Direction& centre, const Instance& instance) {
  InstanceTransform p{.scene = &shot.scene, .mesh = &shot.scene.meshes[instance.mesh], .node = instance.node};
  p.material = &shot.scene.materials[p.mesh->material];
  const Matrix& world = shot.pose[instance.node];
  const Rotation linear(world);
  const Direction offset = Direction(world[3]) - centre;
  p.positions.reserve(p.mesh->positions.size() + 1);
  for (const glm::vec3& v : p.mesh->positions) p.positions.emplace_back(linear * Direction(v) + offset);
  p.indices = p.mesh->indices;
  p.tangents = linear;
  p.normals = cofactors(linear);
  p.scale = portable::cbrt(std::abs(glm::determinant(linear)));
  if (glm::determinant(linear) < 0) {
    // The front of a mirrored triangle is where its corners run clockwise (glTF 2.0, 3.7.4).
    for (std::size_t k = 0; k + 2 < p.indices.size(); k += 3) std::swap(p.indices[k + 1], p.indices[k + 2]);
    p.normals *= -1;
    p.handed = -1;
  }
  return p;
}

// Where a ray meets the plane of a triangle: what each corner counts for, and whether from the back.
struct RayQuery {
  std::uint32_t corners[3];
  Direction weights;
  double distance;
  bool back;

  template <class T>
  [[nodiscard]] T of(const std::vector<T>& values) const {
    T sum(0);
    for (int k = 0; k < 3; ++k) sum += float(weights[k]) * values[corners[k]];
    return sum;
  }
};

// Volumes of the ray with the sides (Moeller and Trumbore 1997, symmetric); Embree's own are float32.
RayQuery meet(const InstanceTransform& p, std::size_t triangle, const Direction& origin, const Direction& ray) {
  RayQuery m{};
  Direction corner[3];
  for (std::size_t k = 0; k < 3; ++k) {
    m.corners[k] = p.indices[3 * triangle + k];
    corner[k] = Direction(p.positions[m.corners[k]]) - origin;
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

glm::vec4 sample(const InstanceTransform& p, int texture, const TextureFootprint& at) {
  return texture < 0 ? glm::vec4(1) : (*p.textures)(texture, at);
}

glm::vec4 base_colour(const InstanceTransform& p, const RayQuery& m, const glm::vec4& texel) {
  const glm::vec4 own = p.material->base_colour * texel;
  return p.mesh->colours.empty() ? own : own * m.of(p.mesh->colours);
}

// What filters are told of the ray beside what Embree knows.
struct Query : embree::Context {
  Direction origin, ray;
  Medium medium = Medium::air;
  int but = -1;  // Of light: the node that casts no shadow.
};

// For light; to the eye what is blended has no holes.
bool is_hole(const InstanceTransform& p, const RayQuery& m) {
  if (p.material->alpha_cutoff <= 0) return false;
  const int texture = p.material->base_colour_texture;
  const glm::vec4 texel =
      texture < 0 ? glm::vec4(1) : texture_at(p.scene->textures[std::size_t(texture)], m.of(p.mesh->coordinates));
  return base_colour(p, m, texel).w < p.material->alpha_cutoff;
}

// Called for each hit of a ray of light.
void let_light_through(const RTCFilterFunctionNArguments* call) {
  const InstanceTransform& p = *static_cast<const InstanceTransform*>(call->geometryUserPtr);
  if (call->N != 1) return;
  const Query& query = *static_cast<const Query*>(call->context);
  const bool is_lamp = query.but >= 0 && lies_under(*p.scene, p.node, query.but);
  if (is_lamp || !casts_shadow(*p.material) ||
      is_hole(p, meet(p, RTCHitN_primID(call->hit, 1, 0), query.origin, query.ray)))
    call->valid[0] = 0;
}

// Called for each hit: a side that is not drawn and a hole let the ray through.
void filter(const RTCFilterFunctionNArguments* call) {
  const InstanceTransform& p = *static_cast<const InstanceTransform*>(call->geometryUserPtr);
  if (call->N != 1) return;
  const Query& query = *static_cast<const Query*>(call->context);
  const RayQuery m = meet(p, RTCHitN_primID(call->hit, 1, 0), query.origin, query.ray);
  const bool ends_solid = query.medium == Medium::any || (query.medium == Medium::solid && p.material->solid);
  const bool shown =
      p.seen && (!m.back || p.material->double_sided || ends_solid) && (p.material->blended || !is_hole(p, m));
  if (!shown) call->valid[0] = 0;
}

// From a place on a triangle to the mean of where the planes of its corners have it; none where those lie below.
Direction lift(const InstanceTransform& p, const RayQuery& m, const Direction& place, double side) {
  Direction sum(0);
  for (int k = 0; k < 3; ++k) {
    const Direction normal = unit(p.normals * Direction(p.mesh->normals[m.corners[k]]) * side);
    const double above = glm::dot(place - Direction(p.positions[m.corners[k]]), normal);
    sum += m.weights[k] * std::max(0.0, -above) * normal;
  }
  return sum;
}

// How a place on a triangle, and what is interpolated there, moves with the ray.
struct TriangleSpread {
  RayDifferential ray;
  std::array<Direction, 2> normals{Direction(0), Direction(0)};
  TextureFootprint texture;
};

// @param front the unit normal's direction, of the length that interpolation gives it.
TriangleSpread spread_over(const InstanceTransform& p, const RayQuery& m, const Direction& ray, double distance,
                           const Direction& front, const RayDifferential& spread) {
  TriangleSpread s{};
  s.texture.at = m.of(p.mesh->coordinates);
  if (spread.is_zero()) return s;
  Direction corner[3];
  for (std::size_t k = 0; k < 3; ++k) corner[k] = Direction(p.positions[m.corners[k]]);
  const Direction plane = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
  s.ray = spread.moved(ray, distance, plane);
  for (std::size_t k = 0; k < 2; ++k) {
    Direction normal(0);
    Vec2<double> place(0);
    for (int c = 0; c < 3; ++c) {
      // Along the height over the opposite side a corner's weight rises from 0 to 1.
      const Direction rise = glm::cross(plane, corner[(c + 2) % 3] - corner[(c + 1) % 3]) / glm::dot(plane, plane);
      const double part = glm::dot(rise, s.ray.origin[k]);
      normal += part * (p.normals * Direction(p.mesh->normals[m.corners[c]]));
      place += part * Vec2<double>(p.mesh->coordinates[m.corners[c]]);
    }
    s.normals[k] = (m.back ? -1.0 : 1.0) * normalised_derivative(front, normal);
    (k == 0 ? s.texture.across : s.texture.down) = place;
  }
  return s;
}

// What a map makes of the normal of the front (glTF 2.0, 3.9.3).
Direction mapped_normal(const InstanceTransform& p, const RayQuery& m, int texture, double scale,
                        const Direction& normal, const TextureFootprint& at) {
  if (texture < 0) return normal;
  const glm::vec4 interpolated = m.of(p.mesh->tangents);
  const Direction along = unit(p.tangents * Direction(interpolated));
  const Direction across = glm::cross(normal, along) * (interpolated.w < 0 ? -p.handed : p.handed);
  const Direction texel = 2.0 * Direction(sample(p, texture, at)) - 1.0;
  return unit(scale * texel.x * along + scale * texel.y * across + texel.z * normal, normal);
}

// @param place from the tree's centre.
ShadingPoint surface_at(const InstanceTransform& p, const RayQuery& m, const Direction& centre, const Direction& place,
                        const Direction& ray, const TextureFootprint& at) {
  const Direction position = centre + place;
  const Material& material = *p.material;
  const glm::vec4 rough = sample(p, material.metallic_roughness_texture, at);
  const Flux emissive = Flux(material.emissive) * Flux(Colour(sample(p, material.emissive_texture, at)));
  const double side = m.back ? -1 : 1;
  const Direction front = unit(p.normals * Direction(m.of(p.mesh->normals)), -side * ray);
  const glm::vec4 colour = base_colour(p, m, sample(p, material.base_colour_texture, at));
  const float open = sample(p, material.occlusion_texture, at).x;
  return {.position = position,
          .normal = side * mapped_normal(p, m, material.normal_texture, material.normal_scale, front, at),
          .smooth_normal = side * front,
          .base_colour = colour,
          .metallic = material.metallic * rough.z,
          .roughness = material.roughness * rough.y,
          .emissive = Colour(emissive),
          .transmission = material.transmission,
          .ior = material.ior,
          .opacity = material.blended ? std::clamp(colour.w, 0.0F, 1.0F) : 1,
          .solid = material.solid,
          .absorption = material.absorption,
          .thickness = material.thickness * float(p.scale),
          .coat = material.coat * sample(p, material.coat_texture, at).x,
          .coat_roughness = material.coat_roughness * sample(p, material.coat_roughness_texture, at).y,
          .coat_normal =
              side * mapped_normal(p, m, material.coat_normal_texture, material.coat_normal_scale, front, at),
          .sheen = material.sheen * Colour(sample(p, material.sheen_texture, at)),
          .sheen_roughness = material.sheen_roughness * sample(p, material.sheen_roughness_texture, at).w,
          .reached = 1 + material.occlusion_strength * (open - 1),
          .shadow_origin = position + lift(p, m, place, side)};
}

}  // namespace

struct EmbreeScene::World {
  explicit World(const SceneGraph& scene, TextureFilter filter) : textures(scene, filter) {}

  Direction centre{0};
  TextureSampler textures;
  Device device{nullptr, &rtcReleaseDevice};
  Tree tree{nullptr, &rtcReleaseScene};
  std::vector<InstanceTransform> placed;  // By number of instance.

  void add(unsigned number) {
    InstanceTransform& p = placed[number];
    RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, p.positions.data(), 0,
                               sizeof(glm::vec3), p.positions.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, p.indices.data(), 0,
                               3 * sizeof(std::uint32_t), p.indices.size() / 3);
    rtcSetGeometryUserData(geometry, &p);
    if (!p.seen || !p.material->double_sided || p.material->alpha_cutoff > 0)
      rtcSetGeometryIntersectFilterFunction(geometry, filter);
    rtcSetGeometryOccludedFilterFunction(geometry, let_light_through);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(tree.get(), geometry, number);
    rtcReleaseGeometry(geometry);
  }
};

EmbreeScene::EmbreeScene(const FrameState& shot, const Direction& centre, int without, TextureFilter filter)
    : world_(std::make_unique<World>(shot.scene, filter)) {
  World& w = *world_;
  w.centre = centre;
  w.device.reset(rtcNewDevice(nullptr));
  if (!w.device) throw RendererError("Embree does not start");
  w.tree.reset(rtcNewScene(w.device.get()));
  rtcSetSceneFlags(w.tree.get(), RTC_SCENE_FLAG_ROBUST);
  const std::vector<Instance> all = instances(shot.scene);
  w.placed.resize(all.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    w.placed[k] = place(shot, centre, all[k]);
    w.placed[k].textures = &w.textures;
    w.placed[k].seen = without < 0 || !lies_under(shot.scene, all[k].node, without);
    w.add(unsigned(k));
  }
  rtcCommitScene(w.tree.get());
  if (const RTCError error = rtcGetDeviceError(w.device.get()); error != RTC_ERROR_NONE)
    throw RendererError(fmt::format("Embree cannot hold the scene (error {})", int(error)));
}

EmbreeScene::~EmbreeScene() = default;

double EmbreeScene::clearance(const Direction& place) { return glm::length(place) / 32768; }

std::optional<SurfaceHit> EmbreeScene::find(const Direction& origin, const Direction& ray, double near, double far,
                                            Medium medium, const RayDifferential& spread) const {
  Query query{};
  embree::prepare(query);
  query.origin = origin;
  query.ray = ray;
  query.medium = medium;
  RTCRayHit hit{};
  const glm::vec3 from(origin), along(ray);
  hit.ray = {.org_x = from.x,
             .org_y = from.y,
             .org_z = from.z,
             .tnear = float(near),
             .dir_x = along.x,
             .dir_y = along.y,
             .dir_z = along.z,
             .tfar = float(far),
             .mask = ~0U};
  hit.hit.geomID = hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  embree::intersect(world_->tree.get(), query, hit);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const InstanceTransform& p = world_->placed[hit.hit.geomID];
  const RayQuery m = meet(p, hit.hit.primID, origin, ray);
  // A ray along the triangle's plane meets it where Embree says.
  const double distance = m.distance > 0 && std::isfinite(m.distance) ? m.distance : double(hit.ray.tfar);
  const Direction front = p.normals * Direction(m.of(p.mesh->normals));
  const TriangleSpread there = spread_over(p, m, ray, distance, front, spread);
  return SurfaceHit{.surface = surface_at(p, m, world_->centre, origin + distance * ray, ray, there.texture),
                    .distance = distance,
                    .instance = int(hit.hit.geomID),
                    .blended = p.material->blended,
                    .back = m.back,
                    .spread = there.ray,
                    .normals = there.normals};
}

bool EmbreeScene::blocked(const Direction& place, const Direction& normal, const Direction& towards, double distance,
                          int but) const {
  Query query{};
  embree::prepare(query);
  const Direction from_centre = place - world_->centre;
  query.origin = from_centre + clearance(from_centre) * normal;
  query.ray = towards;
  query.but = but;
  const glm::vec3 from(query.origin), along(towards);
  RTCRay ray{.org_x = from.x,
             .org_y = from.y,
             .org_z = from.z,
             .tnear = 0,
             .dir_x = along.x,
             .dir_y = along.y,
             .dir_z = along.z,
             .tfar = float(distance),
             .mask = ~0U};
  embree::occlude(world_->tree.get(), query, ray);
  return ray.tfar < 0;
}

}  // namespace envmap

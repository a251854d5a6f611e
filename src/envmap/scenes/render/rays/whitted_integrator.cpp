#include "envmap/scenes/render/rays/whitted_integrator.h"

#include <algorithm>
#include <cmath>

namespace envmap {
namespace {

// Parts of a pixel below this are not followed; how often a ray may be reflected inside a solid.
constexpr double negligible = 1e-4;
constexpr int max_inside = 16;

double largest(const Flux& part) { return std::max(part.x, std::max(part.y, part.z)); }

// Schlick 1994 from the side of the air.
double reflectance(double ior, double cosine) {
  const double normal = (ior - 1) / (ior + 1), f0 = normal * normal;
  return ior > 1 ? f0 + (1 - f0) * std::pow(1 - std::clamp(cosine, 0.0, 1.0), 5) : 0;
}

}  // namespace

std::optional<LobeIntegral> lobe_integral(const FrameState& shot, const RayPaths& paths) {
  if (paths.lobe_samples == 0 || shot.environment == nullptr) return std::nullopt;
  const Environment& around = *shot.environment;
  return LobeIntegral(*around.remainder,
                      around.light.suns.empty() ? around.lookup : EnvironmentLookup(*around.remainder),
                      paths.lobe_samples);
}

WhittedIntegrator::WhittedIntegrator(const EmbreeScene& tree, const Lighting& light, const FrameState& shot,
                                     const Viewpoint& from, const RayPaths& paths)
    : tree_(tree), light_(light), from_(from), bounces_(paths.bounces), far_(paths.far) {
  for (const Instance& instance : instances(shot.scene)) {
    const Mesh& mesh = shot.scene.meshes[instance.mesh];
    const bool named =
        std::ranges::any_of(paths.mirrors, [&](int node) { return lies_under(shot.scene, instance.node, node); });
    const Material& material = shot.scene.materials[mesh.material];
    followed_.push_back({named && is_smooth(material), named && material.coat_roughness < smooth_glass});
  }
}

Flux WhittedIntegrator::from_eye(const Direction& origin, const Direction& ray, const RayDifferential& spread) const {
  const Ray first{origin, ray, bounces_, 1, spread, true};
  const auto hit = tree_.find(origin, ray, from_.near, from_.far, Medium::air, spread);
  return hit ? leaving(*hit, first) : missing(first);
}

Flux WhittedIntegrator::from_surface(const SurfaceHit& hit, const Direction& ray) const {
  return scattered(hit, {Direction(0), ray, bounces_, 1, hit.spread, true});
}

// Returns the radiance that arrives along a ray starting on a surface.
Flux WhittedIntegrator::along(const Ray& ray) const {
  const auto hit = tree_.find(ray.origin, ray.along, EmbreeScene::clearance(ray.origin), far_, Medium::air, ray.spread);
  return hit ? leaving(*hit, ray) : missing(ray);
}

Flux WhittedIntegrator::missing(const Ray& ray) const {
  if (!ray.of_eye) return glossy_radiance(light_, ray.along, 0);
  return Flux(background(light_.environment, ray.along) + (from_.show_ambient ? light_.ambient : Colour(0)));
}

Flux WhittedIntegrator::leaving(const SurfaceHit& hit, const Ray& ray) const {
  const double covered = hit.surface.opacity;
  const Ray onwards{ray.origin + hit.distance * ray.along,
                    ray.along,
                    ray.bounces,
                    ray.weight * (1 - covered),
                    hit.spread,
                    ray.of_eye};
  Flux sum = covered > 0 ? covered * scattered(hit, ray) : Flux(0);
  if (covered < 1) sum += (1 - covered) * along(onwards);
  return sum;
}

Flux WhittedIntegrator::scattered(const SurfaceHit& hit, const Ray& ray) const {
  const ShadingPoint& s = hit.surface;
  const TracedPath& layers = followed_[hit.instance];
  const ShadingResult out = scatter(s, -ray.along, light_, {layers.base, layers.coat});
  const Direction place = ray.origin + hit.distance * ray.along;
  // What mirrors and lenses show is followed; the environment's light that others send on comes from its levels or
  // lobes.
  const auto beyond = [&](const Flux& part, const Direction& where, const RayDifferential& spread, bool followed,
                          bool inside, auto&& of_environment) {
    if (part == Flux(0)) return Flux(0);
    const Ray next{place, where, ray.bounces - 1, ray.weight * largest(part), spread};
    if (!followed || ray.bounces == 0 || next.weight < negligible) return of_environment();
    return part * (inside ? through(next, {s.ior, Flux(s.absorption)}, 0) : along(next));
  };
  const Direction v = -ray.along;
  const auto mirrored = [&](const Direction& n) { return after_reflection(hit.spread, ray.along, n, hit.normals); };
  const RayDifferential refracted =
      s.solid ? after_refraction(hit.spread, ray.along, s.normal, hit.normals, 1.0 / std::max(1.0F, s.ior))
              : hit.spread;
  return out.radiance +
         beyond(out.reflected, out.mirrored, mirrored(s.normal), layers.base, false,
                [&] { return reflected_light(s, v, light_, out); }) +
         beyond(out.transmitted, out.refracted, refracted, layers.base, s.solid,
                [&] {
                  return out.transmitted * transmittance(Flux(s.absorption), s.thickness) *
                         transmitted_radiance(light_, out.refracted, s.roughness);
                }) +
         beyond(out.coat, out.coat_mirrored, mirrored(s.coat_normal), layers.coat, false,
                [&] { return coat_light(s, v, light_, out); });
}

// Returns the radiance along a ray inside a solid. The glass tint was applied where the ray entered.
Flux WhittedIntegrator::through(const Ray& ray, const Solid& solid, int reflections) const {
  const auto hit =
      tree_.find(ray.origin, ray.along, EmbreeScene::clearance(ray.origin), far_, Medium::solid, ray.spread);
  const Flux left = transmittance(solid.absorption, hit ? hit->distance : far_);
  if (!hit) return left * glossy_radiance(light_, ray.along, 0);
  Ray there = ray;
  there.weight *= largest(left);
  // What does not face away is something in the glass.
  return left * (hit->back ? leaving_solid(*hit, there, solid, reflections) : leaving(*hit, there));
}

// Returns the radiance along a ray that meets a solid's surface from inside.
Flux WhittedIntegrator::leaving_solid(const SurfaceHit& hit, const Ray& ray, const Solid& solid,
                                      int reflections) const {
  const Direction& n = hit.surface.normal;
  const Direction place = ray.origin + hit.distance * ray.along, out = glm::refract(ray.along, n, solid.ior);
  const double reflected = out == Direction(0) ? 1 : reflectance(solid.ior, -glm::dot(out, n));
  Flux sum(0);
  if (reflected < 1) {
    const RayDifferential spread = after_refraction(hit.spread, ray.along, n, hit.normals, solid.ior);
    sum += (1 - reflected) * along({place, out, ray.bounces, ray.weight * (1 - reflected), spread});
  }
  if (reflected > 0) {
    const Ray back{place, glm::reflect(ray.along, n), ray.bounces, ray.weight * reflected,
                   after_reflection(hit.spread, ray.along, n, hit.normals)};
    const bool end = reflections == max_inside || back.weight < negligible;
    sum += reflected * (end ? glossy_radiance(light_, back.along, 0) : through(back, solid, reflections + 1));
  }
  return sum;
}

}  // namespace envmap

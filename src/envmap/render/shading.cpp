#include "envmap/render/shading.h"

#include <algorithm>
#include <cmath>

#include "envmap/prefilter/brdf_table.h"
#include "envmap/prefilter/harmonics.h"
#include "envmap/prefilter/prefilter.h"
#include "envmap/projection/visit.h"
#include "envmap/render/ray_tree.h"
#include "envmap/sample/point.h"

namespace envmap {

// ---- the environment -------------------------------------------------------------------------------------------------

EnvironmentLight environment_light(const EnvironmentMap& map, int size, const Progress& progress) {
  EnvironmentLight light;
  Harmonics h = project(map, 2);
  scale_degrees(h, irradiance_factors(2));
  // Of the basis functions, in the order of harmonics.h.
  constexpr double scale[9] = {0.28209479177387814, 0.4886025119029199, 0.4886025119029199,
                               0.4886025119029199,  1.0925484305920792, 1.0925484305920792,
                               0.31539156525252005, 1.0925484305920792, 0.5462742152960396};
  // There: 1, x, y, z, xz, xy, 3y^2-1, yz, z^2-x^2.
  for (std::size_t k = 0; k < 9; ++k) light.irradiance[k] = Colour(h.coefficients[k] * (scale[k] / pi));
  const PrefilterSource source(map);
  for (int k = 1; k <= glossy_levels; ++k) {
    Prefiltered made = source.make({.shape = Shape::ggx,
                                    .parameter = static_cast<double>(k) / glossy_levels,
                                    .size = size,
                                    .method = Method::hierarchical,
                                    .max_error = 1e-2});
    light.glossy.emplace_back(std::move(made.map.base()));
    if (progress) progress(static_cast<double>(k) / glossy_levels);
  }
  return light;
}

const std::vector<Colour>& split_sum_table() {
  static const std::vector<Colour> table = brdf_table(split_sum_size);
  return table;
}

Colour background(const Environment* environment, const Direction& from) {
  return environment != nullptr ? environment->lookup(from) : Colour(0);
}

namespace {

// @param reached the part of the environment's light that does.
Flux irradiance_over_pi(const Lighting& l, const Direction& n, const Flux& reached) {
  const Flux ambient(l.ambient);
  if (l.environment == nullptr) return ambient;
  const double basis[9] = {1, n.x, n.y, n.z, n.x * n.z, n.x * n.y, 3 * n.y * n.y - 1, n.y * n.z, n.z * n.z - n.x * n.x};
  Flux sum(0);
  for (std::size_t k = 0; k < 9; ++k) sum += basis[k] * Flux(l.environment->light.irradiance[k]);
  return ambient + reached * glm::max(sum, 0.0);
}

// Bilinear between the centres of the table's texels.
ScaleBias split_sum(double cosine, double roughness) {
  const std::vector<Colour>& table = split_sum_table();
  const auto along = [](double x) { return std::clamp(x * split_sum_size - 0.5, 0.0, split_sum_size - 1.0); };
  const double x = along(cosine), y = along(roughness);
  const int i = std::min(static_cast<int>(x), split_sum_size - 2), j = std::min(static_cast<int>(y), split_sum_size - 2);
  const Colour* a = &table[j * split_sum_size + i];
  const Flux upper = glm::mix(Flux(a[0]), Flux(a[1]), x - i);
  const Flux lower = glm::mix(Flux(a[split_sum_size]), Flux(a[split_sum_size + 1]), x - i);
  const Flux found = glm::mix(upper, lower, y - j);
  return {found.x, found.y};
}

// ---- punctual lights -------------------------------------------------------------------------------------------------

// What arrives across the light, and from where (KHR_lights_punctual).
Flux arriving(const PlacedLight& light, const Direction& position, Direction& from) {
  from = -light.direction;
  if (light.kind == PunctualLight::Kind::directional) return Flux(light.intensity);
  const Direction way = light.position - position;
  const double square = std::max(glm::dot(way, way), 1e-12);
  from = way / std::sqrt(square);
  Flux there = Flux(light.intensity) / square;
  if (light.range > 0) {
    const double part = square / (light.range * light.range);
    there *= std::clamp(1 - part * part, 0.0, 1.0);
  }
  if (light.kind == PunctualLight::Kind::spot) {
    const double part =
        std::clamp((glm::dot(-from, light.direction) - light.outer) / std::max(1e-4, light.inner - light.outer), 0.0, 1.0);
    there *= part * part;
  }
  return there;
}

// D times G / (4 cos(n,l) cos(n,v)): Trowbridge and Reitz, with Smith's height-correlated masking. 1 - cos^2 is taken from
// the cross product: the peak of a smooth surface is lost otherwise.
double specular(double alpha, const Direction& n, const Direction& h, double nv, double nl) {
  const double a2 = alpha * alpha, nh = std::max(0.0, glm::dot(n, h));
  const Direction side = glm::cross(n, h);
  const double q = a2 * nh * nh + glm::dot(side, side);
  const double masking = nl * std::sqrt(nv * nv * (1 - a2) + a2) + nv * std::sqrt(nl * nl * (1 - a2) + a2);
  return a2 / (pi * q * q) * 0.5 / masking;
}

}  // namespace

Flux glossy_radiance(const Lighting& l, const Direction& from, double roughness) {
  const Flux ambient(l.ambient);
  if (l.environment == nullptr) return ambient;
  const double level = std::clamp(roughness, 0.0, 1.0) * glossy_levels;
  const int lower = std::min(static_cast<int>(level), glossy_levels - 1);
  const auto at = [&](int k) {
    if (k == 0) return Flux(background(l.environment, from));
    return Flux(bilinear(l.environment->light.glossy[k - 1], Cube::locate(from)));
  };
  const double part = level - lower;
  return ambient + (part < 1 ? (1 - part) * at(lower) : Flux(0)) + (part > 0 ? part * at(lower + 1) : Flux(0));
}

std::vector<PlacedLight> placed_lights(const Scene& scene, const Pose& pose) {
  std::vector<PlacedLight> placed;
  for (const PunctualLight& light : scene.lights) {
    const Matrix& world = pose[light.node];
    const Direction along(-world[2]);
    const double length = glm::length(along);
    placed.push_back({light.kind, Direction(world[3]), length > 0 ? along / length : Direction(0, 0, -1),
                      light.intensity, light.range, std::cos(light.inner), std::cos(light.outer), light.node});
  }
  return placed;
}

Lighting lighting(const Shot& shot, const RayTree* obstacles) {
  return {placed_lights(shot.scene, shot.pose), shot.environment, shot.ambient, obstacles, shot.shadows, shot.distant};
}

bool in_shadow(const RayTree& obstacles, const Surface& s, const PlacedLight& light) {
  const bool parallel = light.kind == PunctualLight::Kind::directional;
  const Direction way = light.position - s.lifted;
  const double distance = parallel ? std::numeric_limits<double>::infinity() : glm::length(way);
  if (distance == 0) return false;
  const Direction towards = parallel ? -light.direction : way / distance;
  return obstacles.blocked(s.lifted, s.smooth_normal, towards, distance, light.node);
}

Flux unoccluded(const RayTree& obstacles, const Surface& s, std::span<const DistantLight> distant) {
  Flux all(0), reached(0);
  for (const DistantLight& light : distant) {
    const double cosine = glm::dot(s.smooth_normal, light.from);
    if (cosine <= 0) continue;
    const Flux there = cosine * Flux(light.irradiance);
    all += there;
    constexpr double endless = std::numeric_limits<double>::infinity();
    if (!obstacles.blocked(s.lifted, s.smooth_normal, light.from, endless, -1)) reached += there;
  }
  for (int k = 0; k < 3; ++k) reached[k] = all[k] > 0 ? reached[k] / all[k] : 1;
  return reached;
}

Scattered scatter(const Surface& s, const Direction& v, const Lighting& l) {
  const Direction& n = s.normal;
  const double nv = std::clamp(glm::dot(n, v), 1e-3, 1.0), metallic = s.metallic;
  const Flux base(s.base_colour.x, s.base_colour.y, s.base_colour.z);
  const double smooth = std::pow((s.ior - 1.0) / (s.ior + 1.0), 2), transmitted = s.transmission;
  const double edge = s.ior > 1 ? 1 : 0;  // Reflected at grazing angles: where nothing is refracted nothing is.
  const Flux dielectric = base * (1 - metallic);

  // The environment: what is reflected once, and what after bouncing between microfacets, of either material.
  const ScaleBias table = split_sum(nv, s.roughness);
  const double more = 1 - table.scale - table.bias;
  const auto once = [&](const Flux& f0, double f90) { return f0 * table.scale + f90 * table.bias; };
  const auto later = [&](const Flux& f0, double f90) {
    const Flux mean = f0 + (f90 - f0) / 21.0;
    return once(f0, f90) * mean / (1.0 - more * mean) * more;
  };
  const Flux reached = l.obstacles != nullptr ? unoccluded(*l.obstacles, s, l.distant) : Flux(1);
  const Flux plain(smooth), rest = 1.0 - once(plain, edge) - later(plain, edge);
  const Flux irradiance = static_cast<double>(s.reached) * irradiance_over_pi(l, n, reached);
  Scattered out{.radiance = Flux(s.emissive) + rest * dielectric * (1 - transmitted) * irradiance +
                            glm::mix(later(plain, edge), later(base, 1), metallic) * irradiance,
                .reflected = static_cast<double>(s.reached) * glm::mix(once(plain, edge), once(base, 1), metallic),
                .transmitted = rest * dielectric * transmitted,
                .mirrored = 2 * glm::dot(n, v) * n - v,
                .refracted = s.solid ? glm::refract(-v, n, 1.0 / std::max(1.0F, s.ior)) : -v};

  // A smooth surface shows a punctual light as a spot of finite size.
  const double alpha = std::max(1e-3, static_cast<double>(s.roughness) * s.roughness);
  for (const PlacedLight& light : l.lights) {
    Direction from;
    const Flux there = arriving(light, s.position, from);
    const double nl = glm::dot(n, from);
    if (nl <= 0 || glm::dot(s.smooth_normal, from) <= 0) continue;
    if (l.obstacles != nullptr && l.shadows && in_shadow(*l.obstacles, s, light)) continue;
    const Direction h = glm::normalize(from + v);
    const double grazing = std::pow(1 - std::clamp(glm::dot(v, h), 0.0, 1.0), 5);
    const Flux of_plain = plain + (edge - plain) * grazing;
    const Flux fresnel = glm::mix(of_plain, base + (1.0 - base) * grazing, metallic);
    const Flux diffuse = (1.0 - of_plain) * (1 - transmitted) / pi;
    out.radiance += there * nl * (diffuse * dielectric + fresnel * specular(alpha, n, h, nv, nl));
  }
  return out;
}

Colour shade(const Surface& s, const Direction& v, const Lighting& l) {
  const Scattered out = scatter(s, v, l);
  Flux sum = out.radiance + out.reflected * glossy_radiance(l, out.mirrored, s.roughness);
  if (s.transmission > 0) sum += out.transmitted * glossy_radiance(l, out.refracted, s.roughness);
  return Colour(sum);
}

}  // namespace envmap

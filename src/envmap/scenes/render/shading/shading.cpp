#include "envmap/scenes/render/shading/shading.h"

#include <algorithm>
#include <cmath>

#include "envmap/light/disc_angles.h"
#include "envmap/maths/portable.h"
#include "envmap/prefilter/brdf_table.h"
#include "envmap/prefilter/harmonic_norms.h"
#include "envmap/prefilter/harmonics.h"
#include "envmap/prefilter/lobe_formulas.h"
#include "envmap/prefilter/prefilter.h"
#include "envmap/projection/visit.h"
#include "envmap/sample/point.h"
#include "envmap/scenes/render/rays/embree_scene.h"
#include "envmap/scenes/render/rays/lobe_integral.h"
#include "envmap/scenes/render/shading/microfacet.h"
#include "envmap/scenes/render/shading/sampled_reflection.h"
#include "envmap/scenes/render/shading/sheen_brdf.h"

namespace envmap {

// ---- the environment ------------------------------------------------------------------------------------------------

std::array<Colour, 9> irradiance_over_pi(const EnvironmentMap& map) {
  Harmonics h = project(map, 2);
  scale_degrees(h, irradiance_factors(2));
  using namespace harmonic_norms;
  // In the order of harmonics.h.
  constexpr double scale[9] = {n0, n1, n1, n1, n2, n2, n20, n2, n22};
  // There: 1, x, y, z, xz, xy, 3y^2-1, yz, z^2-x^2.
  std::array<Colour, 9> irradiance{};
  for (std::size_t k = 0; k < 9; ++k) irradiance[k] = Colour(h.coefficients[k] * (scale[k] / pi));
  return irradiance;
}

std::shared_ptr<const PaddedLevel> glossy_level(const Prefilterer& source, float roughness, int size, int largest) {
  int height = size;
  for (int k = 0; k < glossy_doublings(roughness) && 2 * height <= largest; ++k) height *= 2;
  Prefiltered made = source.make({.lobe = Lobe::ggx(roughness), .size = height, .max_error = 1e-2});
  return std::make_shared<const PaddedLevel>(std::move(made.map.base()));
}

EnvironmentLight environment_light(const EnvironmentMap& map, const std::vector<float>& roughnesses, int size,
                                   int largest, const Progress& progress) {
  EnvironmentLight light{.irradiance = irradiance_over_pi(map), .glossy = {}, .roughnesses = roughnesses};
  const Prefilterer source(borrowed(map));
  for (const float roughness : roughnesses) {
    light.glossy.push_back(glossy_level(source, roughness, size, largest));
    if (progress) progress(double(light.glossy.size()) / double(roughnesses.size()));
  }
  return light;
}

GlossyMix glossy_mix(const std::vector<float>& roughnesses, double roughness) {
  const int last = int(roughnesses.size()) - 1;
  const auto above = std::ranges::lower_bound(roughnesses, roughness);
  const int upper = std::min(last, int(above - roughnesses.begin()));
  const double least = upper == 0 ? 0 : roughnesses[std::size_t(upper - 1)], most = roughnesses[std::size_t(upper)];
  return {upper - 1, upper, std::clamp((roughness - least) / (most - least), 0.0, 1.0)};
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
Flux diffuse_light(const Lighting& l, const Direction& n, const Flux& reached) {
  const Flux ambient(l.ambient);
  if (l.environment == nullptr) return ambient;
  if (l.integral != nullptr) return ambient + reached * l.integral->diffuse(n);
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
  const int i = std::min(int(x), split_sum_size - 2), j = std::min(int(y), split_sum_size - 2);
  const Colour* a = &table[j * split_sum_size + i];
  const Flux upper = glm::mix(Flux(a[0]), Flux(a[1]), x - i);
  const Flux lower = glm::mix(Flux(a[split_sum_size]), Flux(a[split_sum_size + 1]), x - i);
  const Flux found = glm::mix(upper, lower, y - j);
  return {found.x, found.y};
}

// ---- punctual lights ------------------------------------------------------------------------------------------------

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
        std::clamp((glm::dot(-from, light.direction) - light.outer) / std::max(1e-4, light.inner - light.outer), 0.0,
                   1.0);
    there *= part * part;
  }
  return there;
}

double specular(double alpha, const Direction& n, const Direction& h, double nv, double nl) {
  return ggx_distribution(alpha, n, h) * smith_visibility(alpha, nv, nl);
}

// A smooth surface shows a punctual light as a spot of finite size.
double alpha_of(float roughness) { return std::max(1e-3, double(roughness) * roughness); }

// ---- layers of the material -----------------------------------------------------------------------------------------

struct Base {
  double nv;
  // What plain dielectrics reflect straight on, and at grazing angles: where nothing is
  Flux colour, dielectric, plain;
  double edge;  // refracted nothing is.
};

Base base_of(const ShadingPoint& s, const Direction& v) {
  const Flux colour(s.base_colour.x, s.base_colour.y, s.base_colour.z);
  return {std::clamp(glm::dot(s.normal, v), 1e-3, 1.0), colour, colour * (1.0 - s.metallic),
          Flux(std::pow((s.ior - 1.0) / (s.ior + 1.0), 2)), s.ior > 1 ? 1.0 : 0.0};
}

// How a layer reflects a light.
struct Glint {
  double alpha;
  double part = 1;  // The rest is in what the layer shows sharply.
};

// What leaves towards v of light of 1 across its way.
Flux lit(const Base& b, const ShadingPoint& s, const Direction& v, const Direction& from, const Glint& glint) {
  const double nl = glm::dot(s.normal, from);
  if (nl <= 0) return Flux(0);
  const Direction h = glm::normalize(from + v);
  const double side = schlick_weight(glm::dot(v, h));
  const Flux of_plain = b.plain + (b.edge - b.plain) * side;
  const Flux fresnel = glm::mix(of_plain, b.colour + (1.0 - b.colour) * side, double(s.metallic));
  const Flux diffuse = (1.0 - of_plain) * (1.0 - s.transmission) / pi;
  return nl * (diffuse * b.dielectric + glint.part * fresnel * specular(glint.alpha, s.normal, h, b.nv, nl));
}

// White microfacets, of which `part` counts and covers the base: by the extension's text Fresnel's term is that of the
// view. What they do not reflect at once they diffuse, so that white stays white.
struct Coat {
  double nv, part, once;
};

Coat coat_of(const ShadingPoint& s, const Direction& v) {
  if (s.coat == 0) return {1, 0, 0};
  constexpr double straight = 0.04;
  const double nv = std::clamp(glm::dot(s.coat_normal, v), 1e-3, 1.0);
  const ScaleBias table = split_sum(nv, s.coat_roughness);
  return {nv, s.coat * (straight + (1 - straight) * schlick_weight(nv)), table.scale + table.bias};
}

double lit(const Coat& c, const ShadingPoint& s, const Direction& v, const Direction& from, const Glint& glint) {
  const double nl = glm::dot(s.coat_normal, from);
  if (nl <= 0) return 0;
  return nl * glint.part * specular(glint.alpha, s.coat_normal, glm::normalize(from + v), c.nv, nl);
}

// Fibres over the base: it keeps what they leave of light that comes, or of light that goes, whichever is less.
struct Sheen {
  double nv, most, albedo;  // The largest of the colour's components.
};

Sheen sheen_of(const ShadingPoint& s, const Direction& v) {
  const double most = std::max(s.sheen.x, std::max(s.sheen.y, s.sheen.z));
  if (most <= 0) return {1, 0, 0};
  const double nv = std::clamp(glm::dot(s.normal, v), 1e-3, 1.0);
  return {nv, most, sheen_albedo(nv, s.sheen_roughness)};
}

Flux lit(const Sheen& f, const ShadingPoint& s, const Direction& v, const Direction& from, const Flux& base) {
  const double nl = glm::dot(s.normal, from);
  if (nl <= 0) return Flux(0);
  const double left = 1 - f.most * std::max(f.albedo, sheen_albedo(nl, s.sheen_roughness));
  const double nh = glm::dot(s.normal, glm::normalize(from + v));
  return left * base + nl * sheen(nh, f.nv, nl, s.sheen_roughness) * Flux(s.sheen);
}

// The part of the light that the coat and the fibres leave to the base.
double left_to_base(const Coat& c, const Sheen& f) { return (1 - c.part) * (1 - f.most * f.albedo); }

// Whether the light of the environment is found over the lobe, not in a prefiltered level.
bool has_lobe(const Lighting& l, float roughness) {
  if (l.environment == nullptr || roughness < least_lobe_roughness) return false;
  return l.integral != nullptr || !l.environment->light.sampled.empty();
}

// The part of a reflection that the environment gives as it is.
double sharp_part(const Lighting& l, float roughness) {
  if (l.environment == nullptr || has_lobe(l, roughness)) return 0;
  const GlossyMix mix = glossy_mix(l.environment->light.roughnesses, roughness);
  return mix.lower < 0 ? 1 - mix.part : 0;
}

// A part of a sun widens the lobe by half of its own radius, as half vectors turn half as far as the light: an estimate
// that matters where the lobe is narrower than that part alone.
Glint glint_of(const Lighting& l, const PlacedLight& light, float roughness, bool is_sharp) {
  const double alpha = alpha_of(roughness);
  if (light.spread == 0) return {alpha};
  return {std::hypot(alpha, 0.5 * light.spread), is_sharp ? 0 : 1 - sharp_part(l, roughness)};
}

Flux sampled_radiance(const Lighting& l, const Direction& n, const Direction& v, float roughness, const Flux& f0,
                      double f90) {
  return Flux(l.ambient) + sampled_mean(l.environment->light.sampled, n, v, alpha_of(roughness), f0, f90);
}

// What fibres of colour 1 reflect.
Flux cloth(const ShadingPoint& s, const Direction& v, const Lighting& l, double albedo, const Flux& reached,
           const Flux& irradiance) {
  if (l.integral == nullptr || l.environment == nullptr || albedo == 0) return albedo * irradiance;
  return double(s.reached) * (albedo * Flux(l.ambient) + reached * l.integral->charlie(s.normal, v, s.sheen_roughness));
}

}  // namespace

Flux glossy_radiance(const Lighting& l, const Direction& from, double roughness) {
  const Flux ambient(l.ambient);
  if (l.environment == nullptr) return ambient;
  const EnvironmentLight& light = l.environment->light;
  const auto [lower, upper, part] = glossy_mix(light.roughnesses, roughness);
  const auto at = [&](int k) {
    if (k < 0) return Flux(background(l.environment, from));
    return Flux(bilinear(*light.glossy[std::size_t(k)], Cube::locate(from)));
  };
  return ambient + (part < 1 ? (1 - part) * at(lower) : Flux(0)) + (part > 0 ? part * at(upper) : Flux(0));
}

Flux transmitted_radiance(const Lighting& l, const Direction& from, double roughness) {
  Flux sum = glossy_radiance(l, from, roughness);
  if (l.environment == nullptr || l.environment->light.suns.empty()) return sum;
  const GlossyMix mix = glossy_mix(l.environment->light.roughnesses, roughness);
  const double blurred = mix.lower < 0 ? mix.part : 1;
  if (blurred == 0) return sum;
  const Ggx lobe(roughness);
  for (const DiscLight& sun : l.environment->light.suns)
    sum += blurred * lobe.value(1 - glm::dot(from, sun.towards)) * sun.flux;
  return sum;
}

std::vector<PlacedLight> placed_lights(const SceneGraph& scene, const Pose& pose) {
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

// Vogel 1979, "A better way to construct the sunflower head": rings of the same area, the golden angle apart.
std::vector<PlacedLight> sun_lights(std::span<const DiscLight> suns, int count) {
  constexpr double golden_turns = 0.3819660112501051;
  std::vector<PlacedLight> all;
  for (const DiscLight& sun : suns) {
    const Rotation frame = upright_about(sun.towards);
    const double radius = sun.radius_degrees * pi / 180, s = portable::sin(0.5 * radius);
    for (int k = 0; k < count; ++k) {
      const double less = 2 * s * s * (k + 0.5) / count;  // 1 - cosine.
      const double aside = std::sqrt(less * (2 - less)), turns = 2 * golden_turns * k;
      const Direction from =
          frame * Direction(aside * portable::cos_pi(turns), aside * portable::sin_pi(turns), 1 - less);
      all.push_back({.kind = PunctualLight::Kind::directional,
                     .position = Direction(0),
                     .direction = -from,
                     .intensity = Colour(sun.flux / double(count)),
                     .range = 0,
                     .inner = 1,
                     .outer = 1,
                     .spread = radius_of_disc(solid_angle_of_disc(radius) / count)});
    }
  }
  return all;
}

Lighting lighting(const FrameState& shot, const EmbreeScene* obstacles) {
  Lighting all{
      placed_lights(shot.scene, shot.pose), shot.environment, shot.ambient, obstacles, shot.shadows, shot.distant};
  if (shot.environment == nullptr) return all;
  const std::vector<PlacedLight> suns = sun_lights(shot.environment->light.suns, rays_per_sun);
  all.lights.insert(all.lights.end(), suns.begin(), suns.end());
  return all;
}

bool in_shadow(const EmbreeScene& obstacles, const ShadingPoint& s, const PlacedLight& light) {
  const bool parallel = light.kind == PunctualLight::Kind::directional;
  const Direction way = light.position - s.shadow_origin;
  const double distance = parallel ? std::numeric_limits<double>::infinity() : glm::length(way);
  if (distance == 0) return false;
  const Direction towards = parallel ? -light.direction : way / distance;
  return obstacles.blocked(s.shadow_origin, s.smooth_normal, towards, distance, light.node);
}

Flux unoccluded(const EmbreeScene& obstacles, const ShadingPoint& s, std::span<const DistantLight> distant) {
  Flux all(0), reached(0);
  for (const DistantLight& light : distant) {
    const double cosine = glm::dot(s.smooth_normal, light.from);
    if (cosine <= 0) continue;
    const Flux there = cosine * Flux(light.irradiance);
    all += there;
    constexpr double endless = std::numeric_limits<double>::infinity();
    if (!obstacles.blocked(s.shadow_origin, s.smooth_normal, light.from, endless, -1)) reached += there;
  }
  for (int k = 0; k < 3; ++k) reached[k] = all[k] > 0 ? reached[k] / all[k] : 1;
  return reached;
}

ShadingResult scatter(const ShadingPoint& s, const Direction& v, const Lighting& l, const SharpLayers& sharp) {
  const Direction& n = s.normal;
  const Base base = base_of(s, v);
  const Coat coat = coat_of(s, v);
  const Sheen fibres = sheen_of(s, v);
  const double metallic = s.metallic, transmitted = s.transmission, through = 1 - coat.part;
  const double under = left_to_base(coat, fibres);

  // The environment: what is reflected once, and what after bouncing between microfacets, of either material.
  const ScaleBias table = split_sum(base.nv, s.roughness);
  const double more = 1 - table.scale - table.bias;
  const auto once = [&](const Flux& f0, double f90) { return f0 * table.scale + f90 * table.bias; };
  const auto later = [&](const Flux& f0, double f90) {
    const Flux mean = f0 + (f90 - f0) / 21.0;
    return once(f0, f90) * mean / (1.0 - more * mean) * more;
  };
  const Flux reached = l.obstacles != nullptr ? unoccluded(*l.obstacles, s, l.distant) : Flux(1);
  const Flux &plain = base.plain, rest = 1.0 - once(plain, base.edge) - later(plain, base.edge);
  const Flux irradiance = double(s.reached) * diffuse_light(l, n, reached);
  const Flux bounced = glm::mix(later(plain, base.edge), later(base.colour, 1), metallic);
  const Flux even = rest * base.dielectric * (1 - transmitted) + bounced;
  const Flux fibre_light = through * Flux(s.sheen) * cloth(s, v, l, fibres.albedo, reached, irradiance);
  ShadingResult out{.radiance = through * Flux(s.emissive) + fibre_light +
                                (under * even + coat.part * (1 - coat.once)) * irradiance,
                    .reflected = under * s.reached * glm::mix(once(plain, base.edge), once(base.colour, 1), metallic),
                    .transmitted = under * rest * base.dielectric * transmitted,
                    .coat = Flux(coat.part * coat.once * s.reached),
                    .mirrored = 2 * glm::dot(n, v) * n - v,
                    .refracted = s.solid ? glm::refract(-v, n, 1.0 / std::max(1.0F, s.ior)) : -v,
                    .coat_mirrored = 2 * glm::dot(s.coat_normal, v) * s.coat_normal - v};

  for (const PlacedLight& light : l.lights) {
    Direction from;
    const Flux there = arriving(light, s.position, from);
    if (glm::dot(s.smooth_normal, from) <= 0) continue;
    Flux part = lit(base, s, v, from, glint_of(l, light, s.roughness, sharp.base));
    // What punctual lights lack by glTF's formulae, suns have as their texels did.
    if (light.spread > 0) part += std::max(0.0, glm::dot(n, from)) / pi * bounced;
    if (fibres.most > 0) part = lit(fibres, s, v, from, part);
    if (coat.part > 0)
      part = through * part + coat.part * lit(coat, s, v, from, glint_of(l, light, s.coat_roughness, sharp.coat));
    if (part == Flux(0) || (l.obstacles != nullptr && l.shadows && in_shadow(*l.obstacles, s, light))) continue;
    out.radiance += there * part;
  }
  return out;
}

Flux reflected_light(const ShadingPoint& s, const Direction& v, const Lighting& l, const ShadingResult& out) {
  if (!has_lobe(l, s.roughness)) return out.reflected * glossy_radiance(l, out.mirrored, s.roughness);
  const Base base = base_of(s, v);
  const double metallic = s.metallic, part = left_to_base(coat_of(s, v), sheen_of(s, v)) * s.reached;
  const Flux f0 = glm::mix(base.plain, base.colour, metallic);
  const double f90 = glm::mix(base.edge, 1.0, metallic);
  if (l.integral == nullptr) return out.reflected * sampled_radiance(l, s.normal, v, s.roughness, f0, f90);
  return out.reflected * Flux(l.ambient) + part * l.integral->ggx(s.normal, v, alpha_of(s.roughness), f0, f90);
}

Flux coat_light(const ShadingPoint& s, const Direction& v, const Lighting& l, const ShadingResult& out) {
  if (!has_lobe(l, s.coat_roughness)) return out.coat * glossy_radiance(l, out.coat_mirrored, s.coat_roughness);
  if (l.integral == nullptr) return out.coat * sampled_radiance(l, s.coat_normal, v, s.coat_roughness, Flux(1), 1);
  const double part = coat_of(s, v).part * s.reached;
  return out.coat * Flux(l.ambient) + part * l.integral->ggx(s.coat_normal, v, alpha_of(s.coat_roughness), Flux(1), 1);
}

Flux transmittance(const Flux& absorption, double way) {
  Flux part(1);
  for (int k = 0; k < 3; ++k)
    if (absorption[k] > 0) part[k] = portable::exp(-absorption[k] * way);
  return part;
}

Colour shade(const ShadingPoint& s, const Direction& v, const Lighting& l) {
  const ShadingResult out = scatter(s, v, l);
  Flux sum = out.radiance + reflected_light(s, v, l, out);
  if (s.transmission > 0)
    sum += out.transmitted * transmittance(Flux(s.absorption), s.thickness) *
           transmitted_radiance(l, out.refracted, s.roughness);
  if (s.coat > 0) sum += coat_light(s, v, l, out);
  return Colour(sum);
}

}  // namespace envmap

/// @file
/// The light that a surface sends towards the viewer: glTF 2.0's metallic-roughness material under punctual lights,
/// even ambient light and an environment. shaders/shading.glsl is the same for the graphics card.
///
/// Punctual lights cast shadows. Of the environment's light surfaces keep what is diffused from each other; they light
/// each other only through maps. Sources: "glTF 2.0 Specification", appendix B; KHR_lights_punctual;
/// KHR_materials_transmission, _ior, _volume, _clearcoat and _sheen; Karis 2013 (the split sum); Fdez-Aguera 2019, "A
/// multiple-scattering microfacet model for real-time image-based lighting", so that white surfaces of any roughness in
/// a white environment stay white.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "envmap/base/run.h"
#include "envmap/light/distant_lights.h"
#include "envmap/light/lights.h"
#include "envmap/operate/lookup.h"
#include "envmap/sample/padded_level.h"
#include "envmap/scenes/render/draw.h"
#include "envmap/scenes/render/glossy_levels.h"

namespace envmap {

class LobeIntegral;
class EmbreeScene;
class Prefilterer;

/// Seen from outside: its normals face the viewer.
struct ShadingPoint {
  Direction position{0}, normal{0, 0, 1};  ///< World.
  Direction smooth_normal{0, 0, 1};        ///< Before the normal map: shadows are found with it.
  glm::vec4 base_colour{1};
  float metallic = 0, roughness = 1;
  Colour emissive{0};
  float transmission = 0, ior = 1.5F;
  float opacity = 1;                   ///< The part of what is behind that it covers: alpha of blended materials.
  bool solid = false;                  ///< Material::solid.
  Colour absorption{0};                ///< Material::absorption.
  float thickness = 0;                 ///< Material::thickness in the world.
  float coat = 0, coat_roughness = 0;  ///< Material::coat, with its own normal.
  Direction coat_normal{0, 0, 1};
  Colour sheen{0};  ///< Material::sheen.
  float sheen_roughness = 0;
  float reached = 1;  ///< Part of the light from all round that does reach it: by the occlusion map.
  /// Where shadows are found: on the curved surface that the normals of the triangle's corners tell of, which surrounds
  /// triangles that are convex, so that these do not shade themselves (Hanika 2021, "Hacking the shadow terminator").
  Direction shadow_origin{0};
};

/// What an environment gives surfaces, made once for it.
struct EnvironmentLight {
  /// Irradiance over pi in direction (x,y,z): the sum of these times 1, x, y, z, xz, xy, 3y^2-1, yz, z^2-x^2; what
  /// falls below 0 beside suns is 0 (Ramamoorthi and Hanrahan 2001). Off by 1% on average and 9% at worst.
  std::array<Colour, 9> irradiance{};
  /// GGX-prefiltered cubes in the world's frame for each of the roughnesses, which rise. Their heights are `size`, its
  /// double or its fourfold. Roughness 0 is the environment itself.
  std::vector<std::shared_ptr<const PaddedLevel>> glossy;
  std::vector<float> roughnesses;
  /// sampled_levels(): what surfaces reflect is sampled, all but rough glass. Empty: `glossy` stands for it.
  std::vector<PaddedLevel> sampled = {};
  /// Lights of their own, with shadows: all above is of the map without them.
  std::vector<DiscLight> suns = {};
};

/// EnvironmentLight::irradiance of a map.
std::array<Colour, 9> irradiance_over_pi(const EnvironmentMap& map);

/// One of EnvironmentLight::glossy. @param size of cubes for wide lobes. @param largest of all.
std::shared_ptr<const PaddedLevel> glossy_level(const Prefilterer& source, float roughness, int size, int largest);

/// @param roughnesses of glossy_levels.h. @param size of cubes for wide lobes. @param largest of all.
/// @param progress may be empty.
EnvironmentLight environment_light(const EnvironmentMap& map, const std::vector<float>& roughnesses, int size,
                                   int largest, const Progress& progress = {});

/// Of two levels, the lower -1 where it is the environment itself, and how far it is from the lower to the upper.
struct GlossyMix {
  int lower, upper;
  double part;
};
GlossyMix glossy_mix(const std::vector<float>& roughnesses, double roughness);

/// What lies all round a scene: a map, and what it gives surfaces.
struct Environment {
  explicit Environment(EnvironmentMap from, int size = glossy_size, const Progress& progress = {},
                       const std::vector<float>& roughnesses = even_roughnesses())
      : source(std::make_shared<const EnvironmentMap>(std::move(from))),
        map(*source),
        lookup(map),
        light(environment_light(map, roughnesses, size, 4 * size, progress)) {}
  /// Of a map that others share.
  /// @param without the map without the light's suns; null: it has none.
  Environment(std::shared_ptr<const EnvironmentMap> from, EnvironmentLookup look, EnvironmentLight given,
              std::shared_ptr<const EnvironmentMap> without = nullptr)
      : source(std::move(from)),
        map(*source),
        lookup(std::move(look)),
        light(std::move(given)),
        remainder(without ? std::move(without) : source) {}

  std::shared_ptr<const EnvironmentMap> source;
  const EnvironmentMap& map;  ///< The source: what lies behind all, and what sharp reflections show.
  EnvironmentLookup lookup;
  EnvironmentLight light;
  std::shared_ptr<const EnvironmentMap> remainder = source;  ///< What lights surfaces beside the light's suns.
};

/// Scale and bias of the split sum (prefilter/brdf_table.h), made once: columns cosine, rows roughness.
inline constexpr int split_sum_size = 32;
const std::vector<Colour>& split_sum_table();

/// A PunctualLight in the world.
struct PlacedLight {
  PunctualLight::Kind kind;
  Direction position, direction;  ///< It shines along `direction`.
  Colour intensity;
  double range;
  double inner, outer;  ///< Cosines of the half angles.
  int node = -1;        ///< What hangs on it casts no shadow of this light.
  /// Of parts of suns (sun_lights()), else 0: the angular radius of such a part. Sharp reflections do not show them.
  double spread = 0;
};
std::vector<PlacedLight> placed_lights(const SceneGraph& scene, const Pose& pose);

/// How many directional lights stand for a sun where rays find shadows, and where shadow maps do.
inline constexpr int rays_per_sun = 64, maps_per_sun = 16;

/// So many directional lights for each sun, spread evenly over its disc: the half shadow has as many steps.
std::vector<PlacedLight> sun_lights(std::span<const DiscLight> suns, int lights_per_sun);

/// All that shines on a scene at one moment. What it points to must outlive it.
struct Lighting {
  std::vector<PlacedLight> lights;
  const Environment* environment = nullptr;  ///< Null: black.
  Colour ambient{0};
  const EmbreeScene* obstacles = nullptr;   ///< What casts shadows; null: nothing.
  bool shadows = true;                      ///< Of the lights, too.
  std::span<const DistantLight> distant{};  ///< FrameState::distant.
  /// Over `environment`: takes the place of its prefiltered levels and of its harmonics,
  /// of all but rough glass. Optional.
  const LobeIntegral* integral = nullptr;
};
/// @param obstacles of the shot, or null: then nothing casts a shadow.
Lighting lighting(const FrameState& shot, const EmbreeScene* obstacles = nullptr);

/// Radiance of the environment, without ambient light, from a world direction: black where there is none.
Colour background(const Environment* environment, const Direction& from);

/// Whether a light does not reach the surface: something that casts_shadow() is in between.
bool in_shadow(const EmbreeScene& obstacles, const ShadingPoint& surface, const PlacedLight& light);

/// The part of the environment's diffuse light that reaches the surface: of its distant lights on that side.
Flux unoccluded(const EmbreeScene& obstacles, const ShadingPoint& surface, std::span<const DistantLight> distant);

/// What leaves a surface towards the viewer: light of its own and of lights,
/// and parts of what comes from three directions.
struct ShadingResult {
  Flux radiance{0};
  Flux reflected{0}, transmitted{0}, coat{0};
  /// Where that comes from, away from the surface. A thin wall does not bend it.
  Direction mirrored{0}, refracted{0}, coat_mirrored{0};
};

/// Which layers of a surface show what is mirrored there: no glints of suns, which are in what they show.
struct SharpLayers {
  bool base = false, coat = false;
};

/// @param towards_viewer unit vector.
ShadingResult scatter(const ShadingPoint& surface, const Direction& towards_viewer, const Lighting& lighting,
                      const SharpLayers& sharp = {});

/// The part of light that a way through a solid leaves. @param absorption Material::absorption. @param way metres.
Flux transmittance(const Flux& absorption, double way);

/// Radiance of the environment and of ambient light from a world direction, blurred by roughness.
Flux glossy_radiance(const Lighting& lighting, const Direction& from, double roughness);

/// The same as rough glass lets it through: with the suns.
Flux transmitted_radiance(const Lighting& lighting, const Direction& from, double roughness);

/// What the base reflects, and what the coat does, of the environment and of ambient light.
/// @param scattered by scatter().
Flux reflected_light(const ShadingPoint& surface, const Direction& towards_viewer, const Lighting& lighting,
                     const ShadingResult& scattered);
Flux coat_light(const ShadingPoint& surface, const Direction& towards_viewer, const Lighting& lighting,
                const ShadingResult& scattered);

/// scatter() where the environment is all round. @param towards_viewer unit vector. @return radiance.
Colour shade(const ShadingPoint& surface, const Direction& towards_viewer, const Lighting& lighting);

}  // namespace envmap

#include "envmap/engine/suns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "envmap/io/claims/srgb.h"

namespace envmap {
namespace {

// Intensity and colour: the largest channel of the irradiance, and what the channels are of it, so that intensity x
// colour is the irradiance of each channel.
struct Intensity {
  double value;
  Flux colour;
};
Intensity intensity_of(const DiscLight& light) {
  const double most = std::max({light.irradiance.x, light.irradiance.y, light.irradiance.z});
  return {most, most > 0 ? light.irradiance / most : Flux(1)};
}

std::string numbers(const Direction& d) { return fmt::format("{:.9g}, {:.9g}, {:.9g}", d.x, d.y, d.z); }
std::string numbers(const Flux& c) { return numbers(Direction(c)); }

// A direction of the probe in the engine's world. @param axes where +X, +Y and +Z lie there: "+X +Z -Y".
Direction in_world(std::string_view axes, const Direction& d) {
  Direction out(0);
  for (int k = 0; k < 3; ++k)
    out[axes[std::size_t(3 * k + 1)] - 'X'] += (axes[std::size_t(3 * k)] == '-' ? -1 : 1) * d[k];
  return out;
}

// Lights of glTF, USD and Godot shine along their -Z: the turn that brings +Z towards them.
Rotation turn_to(const Direction& towards) { return upright_about(towards); }
glm::dquat quaternion_to(const Direction& towards) { return glm::normalize(glm::quat_cast(turn_to(towards))); }

std::string list_of(std::span<const DiscLight> lights, std::string_view axes, std::string_view form) {
  std::string text;
  for (const DiscLight& light : lights) {
    const Intensity i = intensity_of(light);
    text += fmt::format(fmt::runtime(form), fmt::arg("towards", numbers(in_world(axes, light.towards))),
                        fmt::arg("intensity", i.value), fmt::arg("colour", numbers(i.colour)),
                        fmt::arg("diameter", 2 * light.radius_degrees),
                        fmt::arg("radians", 2 * light.radius_degrees * pi / 180));
  }
  return text;
}

constexpr std::string_view sun_of_script =
    "  {{ towards: [{towards}], intensity: {intensity:.9g}, colour: [{colour}], diameter: {diameter:.6g} }},\n";

// ---- scripts --------------------------------------------------------------------------------------------------------

std::string three_text(const Engine& engine, std::span<const DiscLight> lights) {
  return "// The suns of the probe as lights; the maps hold the rest.\nimport * as THREE from 'three';\n\n"
         "// towards: where the sun is. intensity: DirectionalLight.intensity, lux. diameter: degrees.\n"
         "export const suns = [\n" +
         list_of(lights, engine.axes, sun_of_script) +
         "];\n\nexport function addSuns(scene, distance = 100) {\n"
         "  for (const sun of suns) {\n"
         "    const light = new THREE.DirectionalLight(new THREE.Color().setRGB(...sun.colour), sun.intensity);\n"
         "    light.position.set(...sun.towards).multiplyScalar(distance);\n"
         "    light.castShadow = true;\n"
         "    scene.add(light, light.target);\n  }\n}\n";
}

std::string babylon_text(const Engine& engine, std::span<const DiscLight> lights) {
  return "// The suns of the probe as lights; the maps hold the rest. intensity: lux, as IntensityMode automatic has "
         "it.\n"
         "export const suns = [\n" +
         list_of(lights, engine.axes, sun_of_script) +
         "];\n\nexport function addSuns(BABYLON, scene) {\n"
         "  return suns.map((sun, k) => {\n"
         "    // The light shines away from where it is.\n"
         "    const direction = BABYLON.Vector3.FromArray(sun.towards).scale(-1);\n"
         "    const light = new BABYLON.DirectionalLight('Sun' + (k + 1), direction, scene);\n"
         "    light.diffuse = light.specular = BABYLON.Color3.FromArray(sun.colour);\n"
         "    light.intensity = sun.intensity;\n"
         "    return light;\n  });\n}\n";
}

std::string blender_text(const Engine& engine, std::span<const DiscLight> lights) {
  return std::string(engine.text.text) +
         "\n# The suns of the probe, which background.exr does not hold: (towards, W/m^2, colour, diameter in "
         "radians).\n"
         "from mathutils import Vector\n\nSUNS = [\n" +
         list_of(lights, engine.axes, "    (({towards}), {intensity:.9g}, ({colour}), {radians:.9g}),\n") +
         "]\n"
         "for towards, energy, colour, angle in SUNS:\n"
         "    light = bpy.data.lights.new(\"Sun\", \"SUN\")\n"
         "    light.energy, light.color, light.angle = energy, colour, angle\n"
         "    sun = bpy.data.objects.new(\"Sun\", light)\n"
         "    sun.rotation_mode = \"QUATERNION\"\n"
         "    sun.rotation_quaternion = Vector(towards).to_track_quat(\"Z\", \"Y\")\n"
         "    bpy.context.scene.collection.objects.link(sun)\n"
         "if hasattr(world, \"sun_threshold\"):  # EEVEE would take a sun out of the map once more.\n"
         "    world.sun_threshold = 0\n";
}

std::string usd_text(const Engine& engine, std::span<const DiscLight> lights) {
  std::string suns;
  int number = 0;
  for (const DiscLight& light : lights) {
    const Intensity i = intensity_of(light);
    const glm::dquat q = quaternion_to(in_world(engine.axes, light.towards));
    suns += fmt::format(
        "\n    def DistantLight \"Sun{}\"\n    {{\n        float inputs:angle = {:.6g}\n"
        "        color3f inputs:color = ({})\n        float inputs:intensity = {:.9g}\n"
        "        bool inputs:normalize = 1\n        quatd xformOp:orient = ({:.12g}, {:.12g}, {:.12g}, {:.12g})\n"
        "        uniform token[] xformOpOrder = [\"xformOp:orient\"]\n    }}\n",
        ++number, 2 * light.radius_degrees, numbers(i.colour), i.value, q.w, q.x, q.y, q.z);
  }
  std::string text(engine.text.text);
  return text.insert(text.rfind('}'), suns);
}

// light_color is encoded: the engine decodes it.
std::string godot_text(const Engine&, std::span<const DiscLight> lights) {
  std::string text = "[gd_scene format=3]\n\n[node name=\"Suns\" type=\"Node3D\"]\n";
  int number = 0;
  for (const DiscLight& light : lights) {
    const Intensity i = intensity_of(light);
    const Rotation r = turn_to(light.towards);
    std::string basis;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) basis += fmt::format("{:.9g}, ", r[column][row]);
    Colour encoded(i.colour);
    encode_srgb({&encoded, 1});
    text += fmt::format(
        "\n[node name=\"Sun{}\" type=\"DirectionalLight3D\" parent=\".\"]\ntransform = Transform3D({}0, 0, 0)\n"
        "light_color = Color({}, 1)\nlight_energy = {:.9g}\nlight_angular_distance = {:.6g}\n"
        "shadow_enabled = true\nsky_mode = 1\n",
        ++number, basis, numbers(Flux(encoded)), i.value / pi, 2 * light.radius_degrees);
  }
  return text;
}

std::string table_text(const Engine& engine, std::span<const DiscLight> lights) {
  return fmt::format(
             "The suns of the probe as lights, in the axes of {}. The maps hold the rest.\n{}\n"
             "Irradiance of a plane that faces the sun, in the unit of the maps: intensity x colour (linear "
             "Rec.709).\n\n",
             engine.title, suns_unit(engine)) +
         list_of(
             lights, engine.axes,
             "towards ({towards})  intensity {intensity:.9g}  colour ({colour})  diameter {diameter:.6g} degrees\n");
}

// ---- the engines ----------------------------------------------------------------------------------------------------

std::string gltf_text(const Engine&, std::span<const DiscLight> lights) { return gltf_lights(lights); }

struct SunsOf {
  std::string_view engine, file;
  std::string (*text)(const Engine&, std::span<const DiscLight>);
  std::string_view unit;
};

// Each row names the source of its unit. An engine without a row has the last. What the sources say:
// - bevy: docs.rs, DirectionalLight: a table of illuminance in lux. It shines along -Z.
// - blender: manual, Light Objects, Sun: strength in watts per square metre.
// - filament: LightManager.h: intensity() of directional lights is illuminance in lux; sunAngularRadius() the radius in
//   degrees, 0.25 to 20.
// - gltf: KHR_lights_punctual: directional lights use illuminance in lux (lm/m^2).
// - three: GLTFLoader.js takes that intensity over unchanged, and BRDF_Lambert of common.glsl.js divides by pi.
// - unity: HDAdditionalLightData.cs: directional lights in lux, angularDiameter in degrees.
// - unreal: "Physical Lighting Units": directional lights are direct normal illuminance in lux, the sky light cd/m^2.
//   DirectionalLightComponent, LightSourceAngle: the angular diameter in degrees.
constexpr SunsOf suns_rows[] = {
    // packages/dev/core/src/Lights/light.ts, _getPhotometricScale(): directional lights are in lux, factor 1.
    {"babylon", "suns.js", babylon_text,
     "addSuns(BABYLON, scene) of suns.js adds them. DirectionalLight.intensity is in lux (Lights/light.ts, "
     "_getPhotometricScale)."},
    {"bevy", "suns.txt", table_text,
     "DirectionalLight.illuminance is in lux (docs.rs/bevy, DirectionalLight); EnvironmentMapLight.intensity "
     "multiplies "
     "the maps: multiply the illuminance by it, too."},
    {"blender", "world.py", blender_text,
     "The strength of a sun lamp is its irradiance in W/m^2, and radiance 1 of the world is 1 W/(m^2 sr) (manual, "
     "Lights, Power of Lights)."},
    // packages/engine/Source/Shaders/Model/LightingStageFS.glsl: czm_lightColorHdr x the BRDF, whose diffuse part is
    // the colour over pi.
    {"cesium", "suns.txt", table_text,
     "scene.light = new Cesium.DirectionalLight({ direction, color, intensity }): intensity x colour is the irradiance "
     "(LightingStageFS.glsl). The direction is away from the sun, in world coordinates: turn it with "
     "Cesium.Transforms.eastNorthUpToFixedFrame. A scene has one such light."},
    {"filament", "suns.txt", table_text,
     "LightManager::Builder(SUN): intensity() is in lux, sunAngularRadius() half of the diameter in degrees "
     "(LightManager.h); IndirectLight's intensity multiplies the maps: multiply the sun's by it, too."},
    {"gltf", "suns.gltf", gltf_text,
     "The intensity of directional lights is in lux (KHR_lights_punctual), the map in cd/m^2."},
    // servers/rendering/renderer_rd/storage_rd/light_storage.cpp: energy is multiplied by pi where physical units are
    // off, the colour decoded from sRGB.
    {"godot", "suns.tscn", godot_text,
     "Add suns.tscn to the scene. light_energy times pi is the irradiance where physical light units are off "
     "(light_storage.cpp)."},
    {"three", "suns.js", three_text,
     "import { addSuns } from './suns.js', then addSuns(scene). DirectionalLight.intensity is in lux (three.js docs), "
     "radiance of the map in cd/m^2."},
    {"unity", "suns.txt", table_text,
     "HDRP: Intensity is in lux, Angular Diameter in degrees (manual, Light component); the sky's multiplier "
     "multiplies "
     "the map: multiply the intensity by it, too. Built-in pipeline and URP: intensity / pi."},
    {"unreal", "suns.txt", table_text,
     "Directional Light: Intensity is in lux, Source Angle the diameter in degrees (documentation, Physical Lighting "
     "Units); the Sky Light's Intensity Scale multiplies the map: multiply the intensity by it, too."},
    // UsdLux, "Normalizing Distant Lights - In Depth": luminance = intensity / sizeFactor, sizeFactor = pi sin^2 of
    // half the angle, which is the irradiance of a disc of luminance 1.
    {"usd", "light.usda", usd_text,
     "DistantLight with inputs:normalize has its irradiance as inputs:intensity, and inputs:angle is its diameter in "
     "degrees (openusd.org, UsdLuxDistantLight)."},
    {"", "suns.txt", table_text, "The unit is that of the maps: with radiance in cd/m^2, lux."},
};

const SunsOf& row_of(const Engine& engine) {
  const auto found = std::ranges::find(suns_rows, family_of(engine), &SunsOf::engine);
  return found == std::end(suns_rows) ? suns_rows[std::size(suns_rows) - 1] : *found;
}

}  // namespace

std::string gltf_lights(std::span<const DiscLight> lights, double lux) {
  std::string all, nodes, indices;
  for (std::size_t k = 0; k < lights.size(); ++k) {
    const Intensity i = intensity_of(lights[k]);
    const glm::dquat q = quaternion_to(lights[k].towards);
    const std::string_view comma = k + 1 < lights.size() ? ",\n" : "\n";
    all += fmt::format(
        "    {{\"type\": \"directional\", \"name\": \"Sun{}\", \"intensity\": {:.9g}, \"color\": [{}], \"extras\": "
        "{{\"angularDiameter\": {:.6g}}}}}{}",
        k + 1, lux * i.value, numbers(i.colour), 2 * lights[k].radius_degrees, comma);
    nodes += fmt::format(
        "  {{\"name\": \"Sun{0}\", \"rotation\": [{1:.12g}, {2:.12g}, {3:.12g}, {4:.12g}], \"extensions\": "
        "{{\"KHR_lights_punctual\": {{\"light\": {5}}}}}}}{6}",
        k + 1, q.x, q.y, q.z, q.w, k, comma);
    indices += fmt::format("{}{}", k > 0 ? ", " : "", k);
  }
  return fmt::format(
      "{{\n \"asset\": {{\"version\": \"2.0\", \"generator\": \"envmap\"}},\n"
      " \"extensionsUsed\": [\"KHR_lights_punctual\"],\n"
      " \"extensions\": {{\"KHR_lights_punctual\": {{\"lights\": [\n{}   ]}}}},\n"
      " \"nodes\": [\n{} ],\n \"scenes\": [{{\"nodes\": [{}]}}],\n \"scene\": 0\n}}\n",
      all, nodes, indices);
}

std::string suns_file_name(const Engine& engine) { return std::string(row_of(engine).file); }

std::string_view suns_unit(const Engine& engine) { return row_of(engine).unit; }

NamedText suns_file(const Engine& engine, std::span<const DiscLight> lights) {
  const SunsOf& row = row_of(engine);
  return {std::string(row.file), row.text(engine, lights)};
}

}  // namespace envmap

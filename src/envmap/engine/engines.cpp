#include "envmap/engine/engines.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "envmap/base/error.h"
#include "envmap/engine/shader_text.h"
#include "envmap/maths/portable.h"

namespace envmap {
namespace {

constexpr std::string_view background_exr = "background.exr";

// Blender takes EXR files for linear floats. In the text editor it sets __file__ to FILE.blend/NAME OF THE TEXT,
// which is no path.
constexpr std::string_view blender_script = R"(# A world lit by background.exr beside this script.
# Run it in the text editor, or: blender SCENE.blend --python world.py
import os
import bpy


def find(name):
    """Looks beside this script, as a text of Blender or as a file, and beside the .blend file."""
    text = bpy.data.texts.get(os.path.basename(__file__))
    paths = [bpy.path.abspath(text.filepath)] if text and text.filepath else []
    paths += [os.path.abspath(__file__), bpy.data.filepath]
    found = [os.path.join(os.path.dirname(path), name) for path in paths]
    for file in found:
        if os.path.isfile(file):
            return file
    raise FileNotFoundError(name + " is not beside world.py: open world.py from its folder (Text > Open), or save the .blend file there")


world = bpy.data.worlds.new("Probe")
world.use_nodes = True
nodes, links = world.node_tree.nodes, world.node_tree.links
nodes.clear()
image = nodes.new("ShaderNodeTexEnvironment")
image.image = bpy.data.images.load(find("background.exr"))
image.projection = "EQUIRECTANGULAR"
shader = nodes.new("ShaderNodeBackground")
output = nodes.new("ShaderNodeOutputWorld")
links.new(image.outputs["Color"], shader.inputs["Color"])
links.new(shader.outputs["Background"], output.inputs["Surface"])
bpy.context.scene.world = world
)";

constexpr std::string_view godot_resource = R"([gd_resource type="Environment" load_steps=4 format=3]

[ext_resource type="Texture2D" path="background.exr" id="1"]

[sub_resource type="PanoramaSkyMaterial" id="material"]
panorama = ExtResource("1")

[sub_resource type="Sky" id="sky"]
sky_material = SubResource("material")

[resource]
background_mode = 2
sky = SubResource("sky")
ambient_light_source = 3
reflected_light_source = 2
)";

constexpr std::string_view pbrt_light = R"(# Include "light.pbrt" behind WorldBegin. For a scene with +Y up; with +Z up leave out the Rotate.
AttributeBegin
  Rotate -90 1 0 0
  LightSource "infinite" "string filename" "background.exr"
AttributeEnd
)";

constexpr std::string_view usd_layer = R"(#usda 1.0
(
    defaultPrim = "Probe"
    upAxis = "Y"
)

def DomeLight "Probe"
{
    asset inputs:texture:file = @./background.exr@
    token inputs:texture:format = "latlong"
    float inputs:intensity = 1
}
)";

// What both languages of shaders/envmap.glsl say.
constexpr std::string_view lookups_turns = "In a left-handed world, negate the axis of the direction that is negated in the models.";
constexpr std::string_view lookups_light =
    "the specular map has 6 levels, with roughness 0, 0.106, 0.225, 0.368, 0.553 and 1: 1 - sqrt(1 - k/5) in level k; brdf.exr is "
    "the split-sum table, with n.v across and roughness down, scale in red and bias in green; irradiance.txt holds the irradiance "
    "over pi of a surface that faces (x, y, z), as 9 colours for 1, y, z, x, xy, yz, 3z^2 - 1, zx, x^2 - y^2, windowed where it "
    "would be negative";

// Sources, by row:
// babylon: shadersStore pbrIBLFunctions (getLodFromAlphaG) and vReflectionMicrosurfaceInfos, CubeTexture's 0.8 for
//   CreateFromPrefilteredData; its glTF loader's root node: turned half round Y, Z negated.
// bevy: compute_cubemap_sample_dir and radiance_level in crates/bevy_pbr/src/light_probe/environment_map.wgsl (commit
// 00ab817cdfa1: z
//   negated; roughness x the last level; the diffuse map times the colour, without pi),
// crates/bevy_core_pipeline/src/skybox/skybox.wgsl
//   (z negated), crates/bevy_image/src/ktx2.rs: E5B9G9R9 is Rgb9e5Ufloat.
// babylon-env, gltf: src/envmap/io/babylon_env.h, gltf_light.h; irradiance.cpp.
// blender: node_tex_environment_equirectangular in
// source/blender/gpu/shaders/material/gpu_shader_material_tex_environment.glsl,
//   u = 0.5 - atan2(y, x) / 2 pi, v up = 0.5 + atan2(z, hypot(x, y)) / pi, and Cycles'
// intern/cycles/kernel/camera/projection.h.
// filament: perceptualRoughnessToLod in shaders/src/light_indirect.fs,
// computeIrradianceSH3Bands in libs/ibl/src/CubemapSH.cpp,
//   libs/ktxreader/src/Ktx1Reader.cpp, getSphericalHarmonics in libs/image/src/Ktx1Bundle.cpp; 256 and 5 levels: the
// shader's comment.
// godot: servers/rendering/renderer_rd/shaders/environment/sky.glsl, panorama_coords = (atan(x, -z) / 2 pi,
// acos(y) / pi);
//   paths relative to a resource: scene/resources/resource_format_text.cpp; the enumerators:
// scene/resources/environment.h.
// pbrt: EqualAreaSphereToSquare in src/pbrt/util/math.cpp, ImageInfiniteLight::Le in src/pbrt/lights.h.
// playcanvas: shader chunk sphericalPS and the skybox's, which negates x.
// three: equirectUv in src/renderers/shaders/ShaderChunk/common.glsl.js, u = 0.5 + atan(z, x) / 2 pi,
// v up = 0.5 + asin(y) / pi;
//   examples/jsm/loaders/EXRLoader.js: HalfFloatType unless told otherwise. (HDRLoader divides by 255, not by 256:
// white is 1.004.)
// unity: ToRadialCoords in the built-in shader Skybox-Panoramic.shader, u = 0.5 - atan2(z, x) / 2 pi,
// v down = acos(y) / pi; glTFast and
//   UnityGLTF negate X.
// unreal: LookupLongLat, TransformSideToWorldSpace and GenerateBaseCubeMipFromLongitudeLatitude2D in
// TextureCompressorModule.cpp: of the
//   cube's own direction u = 0.5 + atan2(x, -y) / 2 pi, v down = acos(z) / pi. Its glTF importer takes (x, z, y) for
// (x, y, z).
// usd: openusd.org, user guide of DomeLight: "adheres to the OpenEXR specification for latitude-longitude maps".

// Babylon: lod = 0.8 log2(N alpha) of faces of N texels, alpha = roughness^2.
double babylon_roughness(int k, int /*n*/, int size) { return k == 0 ? 0 : std::min(1.0, std::sqrt(portable::exp2(k / 0.8) / size)); }

// Bevy: lod / (n - 1) = r.
double even_roughness(int k, int n, int /*size*/) { return double(k) / (n - 1); }

// Filament, and shaders/envmap.glsl: lod / (n - 1) = r (2 - r).
double filament_roughness(int k, int n, int /*size*/) { return 1 - std::sqrt(1 - double(k) / (n - 1)); }

const Engine table[] = {
    {"babylon", "Babylon.js", "9.34, run: tests/engines",
     {{"background.dds", Projection::cube, Depth::half, MirroredAxis::x},
      {"environment.dds", Projection::cube, Depth::half, MirroredAxis::x, EngineChain{128, 0, babylon_roughness}}}, 0,
     "-X +Y +Z", "file",
     "Imported glTF files have the same axes.",
     "environment.dds has levels down to one texel for the shader (lodGenerationScale 0.8); Babylon.js computes diffuse "
     "light from the first level",
     {},
     "scene.environmentTexture = BABYLON.CubeTexture.CreateFromPrefilteredData('FOLDER/environment.dds', scene);\n"
     "const sky = new BABYLON.CubeTexture('FOLDER/background.dds', scene);\n"
     "sky.gammaSpace = false;\n"
     "scene.createDefaultSkybox(sky, true, 1000, 0, false);\n"
     "In a scene with useRightHandedSystem turn both half round Y (CubeTexture.rotationY = Math.PI)."},
    {"babylon-env", "Babylon.js (.env)", "9.34, run: tests/engines",
     {{"environment.env", Projection::cube, Depth::rgbd, MirroredAxis::none, EngineChain{256, 0, babylon_roughness, IrradianceForm::babylon}}}, 0,
     "-X +Y +Z", "file",
     "All .env files are mirrored. Imported glTF files have the same axes.",
     "environment.env has levels down to one texel for the shader (lodGenerationScale 0.8) and the irradiance as a "
     "polynomial of degree 2, windowed where it would be negative; values up to 255, rounded by up to 0.6% above 1 and more "
     "below",
     {},
     "scene.environmentTexture = BABYLON.CubeTexture.CreateFromPrefilteredData('FOLDER/environment.env', scene);\n"
     "scene.createDefaultSkybox(scene.environmentTexture, true, 1000, 0, false);"},
    {"bevy", "Bevy", "0.19, shaders of commit 00ab817cdfa1, read; not run",
     {{"skybox.ktx2", Projection::cube, Depth::rgb9e5, MirroredAxis::z},
      {"specular.ktx2", Projection::cube, Depth::rgb9e5, MirroredAxis::z, EngineChain{256, 5, even_roughness}},
      {"diffuse.ktx2", Projection::cube, Depth::rgb9e5, MirroredAxis::z, {}, 64}}, 0,
     "+X +Y +Z", "file",
     "The shaders look cubes up in a left-handed frame, so the mirrored axis is Z.",
     "specular.ktx2 has 5 levels, with roughness k/4 in level k; diffuse.ktx2 is the irradiance over pi",
     {},
     "With the feature ktx2:\n"
     "commands.spawn((Camera3d::default(),\n"
     "    Skybox { image: assets.load(\"FOLDER/skybox.ktx2\"), brightness: 1.0, ..default() },\n"
     "    EnvironmentMapLight { diffuse_map: assets.load(\"FOLDER/diffuse.ktx2\"),\n"
     "        specular_map: assets.load(\"FOLDER/specular.ktx2\"), intensity: 1.0, ..default() }));\n"
     "brightness and intensity are what radiance 1 is in cd/m^2: give both the same value."},
    {"blender", "Blender", "3.4.1, run: tests/blender.py",
     {{background_exr, {Projection::latlong, Forward::plus_x}}}, 0,
     "+X +Z -Y", "no",
     "Z is up. Imported glTF files have the same axes.",
     "Cycles and EEVEE sample the image",
     {"world.py", blender_script},
     "Open world.py in the text editor of Blender and run it, or: blender SCENE.blend --python world.py"},
    {"filament", "Filament", "1.53.4 (npm), run: tests/engines",
     {{"sky.ktx", Projection::cube, Depth::half},
      {"ibl.ktx", Projection::cube, Depth::half, MirroredAxis::none, EngineChain{256, 5, filament_roughness, IrradianceForm::filament}}}, 0,
     "+X +Y +Z", "no",
     "",
     "ibl.ktx has 5 levels, with roughness 1 - sqrt(1 - k/4) in level k; the key 'sh' holds the irradiance over pi of a "
     "surface that faces (x, y, z), as 9 colours for 1, y, z, x, xy, yz, 3z^2 - 1, zx, x^2 - y^2, windowed where it would be "
     "negative",
     {},
     "const light = engine.createIblFromKtx1('FOLDER/ibl.ktx');\n"
     "scene.setIndirectLight(light);\n"
     "scene.setSkybox(engine.createSkyFromKtx1('FOLDER/sky.ktx'));\n"
     "JavaScript's createIblFromKtx1 leaves the harmonics in light.shfloats: give them to IndirectLight.Builder().irradianceSh(3, ...).\n"
     "light.setIntensity(1 / EXPOSURE) shows radiance 1 as 1, as the sky does: EXPOSURE as of camera.setExposureDirect().\n"
     "C++ (by ktxreader/Ktx1Reader.h, not run; the harmonics first, as createTexture() frees the bundle):\n"
     "auto* ktx = new image::Ktx1Bundle(bytes, size); filament::math::float3 sh[9]; ktx->getSphericalHarmonics(sh);\n"
     "auto* map = ktxreader::Ktx1Reader::createTexture(engine, ktx, false);\n"
     "auto* light = filament::IndirectLight::Builder().reflections(map).irradiance(3, sh).intensity(1 / EXPOSURE).build(*engine);\n"
     "Android (by KTX1Loader.kt, not run): KTX1Loader.createIndirectLight(engine, buffer).indirectLight, "
     "KTX1Loader.createSkybox(engine, buffer).skybox."},
    {"glsl", "GLSL", "3.30 and ES 3.00, run in Mesa: tests/render",
     {{"background.ktx2", Projection::cube, Depth::half},
      {"specular.ktx2", Projection::cube, Depth::half, MirroredAxis::none, EngineChain{256, 6, filament_roughness}}}, 0,
     "+X +Y +Z", "no",
     lookups_turns,
     lookups_light,
     {"envmap.glsl", glsl_lookups()},
     "Include envmap.glsl in a shader. Load background.ktx2 and specular.ktx2 as cube textures with trilinear filtering and seamless edges, brdf.exr as a 2D texture with linear filtering and clamped edges, and the 27 numbers of irradiance.txt as an array of 9 vec3.\n"
     "With the normal n and v, the unit vector to the eye:\n"
     "vec3 light = albedo * envmap_irradiance(irradiance, n) + envmap_specular(specular, brdf, n, v, roughness, f0);\n"
     "envmap.glsl also finds the texture coordinates of a direction in every projection and cube layout that envmap writes.",
     "brdf.exr", "irradiance.txt"},
    {"gltf", "glTF EXT_lights_image_based", "its README of commit 01b16a09b944; run in Babylon.js 9.28: tests/engines",
     {{"light.glb", Projection::cube, Depth::rgbd, MirroredAxis::none, EngineChain{256, 5, even_roughness, IrradianceForm::gltf}}}, 0,
     "+X +Y +Z", "no",
     "",
     "light.glb has 5 levels, with roughness k/4 in level k as the extension defines (the shader of Babylon.js uses another "
     "roughness), and the irradiance as spherical harmonics of degree 2, windowed where it would be negative; values up to "
     "255, rounded by up to 0.6% above 1 and more below",
     {},
     "light.glb holds the light in an empty scene: load it beside the model, or move extensions, images and bufferViews into its file.\n"
     "Babylon.js: await BABYLON.SceneLoader.AppendAsync('FOLDER/', 'light.glb', scene);\n"
     "scene.environmentTexture.gammaSpace = false; (its loader leaves it true, and levels would be decoded twice)"},
    {"godot", "Godot", "4, commit 0095d7d0c0c9, read; not run",
     {{background_exr, {Projection::latlong, Forward::plus_z}}}, 0,
     "+X +Y +Z", "no",
     "",
     "Godot computes it at start",
     {"environment.tres", godot_resource},
     "Copy this folder into the project and load environment.tres as the Environment of a WorldEnvironment node."},
    {"hlsl", "HLSL", "shader model 4 and newer, compiled by glslang; not run",
     {{"background.dds", Projection::cube, Depth::half},
      {"specular.dds", Projection::cube, Depth::half, MirroredAxis::none, EngineChain{256, 6, filament_roughness}}}, 0,
     "+X +Y +Z", "no",
     lookups_turns,
     lookups_light,
     {"envmap.hlsl", hlsl_lookups()},
     "Include envmap.hlsl in a shader. Load background.dds and specular.dds as cube textures with trilinear filtering and seamless edges, brdf.exr as a 2D texture with linear filtering and clamped edges, and the 27 numbers of irradiance.txt as an array of 9 float3.\n"
     "With the normal n and v, the unit vector to the eye:\n"
     "float3 light = albedo * envmap_irradiance(irradiance, n) + envmap_specular(specular, specular_sampler, brdf, brdf_sampler, n, v, roughness, f0);\n"
     "envmap.hlsl also finds the texture coordinates of a direction in every projection and cube layout that envmap writes.",
     "brdf.exr", "irradiance.txt"},
    {"pbrt", "pbrt-v4", "commit 015ab47032f3, read; not run",
     {{background_exr, {Projection::equal_area}}}, 0,
     "+X +Y +Z", "no",
     "light.pbrt holds a Rotate. Without it +Y is +Z and -Z is +Y.",
     "pbrt samples the image",
     {"light.pbrt", pbrt_light},
     "Write Include \"FOLDER/light.pbrt\" behind WorldBegin."},
    {"playcanvas", "PlayCanvas", "2.23, run: tests/engines",
     {{"background.hdr", {Projection::latlong, Forward::plus_z}}}, 0,
     "+X +Y +Z", "no",
     "",
     "EnvLighting computes it when the map is set",
     {},
     "Load background.hdr as a texture asset without mipmaps, and say\n"
     "texture.projection = pc.TEXTUREPROJECTION_EQUIRECT;\n"
     "app.scene.skybox = pc.EnvLighting.generateSkyboxCubemap(texture);\n"
     "app.scene.envAtlas = pc.EnvLighting.generateAtlas(pc.EnvLighting.generateLightingSource(texture));\n"
     "app.scene.skyboxMip = 0;"},
    {"three", "three.js", "r187, run: tests/engines",
     {{background_exr, {Projection::latlong, Forward::plus_x}}}, 65504,
     "+X +Y +Z", "no",
     "",
     "PMREMGenerator computes it when the map is set",
     {},
     "import { EXRLoader } from 'three/addons/loaders/EXRLoader.js';\n"
     "const probe = await new EXRLoader().loadAsync('FOLDER/background.exr');\n"
     "probe.mapping = THREE.EquirectangularReflectionMapping;\n"
     "scene.background = scene.environment = probe;"},
    {"unity", "Unity", "2017 to 6, built-in panoramic sky shader, read; not run",
     {{background_exr, {Projection::latlong, Forward::minus_x}, Depth::half}}, 0,
     "-X +Y +Z", "engine",
     "glTFast and UnityGLTF give imported files the same axes.",
     "Unity computes reflections when the sky is baked (Lighting window), or by the importer's Convolution Type",
     {},
     "Copy background.exr into Assets; importer: sRGB off, Max Size at least its width, Texture Shape 2D.\n"
     "Make a material with the shader Skybox/Panoramic (Latitude Longitude Layout) and give it to Lighting > Environment > Skybox Material.\n"
     "Texture Shape Cube, Mapping Latitude-Longitude gives a cubemap for HDRP's HDRI Sky and for reflection probes."},
    {"unreal", "Unreal Engine", "4.27 to 5, texture build as quoted in public forks, read; not run",
     {{"background.hdr", {Projection::latlong, Forward::minus_z}}}, 0,
     "+X +Z +Y", "engine",
     "Z is up. The glTF importer of Unreal gives files the same axes.",
     "Unreal computes it when a Sky Light uses the cubemap",
     {},
     "Import background.hdr: a long-lat .hdr becomes a Texture Cube (an .exr would become a flat texture).\n"
     "Its faces are as high as the image, rounded down to a power of two, and no higher than the asset's Maximum Texture Size (512 by default).\n"
     "Sky Light: Source Type SLS Specified Cubemap, Cubemap the asset, Intensity Scale 1. HDRI Backdrop shows it, too."},
    {"usd", "USD", "openusd.org's user guide of DomeLight, read; not run",
     {{background_exr, {Projection::latlong, Forward::plus_z}}}, 0,
     "+X +Y +Z", "no",
     "Y is up.",
     "the renderer samples the image",
     {"light.usda", usd_layer},
     "Reference or sublayer light.usda into a stage with upAxis Y."},
};

}  // namespace

std::span<const Engine> engines() { return table; }

const Engine& engine_named(std::string_view name) {
  const auto found = std::ranges::find(engines(), name, &Engine::name);
  if (found != engines().end()) return *found;
  std::vector<std::string_view> names;
  for (const Engine& e : engines()) names.push_back(e.name);
  throw UsageError(fmt::format("'{}' is none of the engines {}", name, fmt::join(names, ", ")));
}

const EngineMap& chain_of(const Engine& engine) {
  for (const EngineMap& map : engine.maps)
    if (map.chain) return map;
  throw UsageError(fmt::format("{} takes no levels of rising roughness", engine.title));
}

std::vector<double> level_roughnesses(const EngineMap& map, int size, std::optional<int> levels,
                                      std::string_view size_name) {
  check(limits::size, size);
  if (!map.chain) throw UsageError(fmt::format("{} has no chain", map.file));
  const int possible = std::bit_width(unsigned(size)), fixed = levels.value_or(map.chain->levels);
  const int count = fixed > 0 ? fixed : possible;
  if (count > possible) throw UsageError(fmt::format("{} {}: {} has {} levels", size_name, size, map.file, count));
  std::vector<double> roughnesses;
  for (int k = 0; k < count; ++k) roughnesses.push_back(count > 1 ? map.chain->roughness(k, count, size) : 0);
  return roughnesses;
}

std::string turns_of(const Engine& e) {
  const std::string mirrored = e.mirrored == "no"     ? ""
                               : e.mirrored == "file" ? " The file is mirrored."
                                                      : fmt::format(" {} mirrors the map.", e.title);
  return fmt::format("+X +Y +Z of the probe are {} in {}.{}{}{}", e.axes, e.title, mirrored, e.turns.empty() ? "" : " ",
                     e.turns);
}

std::string frame_words(const Frame& frame) {
  const std::string projection = name(frame.projection);
  return has_forward(frame.projection)
             ? fmt::format("{}, {} at the centre", projection, forward_names[std::size_t(frame.forward)])
             : projection;
}

}  // namespace envmap

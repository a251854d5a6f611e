#include "envmap/engine/engines.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "envmap/base/error.h"
#include "envmap/engine/engine_text.h"
#include "envmap/engine/lookup_shaders.h"
#include "envmap/maths/portable.h"

namespace envmap {
namespace {

// Babylon: lod = 0.8 log2(N alpha) of faces of N texels, alpha = roughness^2.
double babylon_roughness(int k, int /*n*/, int size) {
  return k == 0 ? 0 : std::min(1.0, std::sqrt(portable::exp2(k / 0.8) / size));
}

// Bevy, CesiumJS, glTF-IBL-Sampler: lod / (n - 1) = r.
double even_roughness(int k, int n, int /*size*/) { return double(k) / (n - 1); }

// glTF-IBL-Sampler's Charlie. Its level of roughness 0 is black: the lobe has sunk below the horizon. The roughness of
// the next level stands in for it.
double sheen_roughness(int k, int n, int size) { return even_roughness(std::max(k, 1), n, size); }

// Filament, and shaders/envmap.glsl: lod / (n - 1) = r (2 - r).
double filament_roughness(int k, int n, int /*size*/) { return 1 - std::sqrt(1 - double(k) / (n - 1)); }

// By name. The comments name the source of every fact; what users read is in text/.
const Engine rows[] = {
    // shadersStore pbrIBLFunctions (getLodFromAlphaG) and vReflectionMicrosurfaceInfos; CubeTexture's 0.8 for
    // CreateFromPrefilteredData; the root node of its glTF loader: turned half round Y, Z negated.
    {
        .name = "babylon",
        .title = "Babylon.js",
        .version = "9.34, run: tests/engines",
        .maps = {{.file = "background.dds", .depth = Depth::half, .mirror = MirroredAxis::x},
                 {.file = "environment.dds",
                  .depth = Depth::half,
                  .mirror = MirroredAxis::x,
                  .chain = EngineChain{128, 0, babylon_roughness}}},
        .axes = "-X +Y +Z",
        .mirrored = "file",
    },
    // io/formats/babylon_env.h; irradiance.cpp. babylon_irradiance.cpp: irradianceTexture in
    // packages/dev/core/src/Misc/environmentTextureTools.ts, USEIRRADIANCEMAP and reflectionDominantDirection in
    // Shaders/ShadersInclude/pbrBlockReflection.fx, findDominantDirection in Rendering/iblCdfGenerator.ts.
    {
        .name = "babylon-env",
        .title = "Babylon.js (.env)",
        .version = "9.34, run: tests/engines",
        .maps = {{.file = "environment.env",
                  .depth = Depth::rgbd,
                  .chain = EngineChain{256, 0, babylon_roughness, IrradianceForm::babylon}}},
        .axes = "-X +Y +Z",
        .mirrored = "file",
    },
    // compute_cubemap_sample_dir and radiance_level in crates/bevy_pbr/src/light_probe/environment_map.wgsl (z
    // negated; roughness x the last level; the diffuse map times the colour, without pi);
    // crates/bevy_core_pipeline/src/skybox/skybox.wgsl (z negated); crates/bevy_image/src/ktx2.rs: E5B9G9R9 is
    // Rgb9e5Ufloat.
    {
        .name = "bevy",
        .title = "Bevy",
        .version = "0.19, shaders of commit 00ab817cdfa1, read; not run",
        .maps = {{.file = "skybox.ktx2", .depth = Depth::rgb9e5, .mirror = MirroredAxis::z},
                 {.file = "specular.ktx2",
                  .depth = Depth::rgb9e5,
                  .mirror = MirroredAxis::z,
                  .chain = EngineChain{256, 5, even_roughness}},
                 {.file = "diffuse.ktx2", .depth = Depth::rgb9e5, .mirror = MirroredAxis::z, .diffuse = 64}},
        .mirrored = "file",
    },
    // node_tex_environment_equirectangular in
    // source/blender/gpu/shaders/material/gpu_shader_material_tex_environment.glsl, u = 0.5 - atan2(y, x) / 2 pi, v up
    // = 0.5 + atan2(z, hypot(x, y)) / pi; intern/cycles/kernel/camera/projection.h. EXR files count as linear floats.
    // In the text editor __file__ is FILE.blend/NAME OF THE TEXT, which is no path.
    {
        .name = "blender",
        .title = "Blender",
        .version = "3.4.1, run: tests/blender.py",
        .maps = {{.file = "background.exr", .frame = {Projection::latlong, Forward::plus_x}}},
        .axes = "+X +Z -Y",
        .text = {.name = "world.py"},
    },
    // packages/engine/Source: yUpToZUp in Scene/Model/Model.js, lookups in Shaders/Model/ImageBasedLightingStageFS.glsl
    // (roughness x the last level), Workers/transcodeKTX2.js (half and float in four channels, no supercompression),
    // Scene/SpecularEnvironmentCubeMap.js (the last level of the file is roughness 1),
    // Shaders/Builtin/Functions/sphericalHarmonics.glsl: the basis and the scale of Filament's harmonics, times the
    // colour of the surface. getAxisCorrectionMatrix in Scene/Model/ModelUtility.js: +Z of glTF files is +X.
    {
        .name = "cesium",
        .title = "CesiumJS",
        .version = "1.145, run: tests/engines",
        .maps = {{.file = "specular.ktx2", .depth = Depth::half, .chain = EngineChain{256, 5, even_roughness}}},
        .axes = "+X +Z -Y",
        .irradiance = "irradiance.txt",
    },
    // perceptualRoughnessToLod in shaders/src/light_indirect.fs; computeIrradianceSH3Bands in
    // libs/ibl/src/CubemapSH.cpp; libs/ktxreader/src/Ktx1Reader.cpp; getSphericalHarmonics in
    // libs/image/src/Ktx1Bundle.cpp. 256 and 5 levels: the comment of the shader.
    {
        .name = "filament",
        .title = "Filament",
        .version = "1.53.4 (npm), run: tests/engines",
        .maps = {{.file = "sky.ktx", .depth = Depth::half},
                 {.file = "ibl.ktx",
                  .depth = Depth::half,
                  .chain = EngineChain{256, 5, filament_roughness, IrradianceForm::filament}}},
    },
    {
        .name = "glsl",
        .title = "GLSL",
        .version = "3.30 and ES 3.00, run in Mesa: tests/render",
        .maps = {{.file = "background.ktx2", .depth = Depth::half},
                 {.file = "specular.ktx2", .depth = Depth::half, .chain = EngineChain{256, 6, filament_roughness}}},
        .text = {.name = "envmap.glsl", .text = glsl_lookups()},
        .table = "brdf.exr",
        .irradiance = "irradiance.txt",
    },
    // io/formats/babylon_env.h; irradiance.cpp.
    {
        .name = "gltf",
        .title = "glTF EXT_lights_image_based",
        .version = "its README of commit 01b16a09b944; run in Babylon.js 9.28: tests/engines",
        .maps = {{.file = "light.glb",
                  .depth = Depth::rgbd,
                  .chain = EngineChain{256, 5, even_roughness, IrradianceForm::gltf}}},
    },
    // KhronosGroup/glTF-IBL-Sampler, commit 08fa12250f6f: sample() in lib/source/lib.cpp (roughness k / (n - 1) in
    // level k of n; lambertian in one level), filterColor() and LUT() in lib/source/shaders/filter.frag (a cosine over
    // pi, GGX and Charlie seen head-on; columns of the tables cosine, rows roughness).
    // KhronosGroup/glTF-Sample-Renderer: source/ibl_sampler.js (256 texels, 5 levels), source/Renderer/shaders/ibl.glsl
    // (lods, u_EnvRotation, channels of the tables), source/GltfState/gltf_state.js (environmentRotation). Its table of
    // Charlie is drawn by Charlie's own samples and weighted as if these were even; the table here is the integral that
    // both its tables stand for.
    {
        .name = "gltf-viewer",
        .title = "glTF Sample Viewer",
        .version = "files of glTF-IBL-Sampler, sources read; not run",
        .maps = {{.file = "ggx.ktx2", .depth = Depth::half, .chain = EngineChain{256, 5, even_roughness}},
                 {.file = "lambertian.ktx2", .depth = Depth::half, .diffuse = 64},
                 {.file = "charlie.ktx2",
                  .depth = Depth::half,
                  .chain = EngineChain{64, 5, sheen_roughness, IrradianceForm::none, 1, LobeShape::charlie}}},
        .table = "lut_ggx.exr",
        .sheen = "lut_sheen.exr",
    },
    // servers/rendering/renderer_rd/shaders/environment/sky.glsl, panorama_coords = (atan(x, -z) / 2 pi, acos(y) /
    // pi); paths relative to a resource: scene/resources/resource_format_text.cpp; the enumerators:
    // scene/resources/environment.h.
    {
        .name = "godot",
        .title = "Godot",
        .version = "4, commit 0095d7d0c0c9, read; not run",
        .maps = {{.file = "background.exr", .frame = {Projection::latlong, Forward::plus_z}}},
        .text = {.name = "environment.tres"},
    },
    {
        .name = "hlsl",
        .title = "HLSL",
        .version = "shader model 4 and newer, compiled by glslang; not run",
        .maps = {{.file = "background.dds", .depth = Depth::half},
                 {.file = "specular.dds", .depth = Depth::half, .chain = EngineChain{256, 6, filament_roughness}}},
        .text = {.name = "envmap.hlsl", .text = hlsl_lookups()},
        .table = "brdf.exr",
        .irradiance = "irradiance.txt",
    },
    // EqualAreaSphereToSquare in src/pbrt/util/math.cpp; ImageInfiniteLight::Le in src/pbrt/lights.h.
    {
        .name = "pbrt",
        .title = "pbrt-v4",
        .version = "commit 015ab47032f3, read; not run",
        .maps = {{.file = "background.exr", .frame = {Projection::equal_area}}},
        .text = {.name = "light.pbrt"},
    },
    // shader chunk sphericalPS, and the skybox's, which negates x.
    {
        .name = "playcanvas",
        .title = "PlayCanvas",
        .version = "2.23, run: tests/engines",
        .maps = {{.file = "background.hdr", .frame = {Projection::latlong, Forward::plus_z}}},
    },
    // Levels as PMREMGenerator.lodToRoughness in src/extras/PMREMGenerator.js, faces of 256 to 8 texels, of which the
    // last is diffuse light, too: getIBLIrradiance in src/renderers/shaders/ShaderChunk/envmap_physical_pars_fragment.
    // Cubes of files are looked up with x negated: WebGLMaterials.js and WebGLBackground.js, isRenderTargetTexture.
    // examples/jsm/loaders/KTX2Loader.js makes cubes of compressed texels alone, and among those of floats only of
    // UASTC HDR on every card.
    {
        .name = "three",
        .title = "three.js",
        .version = "r187, run: tests/engines",
        .maps = {{.file = "background.ktx2",
                  .depth = Depth::uastc_hdr,
                  .mirror = MirroredAxis::x,
                  .only_depth = true,
                  .zstd = true},
                 {.file = "environment.ktx2",
                  .depth = Depth::uastc_hdr,
                  .mirror = MirroredAxis::x,
                  .chain = EngineChain{256, 0, filament_roughness, IrradianceForm::none, 8},
                  .only_depth = true,
                  .zstd = true}},
        .mirrored = "file",
    },
    // equirectUv in src/renderers/shaders/ShaderChunk/common.glsl.js, u = 0.5 + atan(z, x) / 2 pi, v up = 0.5 +
    // asin(y) / pi; examples/jsm/loaders/EXRLoader.js: HalfFloatType unless told otherwise. (HDRLoader divides by 255,
    // not by 256: white is 1.004.)
    {
        .name = "three-latlong",
        .title = "three.js (panorama)",
        .version = "r187, run: tests/engines",
        .maps = {{.file = "background.exr", .frame = {Projection::latlong, Forward::plus_x}}},
        .largest = 65504,
    },
    // ToRadialCoords in the built-in shader Skybox-Panoramic.shader, u = 0.5 - atan2(z, x) / 2 pi, v down = acos(y) /
    // pi; glTFast and UnityGLTF negate X.
    {
        .name = "unity",
        .title = "Unity",
        .version = "2017 to 6, built-in panoramic sky shader, read; not run",
        .maps = {{.file = "background.exr", .frame = {Projection::latlong, Forward::minus_x}, .depth = Depth::half}},
        .axes = "-X +Y +Z",
        .mirrored = "engine",
    },
    // LookupLongLat, TransformSideToWorldSpace and GenerateBaseCubeMipFromLongitudeLatitude2D in
    // TextureCompressorModule.cpp: of the cube's own direction u = 0.5 + atan2(x, -y) / 2 pi, v down = acos(z) / pi.
    // Its glTF importer takes (x, z, y) for (x, y, z).
    {
        .name = "unreal",
        .title = "Unreal Engine",
        .version = "4.27 to 5, texture build as quoted in public forks, read; not run",
        .maps = {{.file = "background.hdr", .frame = {Projection::latlong, Forward::minus_z}}},
        .axes = "+X +Z +Y",
        .mirrored = "engine",
    },
    // openusd.org, user guide of DomeLight: "adheres to the OpenEXR specification for latitude-longitude maps".
    {
        .name = "usd",
        .title = "USD",
        .version = "openusd.org's user guide of DomeLight, read; not run",
        .maps = {{.file = "background.exr", .frame = {Projection::latlong, Forward::plus_z}}},
        .text = {.name = "light.usda"},
    },
};

// Takes a first line "key: words" off a text, if there is one.
std::string_view take(std::string_view key, std::string_view& text) {
  if (!text.starts_with(key)) return {};
  const std::size_t end = text.find('\n');
  const std::string_view words = text.substr(key.size(), end - key.size());
  text.remove_prefix(end + 1);
  return words;
}

// A row with what text/ and files/ say.
Engine with_text(Engine e) {
  std::string_view text = engine_text(fmt::format("{}.txt", e.name));
  e.turns = take("orientation: ", text);
  e.light = take("light: ", text);
  e.steps = text.substr(0, text.size() - 1);
  if (e.text.text.empty()) e.text.text = engine_text(e.text.name);
  return e;
}

}  // namespace

std::span<const Engine> engines() {
  static const std::vector<Engine> all = [] {
    std::vector<Engine> made;
    std::ranges::transform(rows, std::back_inserter(made), with_text);
    return made;
  }();
  return all;
}

const Engine* find_engine(std::string_view name) {
  const auto found = std::ranges::find(engines(), name, &Engine::name);
  return found == engines().end() ? nullptr : &*found;
}

const Engine* find_latlong(const Engine& engine) { return find_engine(std::string(engine.name) + "-latlong"); }

std::string_view family_of(const Engine& engine) { return engine.name.substr(0, engine.name.find('-')); }

const Engine& engine_named(std::string_view name) {
  if (const Engine* const found = find_engine(name)) return *found;
  std::vector<std::string_view> names;
  for (const Engine& e : engines()) names.push_back(e.name);
  throw UsageError(fmt::format("'{}' is none of the engines {}", name, fmt::join(names, ", ")));
}

const EngineMap& chain_of(const Engine& engine) {
  for (const EngineMap& map : engine.maps)
    if (map.chain) return map;
  throw UsageError(fmt::format("{} takes no levels of rising roughness", engine.title));
}

std::string turns_of(const Engine& e) {
  const std::string mirrored = e.mirrored == "no" ? ""
                               : e.mirrored == "file"
                                   ? " The file is mirrored for its loader: other viewers show it backwards."
                                   : fmt::format(" {} mirrors the map.", e.title);
  return fmt::format("+X +Y +Z of the probe are {} in {}.{}{}{}", e.axes, e.title, mirrored, e.turns.empty() ? "" : " ",
                     e.turns);
}

std::string frame_words(const Frame& frame) {
  const std::string projection = name(frame.projection);
  return has_forward(frame.projection)
             ? fmt::format("{}, {} at the centre", projection, forward_names[number_of("forward", frame.forward)])
             : projection;
}

}  // namespace envmap

#include "engines.h"

namespace tools {
namespace {

using namespace envmap;

constexpr std::string_view background_exr = "background.exr";

// Blender's EXR files are linear floats by themselves. `//` would be relative to the .blend file, so the script says where it
// lies itself.
constexpr std::string_view blender_script = R"(# A world lit by background.exr beside this script: blender SCENE.blend --python world.py
import os
import bpy

world = bpy.data.worlds.new("Probe")
world.use_nodes = True
nodes, links = world.node_tree.nodes, world.node_tree.links
nodes.clear()
image = nodes.new("ShaderNodeTexEnvironment")
image.image = bpy.data.images.load(os.path.join(os.path.dirname(os.path.abspath(__file__)), "background.exr"))
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

// Sources, by row:
// blender: node_tex_environment_equirectangular in source/blender/gpu/shaders/material/gpu_shader_material_tex_environment.glsl,
//   u = 0.5 - atan2(y, x) / 2 pi, v up = 0.5 + atan2(z, hypot(x, y)) / pi, and Cycles' intern/cycles/kernel/camera/projection.h.
// godot: servers/rendering/renderer_rd/shaders/environment/sky.glsl, panorama_coords = (atan(x, -z) / 2 pi, acos(y) / pi);
//   paths relative to a resource: scene/resources/resource_format_text.cpp; the enumerators: scene/resources/environment.h.
// pbrt: EqualAreaSphereToSquare in src/pbrt/util/math.cpp, ImageInfiniteLight::Le in src/pbrt/lights.h.
// three: equirectUv in src/renderers/shaders/ShaderChunk/common.glsl.js, u = 0.5 + atan(z, x) / 2 pi, v up = 0.5 + asin(y) / pi;
//   examples/jsm/loaders/EXRLoader.js: HalfFloatType unless told otherwise. (HDRLoader divides by 255, not by 256: white is 1.004.)
// usd: openusd.org, user guide of DomeLight: "adheres to the OpenEXR specification for latitude-longitude maps".

const Engine table[] = {
    {"blender", "Blender", "Cycles of commit 24e016546302, read; not run",
     {Projection::latlong, Forward::plus_x}, background_exr, 0,
     "Z up: +X, +Y and +Z of the probe are +X, +Z and -Y, as of imported glTF files; +X lies at the centre of the image",
     "Cycles and EEVEE sample the image itself",
     {"world.py", blender_script},
     "Run world.py in the text editor of Blender, or: blender SCENE.blend --python world.py"},
    {"godot", "Godot", "4, commit 0095d7d0c0c9, read; not run",
     {Projection::latlong, Forward::plus_z}, background_exr, 0,
     "+X, +Y and +Z of the probe are +X, +Y and +Z; +Z lies at the centre of the image",
     "Godot makes them when it starts",
     {"environment.tres", godot_resource},
     "Copy this folder into the project and load environment.tres as the Environment of a WorldEnvironment node."},
    {"pbrt", "pbrt-v4", "commit 015ab47032f3, read; not run",
     {Projection::equal_area}, background_exr, 0,
     "with the Rotate of light.pbrt +X, +Y and +Z of the probe are +X, +Y and +Z; without it +Y is +Z and -Z is +Y",
     "pbrt samples the image itself",
     {"light.pbrt", pbrt_light},
     "Write Include \"FOLDER/light.pbrt\" behind WorldBegin."},
    {"three", "three.js", "r187, run: tests/engines",
     {Projection::latlong, Forward::plus_x}, background_exr, 65504,
     "+X, +Y and +Z of the probe are +X, +Y and +Z; +X lies at the centre of the image",
     "PMREMGenerator makes them when the map is set",
     {},
     "import { EXRLoader } from 'three/addons/loaders/EXRLoader.js';\n"
     "const probe = await new EXRLoader().loadAsync('FOLDER/background.exr');\n"
     "probe.mapping = THREE.EquirectangularReflectionMapping;\n"
     "scene.background = scene.environment = probe;"},
    {"usd", "USD", "openusd.org's user guide of DomeLight, read; not run",
     {Projection::latlong, Forward::plus_z}, background_exr, 0,
     "Y up: +X, +Y and +Z of the probe are +X, +Y and +Z; +Z lies at the centre of the image",
     "the renderer samples the image itself",
     {"light.usda", usd_layer},
     "Reference or sublayer light.usda into a stage with upAxis Y."},
};

}  // namespace

std::span<const Engine> engines() { return table; }

}  // namespace tools

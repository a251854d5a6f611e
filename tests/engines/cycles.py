# Cycles draws the balls of pictures.mjs under the world that `envmap bake --for blender` wrote: blender -b --factory-startup -P cycles.py
import json
import os

import bpy
from mathutils import Vector

here = os.getcwd()
wanted = json.load(open(os.path.join(here, 'balls', 'wanted.json')))
scene = bpy.context.scene
for thing in list(bpy.data.objects):
    bpy.data.objects.remove(thing)
script = os.path.join(here, 'probes', 'blender-real', 'world.py')
exec(compile(open(script).read(), script, 'exec'), {'__file__': script})

scene.render.engine = 'CYCLES'
scene.cycles.samples = 512
scene.cycles.use_denoising = False
scene.cycles.use_adaptive_sampling = False
scene.cycles.filter_width = 1.0  # Of the Blackman-Harris filter, in pixels.
scene.view_settings.view_transform = 'Raw'
scene.render.resolution_x = scene.render.resolution_y = wanted['size']
scene.render.resolution_percentage = 100
scene.render.image_settings.file_format = 'OPEN_EXR'
scene.render.image_settings.color_depth = '32'

bpy.ops.mesh.primitive_uv_sphere_add(segments=256, ring_count=128, radius=1)
ball = bpy.context.object
bpy.ops.object.shade_smooth()
material = bpy.data.materials.new('ball')
material.use_nodes = True
shader = material.node_tree.nodes['Principled BSDF']
shader.inputs['Base Color'].default_value = (1, 1, 1, 1)
ball.data.materials.append(material)

x, y, z = wanted['eye']
camera = bpy.data.objects.new('camera', bpy.data.cameras.new('camera'))
camera.location = (x, -z, y)
camera.rotation_euler = (-Vector((x, -z, y))).to_track_quat('-Z', 'Y').to_euler()
camera.data.sensor_fit = 'VERTICAL'
camera.data.angle = wanted['fov'] * 3.141592653589793 / 180
scene.collection.objects.link(camera)
scene.camera = camera

for name, look in wanted['balls'].items():
    shader.inputs['Metallic'].default_value = look['metallic']
    shader.inputs['Roughness'].default_value = look['roughness']
    scene.render.filepath = os.path.join(here, 'balls', name + ' cycles.exr')
    bpy.ops.render.render(write_still=True)

"""A map of a room, by `envmap render` beside Cycles. Surfaces shine with their own colour, so only what is seen where counts.

  blender -b --factory-startup -P room.py -- ROOM.glb [FOLDER [ENVMAP]]

ROOM.glb is room-21.glb of ../scenes/make.py. Prints the rms of the difference over the mean of Cycles' map, for 1 to 256 rays a texel.
"""
import json
import os
import struct
import subprocess
import sys
from math import pi

import bpy
import numpy as np

np.bool = bool  # Debian 12's importer of glTF files wants what its NumPy no longer has.
HEIGHT, SAMPLES = 128, 4096
GIVEN = sys.argv[sys.argv.index('--') + 1:]
ROOM, FOLDER, ENVMAP = GIVEN + ['cycles', 'envmap'][len(GIVEN) - 1:]


def unlit(path):
    """The scene with the unlit extension in each material."""
    with open(ROOM, 'rb') as file:
        data = file.read()
    end = 20 + struct.unpack_from('<I', data, 12)[0]
    scene = json.loads(data[20:end])
    scene.setdefault('extensionsUsed', []).append('KHR_materials_unlit')
    for material in scene['materials']:
        material.setdefault('extensions', {})['KHR_materials_unlit'] = {}
    text = json.dumps(scene).encode()
    text += b' ' * (-len(text) % 4)
    chunks = struct.pack('<I4s', len(text), b'JSON') + text + data[end:]
    with open(path, 'wb') as file:
        file.write(data[:8] + struct.pack('<I', 12 + len(chunks)) + chunks)


def pixels(path):
    image = bpy.data.images.load(os.path.abspath(path))
    image.colorspace_settings.name = 'Linear'
    return np.array(image.pixels[:]).reshape(HEIGHT, 2 * HEIGHT, 4)[:, :, :3]


def by_cycles(path):
    """A latlong map with +Z of glTF, which is -Y of Blender, at its centre."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=path)
    scene = bpy.context.scene
    camera = bpy.data.cameras.new('eye')
    camera.type, camera.clip_start = 'PANO', 0.001
    camera.cycles.panorama_type = 'EQUIRECTANGULAR'
    scene.camera = bpy.data.objects.new('eye', camera)
    scene.camera.rotation_euler = (pi / 2, 0, pi)
    scene.collection.objects.link(scene.camera)
    scene.render.engine = 'CYCLES'
    for name, value in {'samples': SAMPLES, 'max_bounces': 0, 'use_denoising': False, 'use_adaptive_sampling': False,
                        'pixel_filter_type': 'BOX'}.items():
        setattr(scene.cycles, name, value)
    scene.render.resolution_x, scene.render.resolution_y = 2 * HEIGHT, HEIGHT
    scene.render.image_settings.file_format = 'OPEN_EXR'
    scene.render.image_settings.color_depth = '32'
    scene.render.filepath = path.replace('.glb', ' by cycles.exr')
    bpy.ops.render.render(write_still=True)
    return pixels(scene.render.filepath)


def main():
    os.makedirs(FOLDER, exist_ok=True)
    path = os.path.join(os.path.abspath(FOLDER), 'room.glb')
    unlit(path)
    truth = by_cycles(path)
    for samples in (1, 4, 16, 64, 256):
        drawn = path.replace('.glb', f' {samples}.exr')
        subprocess.run([ENVMAP, 'render', path, drawn, '--to', 'latlong', '--size', str(HEIGHT), '--samples', str(samples), '-q'],
                       check=True)
        off = pixels(drawn) - truth
        print(f'{samples} rays a texel: rms {np.sqrt(np.mean(off ** 2)) / truth.mean():.4f}, '
              f'mean {off.mean() / truth.mean():+.5f}')


main()

"""Metal balls in the light of a probe, by `envmap view` beside Cycles.

  blender -b --factory-startup -P compare.py -- PROBE [FOLDER [ENVMAP]]

Prints, for each roughness and each way of drawing, the rms of the difference over the mean of Cycles' picture, and the median of
the difference over the same mean, in pixels inside the ball. Pictures stay in FOLDER.
"""
import base64
import json
import os
import struct
import subprocess
import sys
from math import cos, pi, sin, tan

import bpy
import numpy as np

np.bool = bool  # Debian 12's importer of glTF files wants what its NumPy no longer has.
SIZE, SAMPLES, DISTANCE, FIELD = 128, 1024, 10, 0.22
GIVEN = sys.argv[sys.argv.index('--') + 1:]
PROBE, FOLDER, ENVMAP = GIVEN + ['cycles', 'envmap'][len(GIVEN) - 1:]
ROUGHNESSES = (0, 0.3, 0.5, 1)
WAYS = {'maps, split-sum': [], 'maps, sampled': ['--reflection', 'sampled'],
        'rays, sampled': ['--method', 'raycast', '--reflection', 'sampled'],
        'rays, integral': ['--method', 'raycast', '--lobe-samples', '256']}


def ball(roughness, columns=256, rows=128):
    """A glTF file: a white metal of radius 1, and a camera before it."""
    places, triangles = b'', b''
    for j in range(rows + 1):
        for i in range(columns + 1):
            a, b = 2 * pi * i / columns, pi * j / rows
            places += struct.pack('<3f', sin(b) * cos(a), cos(b), sin(b) * sin(a))
            at, below = j * (columns + 1) + i, (j + 1) * (columns + 1) + i
            if i < columns and j < rows:
                triangles += struct.pack('<6I', at, at + 1, below, below, at + 1, below + 1)
    scene = {
        'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': [0, 1]}],
        'nodes': [{'name': 'ball', 'mesh': 0}, {'name': 'eye', 'camera': 0, 'translation': [0, 0, DISTANCE]}],
        'cameras': [{'type': 'perspective', 'perspective': {'yfov': FIELD, 'aspectRatio': 1, 'znear': 0.1}}],
        'meshes': [{'primitives': [{'attributes': {'POSITION': 0, 'NORMAL': 0}, 'indices': 1, 'material': 0}]}],
        'materials': [{'name': 'metal', 'pbrMetallicRoughness': {'metallicFactor': 1, 'roughnessFactor': roughness}}],
        'accessors': [{'bufferView': 0, 'componentType': 5126, 'count': len(places) // 12, 'type': 'VEC3',
                       'min': [-1, -1, -1], 'max': [1, 1, 1]},
                      {'bufferView': 1, 'componentType': 5125, 'count': len(triangles) // 4, 'type': 'SCALAR'}],
        'bufferViews': [{'buffer': 0, 'byteLength': len(places)},
                        {'buffer': 0, 'byteOffset': len(places), 'byteLength': len(triangles)}],
        'buffers': [{'byteLength': len(places) + len(triangles),
                     'uri': 'data:application/octet-stream;base64,' + base64.b64encode(places + triangles).decode()}]}
    path = os.path.join(FOLDER, f'ball {roughness}.gltf')
    with open(path, 'w') as file:
        json.dump(scene, file)
    return path


def envmap(*words):
    subprocess.run([ENVMAP, *words, '-q'], check=True)


def pixels(path):
    image = bpy.data.images.load(os.path.abspath(path))
    image.colorspace_settings.name = 'Linear'
    return np.array(image.pixels[:]).reshape(SIZE, SIZE, 4)[:, :, :3]


def by_cycles(path, scattering):
    """Cycles with a box of a pixel, and nothing clamped. `scattering`: GGX, or MULTI_GGX with light that bounces on."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=path)
    world = os.path.join(os.path.abspath(FOLDER), 'world', 'world.py')
    with open(world) as script:
        exec(compile(script.read(), world, 'exec'), {'__file__': world})
    for material in bpy.data.materials:
        for node in material.node_tree.nodes:
            if node.type == 'BSDF_PRINCIPLED':
                node.distribution = scattering
    scene = bpy.context.scene
    scene.camera = next(thing for thing in bpy.data.objects if thing.type == 'CAMERA')
    scene.render.engine = 'CYCLES'
    for name, value in {'samples': SAMPLES, 'use_denoising': False, 'use_adaptive_sampling': False, 'pixel_filter_type': 'BOX',
                        'blur_glossy': 0, 'sample_clamp_direct': 0, 'sample_clamp_indirect': 0}.items():
        setattr(scene.cycles, name, value)
    scene.view_settings.view_transform = 'Raw'
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.image_settings.file_format = 'OPEN_EXR'
    scene.render.image_settings.color_depth = '32'
    scene.render.filepath = path.replace('.gltf', f' {scattering}.exr')
    bpy.ops.render.render(write_still=True)
    return pixels(scene.render.filepath)


def main():
    os.makedirs(FOLDER, exist_ok=True)
    envmap('bake', PROBE, os.path.join(FOLDER, 'world'), '--for', 'blender', '--force')
    side = np.arange(SIZE) + 0.5 - SIZE / 2
    inside = np.hypot(*np.meshgrid(side, side)) < 0.98 * SIZE / 2 * tan(np.arcsin(1 / DISTANCE)) / tan(FIELD / 2)
    for roughness in ROUGHNESSES:
        path = ball(roughness)
        truth = by_cycles(path, 'MULTI_GGX')[inside]
        drawn = {'Cycles, one bounce': by_cycles(path, 'GGX')} if roughness > 0 else {}
        for way, words in WAYS.items():
            picture = path.replace('.gltf', f' {way}.exr')
            envmap('view', path, picture, '--environment', PROBE, '--width', str(SIZE), '--height', str(SIZE), '--samples', '16',
                   '--occlusion', '0', *words)
            drawn[way] = pixels(picture)
        for way, picture in drawn.items():
            off = picture[inside] - truth
            print(f'roughness {roughness}, {way}: rms {np.sqrt(np.mean(off ** 2)) / truth.mean():.3f}, '
                  f'median {np.median(np.abs(off)) / truth.mean():.4f}, mean {off.mean() / truth.mean():+.4f}')


main()

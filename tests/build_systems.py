#!/usr/bin/env python3
"""Maps built by real Make, Ninja and CMake: touching any file that a map was made from makes it again, touching none makes
nothing, whatever the names. Installs the program first.

  build_systems.py SOURCE BUILD WORK
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import time

source, build, work = (pathlib.Path(p).resolve() for p in sys.argv[1:4])
tree = work / 'tree'
envmap = tree / 'bin/envmap'
ODD = 'größe 1$2#3'
MAPS = ('.dds', '.env', '.exr', '.glb', '.ktx', '.ktx2', '.txt')


def run(*command, **more):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, **more)
    if done.returncode != 0:
        sys.exit(f'build_systems: {" ".join(map(str, command))}: {done.returncode}\n{done.stdout}{done.stderr}')
    return done.stdout


def times(folder):
    """Of all maps there: what was made again has another."""
    maps = [p for p in folder.rglob('*') if p.suffix in MAPS or p.name == 'background.hdr']
    return {p: p.stat().st_mtime_ns for p in maps if 'CMakeFiles' not in str(p)}


def touch(path):
    later = time.time_ns() + 10**9
    time.sleep(1.1)  # Not in the future when the build looks: ninja and make would build for ever.
    os.utime(path, ns=(later, later))


def check(what, make, maps, made_of):
    """@param make builds. @param maps the folder of what is made. @param made_of file -> names of the maps made of it."""
    make()
    first = times(maps)
    for names in made_of.values():
        for name in names:
            if not any(p.match(name) for p in first):
                sys.exit(f'build_systems: {what}: {name} was not made, only {sorted(map(str, first))}')
    make()
    if times(maps) != first:
        sys.exit(f'build_systems: {what}: nothing was touched, and something made')
    for file, names in made_of.items():
        before = times(maps)
        touch(file)
        make()
        after = times(maps)
        made = {p for p in after if after[p] != before.get(p)}
        wanted = {p for p in after if any(p.match(name) for name in names)}
        if made != wanted:
            sys.exit(f'build_systems: {what}: {file} was touched: made {sorted(map(str, made))}, not {sorted(map(str, wanted))}')
        make()
        if times(maps) != after:
            sys.exit(f'build_systems: {what}: {file} was touched once, and maps made twice')


def probes(folder, *names):
    folder.mkdir(parents=True)
    for name in names:
        run(envmap, 'generate', 'sky', name, '--size', '8', cwd=folder)


def check_make():
    folder = work / 'make'
    probes(folder, 'a.hdr', 'b.hdr', 'größe 1 c.hdr')
    check('Make', lambda: run('make', '-s', '-f', source / 'samples/build/Makefile', f'ENVMAP={envmap}', cwd=folder), folder,
          {folder / 'a.hdr': ['a.ktx2', 'a.diffuse.exr'], folder / 'b.hdr': ['b.ktx2', 'b.diffuse.exr'],
           folder / 'größe 1 c.hdr': ['größe 1 c.ktx2', 'größe 1 c.diffuse.exr']})
    run('make', '-s', '-f', source / 'samples/build/Makefile', 'clean', cwd=folder)
    if sorted(p.name for p in folder.iterdir()) != ['a.hdr', 'b.hdr', 'größe 1 c.hdr']:
        sys.exit(f'build_systems: Make: clean left {sorted(folder.iterdir())}')


def check_ninja():
    folder = work / 'ninja'
    probes(folder, 'probe.hdr')
    text = (source / 'samples/build/build.ninja').read_text()
    # --if-changed would leave what came out the same: here the maps shall tell that they were made.
    (folder / 'build.ninja').write_text(text.replace('envmap = envmap', f'envmap = {envmap}').replace(' --if-changed', ''))
    check('Ninja', lambda: run('ninja', cwd=folder), folder, {folder / 'probe.hdr': ['probe.ktx2', 'probe.diffuse.exr']})
    # With it nothing that is made of the same bytes is made again.
    (folder / 'build.ninja').write_text(text.replace('envmap = envmap', f'envmap = {envmap}'))
    run('ninja', cwd=folder)
    before = times(folder)
    touch(folder / 'probe.hdr')
    run('ninja', cwd=folder)
    if times(folder) != before:
        sys.exit('build_systems: Ninja: --if-changed wrote the same bytes anew')


# A texture that only the depfile knows of, a config of colours, and a probe with an odd name.
PROJECT = '''cmake_minimum_required(VERSION 3.25)
project(maps LANGUAGES NONE)
find_package(envmap 1 CONFIG REQUIRED)
envmap_add_map(maps SOURCE scene.obj OUTPUT room.exr COMMAND render
  OPTIONS --size 4 --method raycast --environment ${CMAKE_CURRENT_SOURCE_DIR}/sky.exr --quiet)
envmap_add_map(maps SOURCE sky.exr OUTPUT film.exr OPTIONS --input-space film --ocio ${CMAKE_CURRENT_SOURCE_DIR}/studio.ocio)
envmap_add_map(maps SOURCE sky.exr OUTPUT faces/{face}.exr OPTIONS --to cube --size 4)
envmap_add_map(maps SOURCE sky.exr OUTPUT halves/{half}.exr OPTIONS --to paraboloid --size 4)
envmap_add_map(maps SOURCE sky.exr OUTPUT levels/{level}.exr COMMAND mipmap)
envmap_add_maps(maps SOURCES [==[NAME.exr]==] FOR ENGINES OPTIONS --quiet --size 4 --chain-size 32)
'''
SCENE = 'mtllib some.mtl\nv 0 0 -1\nv 1 0 -1\nv 0 1 -1\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n'
CONFIG = '''ocio_profile_version: 2
search_path: .
roles: {default: lin_rec709}
displays:
  sRGB:
    - !<View> {name: Raw, colorspace: lin_rec709}
colorspaces:
  - !<ColorSpace> {name: lin_rec709}
  - !<ColorSpace>
    name: film
    to_scene_reference: !<FileTransform> {src: film.spi1d}
'''


def check_cmake(generator):
    folder = work / f'CMake {generator}' / 'größe 1'  # OpenColorIO takes a $ in a path for a variable.
    probes(folder, 'sky.exr', 'texture.exr', ODD + '.exr')
    engines = [e['name'] for e in json.loads(run(envmap, 'bake', '--list', '--json'))['engines']]
    if generator != 'Ninja':  # The rules of all engines are the same there.
        engines = engines[:3]
    (folder / 'CMakeLists.txt').write_text(PROJECT.replace('NAME', ODD).replace('ENGINES', ' '.join(engines)))
    (folder / 'scene.obj').write_text(SCENE)
    (folder / 'some.mtl').write_text('newmtl m\nmap_Kd texture.exr\n')
    (folder / 'studio.ocio').write_text(CONFIG)
    (folder / 'film.spi1d').write_text('Version 1\nFrom 0.0 1.0\nLength 2\nComponents 1\n{\n0.0\n2.0\n}\n')
    out = folder.parent / 'out'
    run('cmake', '-S', folder, '-B', out, '-G', generator, f'-DCMAKE_PREFIX_PATH={tree}')
    room, film, many, baked = 'room.exr', 'film.exr', ['faces/*', 'halves/*', 'levels/*'], 'maps/*/*/*'
    check(f'CMake with {generator}', lambda: run('cmake', '--build', out), out,
          {folder / 'scene.obj': [room], folder / 'some.mtl': [room], folder / 'texture.exr': [room],
           folder / 'sky.exr': [room, film, *many], folder / 'studio.ocio': [film], folder / 'film.spi1d': [film],
           folder / (ODD + '.exr'): [baked]})


shutil.rmtree(work, ignore_errors=True)
run('cmake', '--install', build, '--prefix', tree)
check_make()
check_ninja()
for generator in ('Ninja', 'Unix Makefiles'):
    check_cmake(generator)
print('Make, Ninja and CMake make what changed, and nothing else')

#!/usr/bin/env python3
"""Blender shows a baked probe: world.py runs from the command line and in the text editor, and Cycles sees every direction
where the README says. Skipped where Blender is not installed.

  blender.py PROGRAM
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

program = pathlib.Path(sys.argv[1]).resolve()
SKIPPED = 77

# Runs inside of Blender: prepares the way of argv[-2], runs the script of the folder argv[-1], looks along six axes.
INSIDE = '''
import bpy, mathutils, os, sys, tempfile
way, folder = sys.argv[-2:]
script = os.path.join(folder, "world.py")

def run_in_editor(text):
    window = bpy.context.window_manager.windows[0]
    area = window.screen.areas[0]
    area.type = "TEXT_EDITOR"
    area.spaces.active.text = text
    region = next(r for r in area.regions if r.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.text.run_script()

def beside():
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "scene.blend"))
    bpy.ops.wm.read_homefile()
    bpy.ops.wm.open_mainfile(filepath=os.path.join(folder, "scene.blend"))

if way == "opened text":
    run_in_editor(bpy.data.texts.load(script))
elif way == "opened text and .blend":
    beside()
    run_in_editor(bpy.data.texts.load(script))
elif way == "pasted text beside the .blend":
    beside()
    text = bpy.data.texts.new("Text")
    text.from_string(open(script).read())
    run_in_editor(text)

scene = bpy.context.scene
for thing in list(bpy.data.objects):
    bpy.data.objects.remove(thing)
camera = bpy.data.objects.new("eye", bpy.data.cameras.new("eye"))
camera.data.angle = 0.1
scene.collection.objects.link(camera)
scene.camera = camera
scene.render.engine = "CYCLES"
scene.cycles.samples = 1
scene.cycles.use_denoising = False
scene.render.resolution_x = scene.render.resolution_y = 4
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
for axis in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)):
    camera.rotation_euler = mathutils.Vector(axis).to_track_quat("-Z", "Y").to_euler()
    scene.render.filepath = os.path.join(tempfile.gettempdir(), "eye.exr")
    bpy.ops.render.render(write_still=True)
    seen = bpy.data.images.load(scene.render.filepath)
    pixels = list(seen.pixels)
    print("SEEN", *axis, *(sum(pixels[c::4]) / 16 for c in range(3)), flush=True)
    bpy.data.images.remove(seen)
'''


def check(way, folder, work):
    (work / 'inside.py').write_text(INSIDE)
    first = ['--python', str(folder / 'world.py')] if way == 'command line' else []
    run = subprocess.run(['blender', '-b', '--factory-startup', '--python-exit-code', '1', *first, '--python', str(work / 'inside.py'),
                          '--', way, str(folder)], capture_output=True, text=True, cwd=work)
    seen = [list(map(float, line.split()[1:])) for line in run.stdout.splitlines() if line.startswith('SEEN')]
    if run.returncode != 0 or len(seen) != 6:
        sys.exit(f'blender: {way}: {run.returncode}\n{run.stdout[-1000:]}{run.stderr[-2000:]}')
    for x, y, z, *colour in seen:
        # +X, +Y and +Z of the probe are +X, +Z and -Y; the map shows (direction + 1) / 2.
        wanted = [(d + 1) / 2 for d in (x, z, -y)]
        if max(abs(a - b) for a, b in zip(colour, wanted)) > 0.03:
            sys.exit(f'blender: {way}: towards {(x, y, z)} is {colour}, not {wanted}')


if shutil.which('blender') is None:
    print('blender is not installed')
    sys.exit(SKIPPED)
with tempfile.TemporaryDirectory() as name:
    work = pathlib.Path(name)
    subprocess.run([program, 'generate', 'directions', 'probe.exr', '--size', '512', '--to', 'latlong'], cwd=work, check=True)
    subprocess.run([program, 'bake', 'probe.exr', 'a folder', '--for', 'blender', '--quiet'], cwd=work, check=True)
    for way in ('command line', 'opened text', 'opened text and .blend', 'pasted text beside the .blend'):
        check(way, work / 'a folder', work)
print('world.py works in four ways, and shows what it should')

#!/usr/bin/env python3
"""The same command gives the same bytes on every processor, with any number of threads and at every place: runs commands as they
are, with newer instructions hidden from the C library, from Highway and from both, with 1, 2, 3 and 7 threads, and in another folder
under another user (where the test is run by root), time zone, locale and umask, and compares what they write. Caches of results may
rely on it. The library's own functions: tests/numeric/same_bytes_test.cpp.

  same_bytes.py ENVMAP PROBE     PROBE prints results of the C library, which must differ where it is misled at all
"""
import ctypes
import hashlib
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ENVMAP, PROBE = (str(pathlib.Path(p).resolve()) for p in sys.argv[1:3])
# The other user need not reach the folder of the build.
PUBLIC = tempfile.TemporaryDirectory()
os.chmod(PUBLIC.name, 0o755)
shutil.copy(pathlib.Path(ENVMAP).with_name('envmap-formats.so'), PUBLIC.name)
ENVMAP = shutil.copy(ENVMAP, PUBLIC.name)
SCENE = pathlib.Path(PUBLIC.name, 'scene.obj')

# What glibc (2.33 and later) is told not to use, and what Highway is.
HIDE_FROM_LIBC = {'GLIBC_TUNABLES': 'glibc.cpu.hwcaps=-AVX,-AVX2,-FMA,-FMA4,-AVX512F,-AVX512VL,-BMI2,-SSE4_1'}
THREADS = '--threads'
SETTINGS = {
    'as it is': {},
    'AVX2, FMA and AVX512 hidden from the C library, 7 threads': HIDE_FROM_LIBC | {THREADS: '7'},
    "Highway's targets capped, 1 thread": {'ENVMAP_BASELINE': '1', THREADS: '1'},
    'both, 2 threads': HIDE_FROM_LIBC | {'ENVMAP_BASELINE': '1', THREADS: '2'},
    'elsewhere, 3 threads': {THREADS: '3', 'TZ': 'Pacific/Kiritimati', 'LC_ALL': 'de_DE.UTF-8', 'LANG': 'de_DE.UTF-8', 'USER': 'other', 'HOME': '/nowhere'},
}

PROJECTIONS = 'latlong cube sphere paraboloid angular octahedral equal-area'.split()
COMMANDS = [
    'generate sun sun.exr --to latlong --size 64 --direction 2,2,3 --radius 4',
    'generate sh sh.exr --to sphere --size 40',
    'generate sky sky.exr --to angular --size 48',
    'generate checker checker.exr --to latlong --size 48 --forward -x',
    'generate directions cube.exr --to cube --size 24',
    *(f'convert sun.exr {p}.exr --to {p} --size 40 --rotate 33,-12,5 --exposure 0.3' for p in PROJECTIONS),
    *(f'convert {p}.exr from-{p}.exr --to cube --size 20' for p in PROJECTIONS),
    *(f'convert sun.exr {f}.exr --to sphere --size 24 --filter {f}'
      for f in 'nearest bilinear bicubic trilinear sat ewa area'.split()),
    'convert sun.exr chosen.exr --to cube --size 32 --max-error 1e-2 -q',
    'convert sun.exr eight.png --to cube --size 16 --clamp -q',
    'convert sun.exr p3.png --to cube --size 16 --clamp -q --output-space display_p3',
    'convert sun.exr sun.hdr', 'convert sun.exr sun.pfm', 'convert sun.exr sun.dds', 'convert sun.exr sun.ktx2 --zstd', 'convert sun.exr sun.ktx',
    *(f'mipmap {p}.exr chain-{p}.exr' for p in PROJECTIONS),
    'mipmap cube.exr border.exr --openexr-envmap',
    'mipmap cube.exr cube-bc6h.dds --depth bc6h --clamp -q', 'mipmap cube.exr cube-uastc.ktx2 --depth uastc-hdr --clamp -q', 'mipmap from-sphere.exr from-sphere-bc6h.ktx2 --depth bc6h --clamp --zstd -q',
    'convert sun.exr small.exr --to latlong --size 16', 'convert sun.exr aces.exr --output-space ACEScg --white 6000 --saturation 1.5',
    *(f'prefilter small.exr diffuse-{m}.exr --method {m} --size 6 -q' for m in 'auto exact treecode prefix-sums'.split()),
    *(f'prefilter small.exr phong-{m}.exr --lobe phong --exponent 40.5 --method {m} --size 6 -q'
      for m in 'exact treecode'.split()),
    *(f'prefilter small.exr ggx-{r}.exr --lobe ggx --roughness {r} --method multilevel --size 6 -q' for r in (0.01, 0.12, 0.5)),
    *(f'prefilter cube.exr ggx-cube-{r}.exr --lobe ggx --roughness {r} --size 6 -q' for r in (0.03, 0.5)),
    'prefilter sun.exr charlie.exr --lobe charlie --roughness .5 --size 6 -q',
    *(f'prefilter {p}.exr charlie-{p}.exr --lobe charlie --roughness .1 --size 3 -q' for p in ('sun', 'cube')),
    'generate sky wide.exr --to latlong --size 256',
    *(f'prefilter wide.exr narrow-{m}.exr --lobe {lobe} --exponent {m} --size 8 --depth float -q'
      for lobe, m in (('phong', 20000), ('phong', 90000), ('blinn-phong', 60000))),
    'prefilter small.exr phong-multilevel.exr --lobe phong --exponent 40.5 --method multilevel --size 6 -q',
    'prefilter angular.exr ggx.exr --lobe ggx --levels 3 --size 8 -q',
    'prefilter --brdf-table table.exr --size 6', 'prefilter --lobe charlie --brdf-table sheen.exr --table-size 6',
    'sh sun.exr --order 6 --irradiance --window auto --evaluate sh-map.exr --to latlong --size 24',
    'info sun.exr --json', 'info angular.exr', 'compare sphere.exr sun.exr --json --difference difference.exr',
    'preview sun.exr cube.exr preview.png',
    # Large enough that threads share the work.
    'generate sun large.exr --to latlong --size 300 --direction 1,2,3 --radius 5',
    *(f'convert large.exr large-{f}.exr --to sphere --size 150 --filter {f}' for f in ('bilinear', 'area')),
    'mipmap large.exr large-chain.exr', 'mipmap large-area.exr large-uniform.exr --weights uniform',
    *(f'convert large.exr large-{p}.exr --to {p} --size 150' for p in ('cube', 'paraboloid')),
    'mipmap large-cube.exr large.ktx2', 'mipmap large-cube.exr large-zstd.ktx2 --zstd', 'mipmap large-paraboloid.exr large.dds',
    'prefilter large.exr large-ggx.exr --lobe ggx --roughness 0.3 --size 16 -q',
    'generate atmosphere day.exr --size 12', 'compare large.exr large.exr --difference same.exr',
    'bake sun.exr baked --for pbrt -q',
    'render scene.obj cast.exr --method raycast --ambient 1 --to paraboloid --size 200 -q',
    'view scene.obj cast.png --method raycast --ambient 1 --camera 0,0,3 --width 64 --height 48 -q',
]
# OpenGL by the processor: the same bytes for any number of threads of envmap and of Mesa, on one machine.
DRAWN = [f'render scene.obj {{}}.exr --ambient 1 --size 64 --to {to}' for to in ('cube', 'sphere')] + [
    'view scene.obj {}.png --ambient 1 --camera 0,0,3 --width 64 --height 48 --mirror ball']
DRAWN_SETTINGS = [{}, {'LP_NUM_THREADS': '1'}, {'LP_NUM_THREADS': '2', THREADS: '1'}]


def write_scene():
    """Many triangles that touch and cut each other, and a tetrahedron in their midst."""
    corners, faces = [], []
    for k in range(300):
        a, r = 2.4 * k, 0.05 * k ** 0.5
        x, y, s, c = r * math.cos(a), r * math.sin(a), 0.2 * math.sin(0.1 * k), 0.2 * math.cos(0.1 * k)
        corners += [(x + c, y + s, -1), (x - s, y + c, -1), (x - c, y - s, -1 - 0.001 * (k % 7))]
        faces.append((3 * k + 1, 3 * k + 2, 3 * k + 3))
    tetrahedron = [(1, 1, 1), (-1, -1, 1), (-1, 1, -1), (1, -1, -1)]
    text = [f'v {x:.6f} {y:.6f} {z:.6f}' for x, y, z in corners] + ['g many'] + ['f %d %d %d' % f for f in faces]
    text += [f'v {0.4 * x} {0.4 * y} {0.4 * z}' for x, y, z in tetrahedron] + ['g ball']
    text += [f'f {901 + a} {901 + b} {901 + c}' for a, b, c in ((0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2))]
    pathlib.Path(SCENE).write_text('\n'.join(text) + '\n')


def call(command, setting, **more):
    """With the threads and the surroundings of a setting."""
    threads = [THREADS, setting[THREADS]] if THREADS in setting else []
    surroundings = os.environ | {key: value for key, value in setting.items() if key != THREADS}
    done = subprocess.run([ENVMAP, *command.split(), *threads], env=surroundings, capture_output=True, **more)
    if done.returncode != 0:
        sys.exit(f'same_bytes: envmap {command}: {done.stderr.decode()}')
    return done.stdout


def run(setting):
    """Name or command -> hash of the file, or of standard output."""
    hashes = {}
    elsewhere = 'TZ' in setting
    more = {'umask': 0o077} if elsewhere else {}
    with tempfile.TemporaryDirectory(prefix='größe 1 ' if elsewhere else None) as folder:
        shutil.copy(SCENE, folder)
        if elsewhere and os.getuid() == 0:
            nobody = 65534
            os.chown(folder, nobody, nobody)
            more |= {'user': nobody, 'group': nobody, 'extra_groups': []}
        for command in COMMANDS:
            hashes[command] = hashlib.sha256(call(command, setting, cwd=folder, **more)).hexdigest()
        for file in sorted(p for p in pathlib.Path(folder).rglob('*') if p.is_file()):
            hashes[str(file.relative_to(folder))] = hashlib.sha256(file.read_bytes()).hexdigest()
    return hashes


def drawn():
    """What differs of pictures by OpenGL."""
    try:
        ctypes.CDLL('libOSMesa.so.8')
        context = 'osmesa'
    except OSError:
        context = 'egl'
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(SCENE, folder)
        for k, command in enumerate(DRAWN):
            bytes_of = []
            for n, setting in enumerate(DRAWN_SETTINGS):
                name = f'{k}-{n}'
                call(f'{command.format(name)} -q --context {context}', setting | {'LIBGL_ALWAYS_SOFTWARE': '1'}, cwd=folder)
                bytes_of.append(next(pathlib.Path(folder).glob(name + '.*')).read_bytes())
            yield from (f'{command}: differs with {setting}' for one, setting in zip(bytes_of, DRAWN_SETTINGS) if one != bytes_of[0])


def probe(setting):
    return subprocess.run([PROBE], env=os.environ | setting, capture_output=True, check=True).stdout.split()


write_scene()
plain = probe({})
hidden = probe(HIDE_FROM_LIBC)
# On a processor without them there is nothing to hide, and nothing to see.
if b'avx2' in plain and (plain == hidden):
    sys.exit('same_bytes: hiding AVX2 and FMA from the C library changes nothing: are the names of its tunables others?')
wanted = run({})
bad = [f'{name} differs: {title}' for title, setting in SETTINGS.items() if setting
       for name, found in run(setting).items() if found != wanted[name]] + list(drawn())
print('\n'.join(bad) or f'{len(wanted)} outputs are the same {len(SETTINGS)} times')
sys.exit(1 if bad else 0)

#!/usr/bin/env python3
"""The same command gives the same bytes on every processor and at every place: runs commands as they are, with newer
instructions hidden from the C library, from Highway and from both, with one thread, and in another folder under another user
(where the test is run by root), time zone, locale and umask, and compares what they write. Caches of results may rely on it.

  same_bytes.py ENVMAP PROBE     PROBE prints results of the C library, which must differ where it is misled at all
"""
import hashlib
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

# What glibc (2.33 and later) is told not to use, and what Highway is.
HIDE_FROM_LIBC = {'GLIBC_TUNABLES': 'glibc.cpu.hwcaps=-AVX,-AVX2,-FMA,-FMA4,-AVX512F,-AVX512VL,-BMI2,-SSE4_1'}
SETTINGS = {
    'as it is': {},
    'AVX2, FMA and AVX512 hidden from the C library': HIDE_FROM_LIBC,
    "Highway's targets capped": {'ENVMAP_BASELINE': '1'},
    'both': HIDE_FROM_LIBC | {'ENVMAP_BASELINE': '1'},
    'elsewhere': {'TZ': 'Pacific/Kiritimati', 'LC_ALL': 'de_DE.UTF-8', 'LANG': 'de_DE.UTF-8', 'USER': 'other', 'HOME': '/nowhere'},
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
    'mipmap cube.exr cube-bc6h.dds --depth bc6h --clamp -q', 'mipmap from-sphere.exr from-sphere-bc6h.ktx2 --depth bc6h --clamp --zstd -q',
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
]


def run(setting):
    """Name or command -> hash of the file, or of standard output."""
    hashes = {}
    elsewhere = 'TZ' in setting
    more = {'umask': 0o077} if elsewhere else {}
    with tempfile.TemporaryDirectory(prefix='größe 1 ' if elsewhere else None) as folder:
        if elsewhere and os.getuid() == 0:
            nobody = 65534
            os.chown(folder, nobody, nobody)
            more |= {'user': nobody, 'group': nobody, 'extra_groups': []}
        for command in COMMANDS:
            threads = ['--threads', '1'] if 'ENVMAP_BASELINE' in setting else []
            done = subprocess.run([ENVMAP, *command.split(), *threads], cwd=folder, env=os.environ | setting, capture_output=True, **more)
            if done.returncode != 0:
                sys.exit(f'same_bytes: envmap {command}: {done.stderr.decode()}')
            hashes[command] = hashlib.sha256(done.stdout).hexdigest()
        for file in sorted(pathlib.Path(folder).iterdir()):
            hashes[file.name] = hashlib.sha256(file.read_bytes()).hexdigest()
    return hashes


def probe(setting):
    return subprocess.run([PROBE], env=os.environ | setting, capture_output=True, check=True).stdout.split()


plain = probe({})
hidden = probe(SETTINGS['both'])
# On a processor without them there is nothing to hide, and nothing to see.
if b'avx2' in plain and (plain == hidden):
    sys.exit('same_bytes: hiding AVX2 and FMA from the C library changes nothing: are the names of its tunables others?')
wanted = run({})
bad = [f'{name} differs: {title}' for title, setting in SETTINGS.items() if setting
       for name, found in run(setting).items() if found != wanted[name]]
print('\n'.join(bad) or f'{len(wanted)} outputs are the same {len(SETTINGS)} times')
sys.exit(1 if bad else 0)

#!/usr/bin/env python3
"""Installs envmap into a fresh folder, builds the example of envmap(3) against it by CMake (shared and static) and by
pkg-config, runs it, and holds what it writes against what the installed program says and makes.

  run.py SOURCE BUILD WORK CXX
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

source, build, work = (pathlib.Path(p).resolve() for p in sys.argv[1:4])
compiler = sys.argv[4]
tree = work / 'tree'


def run(*command, **more):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, **more)
    if done.returncode != 0:
        sys.exit(f'{" ".join(map(str, command))}: {done.returncode}\n{done.stdout}{done.stderr}')
    return done.stdout


def demand(holds, what):
    if not holds:
        sys.exit(f'consumer: {what}')


shutil.rmtree(work, ignore_errors=True)
work.mkdir(parents=True)
run('cmake', '--install', build, '--prefix', tree)

# What is there, and nothing of the machinery below.
library = next(tree.glob('lib*/**/libenvmap.so')).parent
for path in ('bin/envmap', 'share/man/man1/envmap-convert.1', 'share/man/man3/envmap.3',
             'share/bash-completion/completions/envmap', 'share/zsh/site-functions/_envmap',
             'share/fish/vendor_completions.d/envmap.fish'):
    demand((tree / path).exists(), f'{path} is not installed')
demand(os.readlink(library / 'libenvmap.so.1') == 'libenvmap.so.1.0.0', 'libenvmap.so.1 is no link to its version')
headers = list((tree / 'include').rglob('*.h'))
for header in headers:
    text = header.read_text()
    demand(not re.search(r'#include <(hwy|OpenImageIO|OpenEXR|Imf|GL|glad|OpenColorIO|tbb|fmt)', text), f'{header} shows a library below')
    demand('@file' in text, f'{header} does not say what it is for')
symbols = run('nm', '-DC', '--defined-only', library / 'libenvmap.so').splitlines()
names = [line.split(maxsplit=2)[2] for line in symbols if ' ' in line]
demand(any(n.startswith('envmap::convert(') for n in names), 'envmap::convert is not exported')
# fmt 10 shows its exception in every library that uses it, so that others can catch it.
strays = [n for n in names if not re.search(r'\benvmap::', n) and not re.match(r'(void |.* )?(std|__gnu_cxx|glm)::', n)
          and not re.search(r'\bfmt::v\d+::format_error\b', n)]
demand(not strays, f'exported besides envmap: {strays[:5]}')

# The example, word for word as the page has it.
page = (tree / 'share/man/man3/envmap.3').read_text()
example = re.search(r'^\.EX\n(.*?)^\.EE$', page, re.S | re.M)[1].replace('\\e', '\\').replace('\\-', '-')
(work / 'example.cpp').write_text(example)
run('cmake', '-S', source / 'tests/consumer', '-B', work / 'build', f'-DCMAKE_PREFIX_PATH={tree}', '-DCMAKE_BUILD_TYPE=Release',
    f'-DCMAKE_CXX_COMPILER={compiler}', f'-DEXAMPLE={work / "example.cpp"}')
run('cmake', '--build', work / 'build')
pkg = os.environ | {'PKG_CONFIG_PATH': str(library / 'pkgconfig')}
demand(run('pkg-config', '--modversion', 'envmap', env=pkg).strip() == '1.0.0', 'envmap.pc has another version')
flags = run('pkg-config', '--cflags', '--libs', 'envmap', env=pkg).split()
run(compiler, work / 'example.cpp', '-o', work / 'light_pc', *flags, f'-Wl,-rpath,{library}')

# It runs, and gives what the program gives.
envmap = tree / 'bin/envmap'
probe = work / 'probe.hdr'
run(envmap, 'generate', 'sun', probe, '--to', 'latlong', '--size', 64, '--radius', 20, '--value', '9,8,7')
run(envmap, 'convert', probe, work / 'cube.exr', '--to', 'cube', '--size', 64, '--depth', 'half')
for program in (work / 'build/light', work / 'build/light_static', work / 'light_pc'):
    cube, rough = work / f'{program.name}-cube.exr', work / f'{program.name}-rough.exr'
    said = run(program, probe, cube, rough)
    demand(float(said.split()[-1]) <= 1e-3, f'{program.name}: {said}')
    demand(cube.read_bytes() == (work / 'cube.exr').read_bytes(), f'{program.name}: the cube is not what the program writes')
    # A blur keeps the mean: the light of the map is that of the cube, to the error asked for and the coarse texels.
    flux = [json.loads(run(envmap, 'info', name, '--json'))['flux'] for name in (cube, rough)]
    demand(all(abs(a / b - 1) < 5e-3 for a, b in zip(*flux)), f'{program.name}: flux {flux}')
run(envmap, 'convert', probe, work / 'probe.tif', '--depth', 'float')  # Through the module of formats.
run(work / 'light_pc', work / 'probe.tif', work / 'a.exr', work / 'b.exr')
failed = subprocess.run([work / 'light_pc', work / 'missing.exr', 'a', 'b'], capture_output=True, text=True)
demand(failed.returncode == 1 and failed.stderr == f'{work / "missing.exr"}: no such file\n', f'error: {failed.stderr}')
# The tree may be moved: nothing in it is known by an absolute name.
tree.rename(work / 'moved')
run(work / 'moved/bin/envmap', 'info', probe)
shutil.rmtree(work)
print(f'{len(headers)} headers, {len(names)} symbols')

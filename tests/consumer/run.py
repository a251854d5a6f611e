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
             'share/doc/envmap/library.md', 'share/doc/envmap/how-to/troubleshooting.md',
             'share/envmap/samples/sample.hdr', 'share/envmap/samples/inputs.sh', 'share/envmap/samples/scenes/make.py',
             'share/bash-completion/completions/envmap', 'share/zsh/site-functions/_envmap', 'share/fish/vendor_completions.d/envmap.fish'):
    demand((tree / path).exists(), f'{path} is not installed')
documents = tree / 'share/doc/envmap'
for page in documents.rglob('*.md'):
    text = re.sub(r'```.*?```', '', page.read_text(), flags=re.S)  # Code has brackets of its own.
    for link in re.findall(r'\]\(([^)#:\s]+)[^):]*\)', text):
        target = (page.parent / link).resolve()
        demand(target.exists() and documents.resolve() in target.parents, f'{page.relative_to(tree)}: {link} is not installed')
demand(os.readlink(library / 'libenvmap.so.1.0') == 'libenvmap.so.1.0.0', 'libenvmap.so.1.0 is no link to its version')
headers = list((tree / 'include').rglob('*.h'))
for header in headers:
    text = header.read_text()
    demand(not re.search(r'#include <(hwy|OpenImageIO|OpenEXR|Imf|GL|glad|OpenColorIO|tbb|fmt)', text), f'{header} shows a library below')
    demand('@file' in text, f'{header} does not say what it is for')
symbols = run('nm', '-DC', '--defined-only', library / 'libenvmap.so').splitlines()
names = [line.split(maxsplit=2)[2] for line in symbols if ' A ' not in line]  # A: the version itself.
demand(any(n.startswith('envmap::convert(') for n in names), 'envmap::convert is not exported')
# fmt 10 shows its exception in every library that uses it, so that others can catch it.
strays = [n for n in names if not re.search(r'\benvmap::', n) and not re.match(r'(void |.* )?(std|__gnu_cxx|glm)::', n)
          and not re.search(r'\bfmt::v\d+::format_error\b', n)]
demand(not strays, f'exported besides envmap: {strays[:5]}')

shown = [line for line in run('nm', '-DC', '--defined-only', library / 'libenvmap-scenes.so').splitlines() if ' T ' in line]
demand(all(re.search(r'envmap::((render|view|irradiance_grid|ambient_cubes|write_grid|check_grid_file)\(|(Scene|Light|IrradianceGrid)::)', line) for line in shown), f'libenvmap-scenes.so exports {shown}')

# The commands of the first page, on the samples that were installed.
run(sys.executable, source / 'tests/recipes.py', source, tree / 'bin/envmap', 'README')

# The example, word for word as the page has it.
page = (tree / 'share/man/man3/envmap.3').read_text()
example = re.search(r'^\.EX\n(.*?)^\.EE$', page, re.S | re.M)[1].replace('\\e', '\\').replace('\\-', '-')
(work / 'example.cpp').write_text(example)
# Those of docs/library.md, each the body of a function of one program.
bodies = re.findall(r'^```cpp\n(.*?)^```$', (source / 'docs/library.md').read_text(), re.S | re.M)
demand(len(bodies) == 17, f'docs/library.md has {len(bodies)} examples')
includes = ('envmap/scenes.h', 'algorithm', 'cmath', 'filesystem', 'stop_token', 'string', 'thread', 'type_traits', 'vector')
(work / 'pages.cpp').write_text(
    ''.join(f'#include <{name}>\n' for name in includes) + 'using namespace envmap;\n' +
    ''.join(f'static int page_{number}() {{\n{body}return 0;\n}}\n' for number, body in enumerate(bodies)) +
    'int main(int, char** words) {\nconst int number = std::stoi(words[1]);\n' +
    ''.join(f'if (number == {number}) return page_{number}();\n' for number in range(len(bodies))) + 'return 2;\n}\n')
run('cmake', '-S', source / 'tests/consumer', '-B', work / 'build', f'-DCMAKE_PREFIX_PATH={tree}', '-DCMAKE_BUILD_TYPE=',
    f'-DCMAKE_CXX_COMPILER={compiler}', f'-DEXAMPLE={work / "example.cpp"}', f'-DPAGES={work / "pages.cpp"}')
run('cmake', '--build', work / 'build', '--parallel', '2')
pkg = os.environ | {'PKG_CONFIG_PATH': str(library / 'pkgconfig')}
demand(run('pkg-config', '--modversion', 'envmap', env=pkg).strip() == '1.0.0', 'envmap.pc has another version')
flags = run('pkg-config', '--cflags', '--libs', 'envmap', env=pkg).split()
demand('-std' not in ' '.join(flags), 'envmap.pc chooses a standard: it would undo the one that a project names')
run(compiler, '-std=c++20', work / 'example.cpp', '-o', work / 'light_pc', *flags, f'-Wl,-rpath,{library}')
scenes = run('pkg-config', '--cflags', '--libs', 'envmap-scenes', env=pkg).split()
run(compiler, '-std=c++20', source / 'tests/consumer/room.cpp', '-o', work / 'room_pc', *scenes, f'-Wl,-rpath,{library}')
# The static library by what pkg-config says of it.
static = run('pkg-config', '--static', '--cflags', '--libs', 'envmap', env=pkg).split()
demand(';' not in ' '.join(static), f'envmap.pc: {static}')
run(compiler, '-std=c++20', work / 'example.cpp', library / 'libenvmap.a', '-o', work / 'light_pc_static',
    *(flag for flag in static if flag != '-lenvmap'))
# An older standard is refused in one line.
old = subprocess.run([compiler, '-std=c++17', '-fsyntax-only', '-x', 'c++', '-', *flags[:1]], input='#include <envmap/base/export.h>\n',
                     capture_output=True, text=True)
demand('envmap needs C++20' in old.stderr, old.stderr)
(work / 'room.obj').write_text(''.join(f'v {x} {y} {z}\n' for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)) +
                               'f 1 2 4 3\nf 5 6 8 7\nf 1 2 6 5\n')
for number in range(len(bodies)):
    run(work / 'build/pages', number, cwd=work)
# A project that adds the sources gets the libraries, and neither tests nor samples.
(work / 'outer').mkdir()
(work / 'outer/CMakeLists.txt').write_text('cmake_minimum_required(VERSION 3.25)\nproject(outer LANGUAGES CXX)\n'
    f'add_subdirectory({source} envmap)\nadd_executable(light {work / "example.cpp"})\n'
    'target_link_libraries(light PRIVATE envmap::static)\n')
run('cmake', '-S', work / 'outer', '-B', work / 'outer/build', f'-DCMAKE_CXX_COMPILER={compiler}')
cache = (work / 'outer/build/CMakeCache.txt').read_text()
for option in ('ENVMAP_TESTS:BOOL=OFF', 'ENVMAP_SAMPLES:BOOL=OFF', 'CMAKE_BUILD_TYPE:STRING=\n'):
    demand(option in cache, f'added to another project: {option} is not so')

# It runs, and gives what the program gives.
envmap = tree / 'bin/envmap'
probe = work / 'probe.hdr'
run(envmap, 'generate', 'sun', probe, '--to', 'latlong', '--size', 64, '--radius', 20, '--value', '9,8,7')
run(envmap, 'convert', probe, work / 'cube.exr', '--to', 'cube', '--size', 64, '--depth', 'half')
# What the program bakes and renders, the libraries do, too.
for engine in ('three', 'filament', 'unity'):
    run(envmap, 'bake', probe, work / f'{engine}-program', '--for', engine, '--quality', 'draft')
    run(work / 'build/engines', probe, engine, work / f'{engine}-library')
    files = sorted(p.name for p in (work / f'{engine}-program').iterdir())
    demand(files == sorted(p.name for p in (work / f'{engine}-library').iterdir()), f'{engine}: other files')
    for name in files:
        demand((work / f'{engine}-program' / name).read_bytes() == (work / f'{engine}-library' / name).read_bytes(),
               f'{engine}/{name}: the library writes other bytes than the program')
run(envmap, 'render', work / 'room.obj', work / 'room.exr', '--environment', probe, '--size', 16, '--method', 'raycast')
run(envmap, 'view', work / 'room.obj', work / 'view.exr', '--environment', probe, '--width', 32, '--height', 24, '--method', 'raycast')
for name, program in (('library', work / 'build/room'), ('pc', work / 'room_pc')):
    run(program, work / 'room.obj', probe, work / f'room-{name}.exr', work / f'view-{name}.exr')
    for made in ('room', 'view'):
        demand((work / f'{made}.exr').read_bytes() == (work / f'{made}-{name}.exr').read_bytes(),
               f'{made} of libenvmap-scenes ({name}): other bytes than the program')
# Symbols have versions: two of the library may be in one process.
demand('@@libenvmap.so.1.0' in run('nm', '-D', '--with-symbol-versions', '--defined-only', library / 'libenvmap.so'),
       'symbols have no version')
for program in (work / 'build/light', work / 'build/light_static', work / 'light_pc', work / 'light_pc_static'):
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

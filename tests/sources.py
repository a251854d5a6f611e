#!/usr/bin/env python3
"""Rules for the sources that no compiler knows. Usage: sources.py ROOT"""
import pathlib
import re
import sys

FUNCTIONS = ('sin cos tan asin acos atan atan2 sinh cosh tanh exp exp2 exp10 expm1 log log2 log10 log1p pow cbrt hypot erf tgamma '
             'lgamma polar slerp radians degrees sinf cosf expf logf powf')
LIBM = re.compile(r'(?:\b(?:std|glm)::|(?<![\w:.>]))(?:' + FUNCTIONS.replace(' ', '|') + r')\(')
DRAWING = ('src/envmap/scenes/render/', 'src/envmap/scenes/scene/', 'src/envmap/scenes/read/')
# Loops go through base/parallel.h, where TBB is compiled once. The module of formats has no part of the library.
MAY_INCLUDE_TBB = {'src/envmap/base/parallel.cpp', 'src/envmap/io/formats/openimageio.cpp', 'src/python/module.cpp'}
MAY_CALL_LIBM = {'src/envmap/maths/portable.h', 'src/envmap/maths/portable.cpp'}  # Their own names.

root = pathlib.Path(sys.argv[1])
broken = []


def without_comments(text):
    """Comments blank, lines kept."""
    blank = lambda match: match[0] if match[0][0] == '"' else re.sub(r'[^\n]', ' ', match[0])
    return re.sub(r'"(?:\\.|[^"\\\n])*"|//[^\n]*|/\*.*?\*/', blank, text, flags=re.S)


for path in sorted(p for p in (root / 'src').rglob('*') if p.suffix in ('.h', '.cpp')):
    name = str(path.relative_to(root))
    for number, line in enumerate(without_comments(path.read_text()).splitlines(), 1):
        # The library knows no command line: errors carry a Remedy, which tools/ words.
        if re.search(r'"[^"]*(?<![\w-])--[a-z][^"]*"', line):
            broken.append(f'{name}:{number}: words of the command line in the library: {line.strip()}')
        # The C library's last bits depend on the processor: results are made by maths/portable.h. Drawing is OSMesa's.
        if LIBM.search(line) and not name.startswith(DRAWING) and name not in MAY_CALL_LIBM:
            broken.append(f'{name}:{number}: {LIBM.search(line)[0]}...) differs between processors: see maths/portable.h')
        if '<tbb/' in line and name not in MAY_INCLUDE_TBB:
            broken.append(f'{name}:{number}: TBB takes long to compile: see base/parallel.h')

# What callers may cast from any number is checked by number_of(), which must know how many there are.
RESULTS_ALONE = {'Curve', 'Orientation'}  # No function takes one.
for path in sorted((root / 'src/envmap').rglob('*.h')):
    text = without_comments(path.read_text())
    if 'namespace ENVMAP_EXPORT envmap' in text:
        broken += [f'{path.relative_to(root)}: enumerators<{name}> is missing: see base/enumerators.h'
                   for name in re.findall(r'^enum class (\w+)', text, re.M)
                   if name not in RESULTS_ALONE and f'enumerators<{name}> =' not in text]

# NVIDIA's compiler finds clamp(x, 0.5, 1) ambiguous: of floats or of doubles. Mesa's does not mind.
MIXED = re.compile(r'\bclamp\(.*, *(?:-?\d*\.\d+|-?\d+e-?\d+), *-?\d+\)|\bclamp\(.*, *-?\d+, *(?:-?\d*\.\d+|-?\d+e-?\d+)\)')
for path in sorted((root / 'src').rglob('*.glsl')):
    broken += [f'{path.relative_to(root)}:{number}: write both limits of clamp() as floats, or both as integers'
               for number, line in enumerate(path.read_text().splitlines(), 1) if MIXED.search(line)]

# The formatter breaks longer lines (git clang-format). Raw strings stay as they are.
for folder in ('src', 'tools', 'tests', 'cmake'):
    for path in sorted(p for p in (root / folder).rglob('*') if p.suffix in ('.h', '.cpp', '.cmake') or p.name == 'CMakeLists.txt'):
        name = str(path.relative_to(root))
        text = re.sub(r'R"(\w*)\(.*?\)\1"', lambda match: '\n' * match[0].count('\n'), path.read_text(), flags=re.S)
        broken += [f'{name}:{number}: over 120 columns' for number, line in enumerate(text.splitlines(), 1)
                   if len(line) > 120]

print('\n'.join(broken))
sys.exit(1 if broken else 0)

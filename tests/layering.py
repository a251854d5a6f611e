#!/usr/bin/env python3
"""Who may include whom: reads the order of the folders from CONTRIBUTING.md and every #include of src/ and tools/, and fails
on each one that points up, or from a folder to another of the same level.

  layering.py ROOT                the check
  layering.py ROOT --turn-round   the check of the check: with each include turned round, all must be found
"""
import os
import pathlib
import re
import shutil
import sys
import tempfile

# Includes that point up and are to go: each must still be there, so that this list gets shorter.
KNOWN = set()


def levels(root):
    """Folder -> its level, 0 at the bottom. CONTRIBUTING.md draws them: Includes point one way: tools -> (io, render) -> ..."""
    text = (root / 'CONTRIBUTING.md').read_text()
    drawing = re.search(r'Includes point one way:\s+((?:\(.*?\)|[\w/]+)(?:\s*->\s*(?:\(.*?\)|[\w/]+))+)', text)
    if not drawing:
        sys.exit('layering: CONTRIBUTING.md: no line "Includes point one way: tools -> ..."')
    top_down = drawing[1].split('->')
    return {folder: level for level, folders in enumerate(reversed(top_down)) for folder in re.findall(r'[\w/]+', folders)}


def room(path, level):
    """The folder of the drawing that a file lies in, the deepest where there are several ('scene/read' before 'scene')."""
    if path == 'src/envmap/envmap.h':  # All of the library.
        return 'tools'
    inside = path.removeprefix('src/envmap/')
    return max((folder for folder in level if inside.startswith(folder + '/')), key=len, default=None) or sys.exit(
        f'layering: {path}: lies in no folder of the drawing in CONTRIBUTING.md')


def includes(root):
    for folder in ('src', 'tools'):
        for file in sorted((root / folder).rglob('*')):
            if file.suffix not in ('.h', '.cpp') or root / 'src/python' in file.parents:
                continue
            for name in re.findall(r'^\s*#\s*include\s*"([^"]+)"', file.read_text(), re.M):
                for place in (file.parent, root / 'src', root / 'tools'):
                    if (place / name).exists():
                        yield str(file.relative_to(root)), str((place / name).resolve().relative_to(root))
                        break


def pointing_up(root, level):
    for includer, included in includes(root):
        a, b = room(includer, level), room(included, level)
        if a != b and level[a] <= level[b]:
            yield includer, included


def turn_round(root, level):
    """Adds the reverse of every include between two folders to a copy of the sources, and looks for each."""
    turned = {(b, a) for a, b in includes(root) if room(a, level) != room(b, level) and (a, b) not in KNOWN}
    with tempfile.TemporaryDirectory() as folder:
        copy = pathlib.Path(folder).resolve()
        for part in ('src', 'tools'):
            shutil.copytree(root / part, copy / part)
        for a, b in turned:
            with open(copy / a, 'a') as file:
                file.write(f'#include "{os.path.relpath(copy / b, (copy / a).parent)}"\n')
        missed = turned - set(pointing_up(copy, level))
    for a, b in sorted(missed):
        print(f'layering: {a} includes {b}: not found')
    print(f'layering: {len(turned)} includes turned round, {len(missed)} missed')
    return 0 if turned and not missed else 1


def python_module(root):
    """The module knows the library's public face, and render.cpp what draws scenes."""
    for file in sorted((root / 'src/python').glob('*.*')):
        for name in re.findall(r'^\s*#\s*include\s*"(envmap/[^"]+)"', file.read_text(), re.M):
            draws = file.name == 'render.cpp' and name.startswith(('envmap/render/', 'envmap/scene/'))
            if name != 'envmap/envmap.h' and not draws:
                yield str(file.relative_to(root)), f'src/{name}'


def check(root, level):
    found = set(pointing_up(root, level)) | set(python_module(root))
    for a, b in sorted(found - KNOWN):
        print(f'layering: {a} includes {b}: that points up (CONTRIBUTING.md, "Includes point one way")')
    for a, b in sorted(KNOWN - found):
        print(f'layering: {a} no longer includes {b}: take it from KNOWN in {sys.argv[0]}')
    return 0 if found == KNOWN else 1


if __name__ == '__main__':
    top = pathlib.Path(sys.argv[1]).resolve()
    sys.exit((turn_round if '--turn-round' in sys.argv else check)(top, levels(top)))

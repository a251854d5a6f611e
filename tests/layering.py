#!/usr/bin/env python3
"""Who may include whom: reads the order of the folders from docs/architecture.md and every #include of src/ and tools/, and
fails on each one that points up, or from a folder to another of the same level. docs/architecture.svg shows the includes.

  layering.py ROOT                the check, and that the picture shows the includes as they are
  layering.py ROOT --draw         draws the picture anew
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
    """Folder -> its level, 0 at the bottom. The page has them: Includes point one way: tools -> (io, render) -> ..."""
    text = (root / 'docs/architecture.md').read_text()
    drawing = re.search(r'Includes point one way:\s+((?:\(.*?\)|[\w/]+)(?:\s*->\s*(?:\(.*?\)|[\w/]+))+)', text)
    if not drawing:
        sys.exit('layering: docs/architecture.md: no line "Includes point one way: tools -> ..."')
    top_down = drawing[1].split('->')
    return {folder: level for level, folders in enumerate(reversed(top_down)) for folder in re.findall(r'[\w/]+', folders)}


def room(path, level):
    """The folder of the drawing that a file lies in, the deepest where there are several ('scene/read' before 'scene')."""
    if path in ('src/envmap/envmap.h', 'src/envmap/scenes.h'):  # All of the library.
        return 'tools'
    inside = path.removeprefix('src/envmap/')
    return max((folder for folder in level if inside.startswith(folder + '/')), key=len, default=None) or sys.exit(
        f'layering: {path}: lies in no folder of docs/architecture.md')


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


def picture(root, level):
    """The rooms as an SVG. Of includes only those are drawn that no others imply."""
    rooms = sorted(level, key=lambda r: (-level[r], r))
    uses = {(room(a, level), room(b, level)) for a, b in includes(root)}
    uses = {(a, b) for a, b in uses if a != b}
    drawn = {(a, b) for a, b in uses if not any((a, c) in uses and (c, b) in uses for c in rooms)}
    width, height, step = 130, 34, 68
    across = {'engine': 320, 'scene/read': 480, 'io': 370, 'render': 100, 'prefilter': 200, 'scene': 480}
    place = {r: (across.get(r, 260), 30 + step * (level[rooms[0]] - level[r])) for r in rooms}
    svg = [f'<svg xmlns="http://www.w3.org/2000/svg" width="560" height="{step * (level[rooms[0]] + 1)}" font-family="sans-serif" font-size="15">',
           '<defs><marker id="tip" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="8" markerHeight="8" orient="auto">'
           '<path d="M0 0L8 4L0 8z" fill="#567"/></marker></defs>',
           '<rect width="100%" height="100%" fill="white"/>']
    for a, b in sorted(drawn):
        (x, y), (u, v) = place[a], place[b]
        # Round the rooms between, where there are many.
        end = f'L{u} {v - height // 2}' if level[a] - level[b] < 3 else f'Q{x} {v} {u + width // 2} {v}'
        svg.append(f'<path d="M{x} {y + height // 2}{end}" fill="none" stroke="#567" stroke-width="1.5" marker-end="url(#tip)"/>')
    for r, (x, y) in place.items():
        svg.append(f'<rect x="{x - width // 2}" y="{y - height // 2}" width="{width}" height="{height}" rx="5" fill="#dfe8f5" stroke="#567"/>'
                   f'<text x="{x}" y="{y + 5}" text-anchor="middle">{r}</text>')
    return '\n'.join(svg) + '\n</svg>\n'


def draw(root, level):
    (root / 'docs/architecture.svg').write_text(picture(root, level))
    return 0


def python_module(root):
    """The module knows the public faces of the libraries."""
    for file in sorted((root / 'src/python').glob('*.*')):
        for name in re.findall(r'^\s*#\s*include\s*"(envmap/[^"]+)"', file.read_text(), re.M):
            if name not in ('envmap/envmap.h', 'envmap/scenes.h'):
                yield str(file.relative_to(root)), f'src/{name}'


def check(root, level):
    found = set(pointing_up(root, level)) | set(python_module(root))
    for a, b in sorted(found - KNOWN):
        print(f'layering: {a} includes {b}: that points up (docs/architecture.md, "Includes point one way")')
    for a, b in sorted(KNOWN - found):
        print(f'layering: {a} no longer includes {b}: take it from KNOWN in {sys.argv[0]}')
    drawn = (root / 'docs/architecture.svg').read_text() == picture(root, level)
    if not drawn:
        print(f'layering: docs/architecture.svg shows other includes: python3 {sys.argv[0]} . --draw')
    return 0 if found == KNOWN and drawn else 1


if __name__ == '__main__':
    top = pathlib.Path(sys.argv[1]).resolve()
    action = turn_round if '--turn-round' in sys.argv else draw if '--draw' in sys.argv else check
    sys.exit(action(top, levels(top)))

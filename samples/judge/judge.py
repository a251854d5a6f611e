#!/usr/bin/env python3
"""How far tools are off on maps that are hard, and how long they take: one table.

    python3 samples/judge/judge.py [--envmap PROGRAM] [--json FILE] [--only TEXT]

Judged: envmap, exrenvmap (OpenEXR), maketx (OpenImageIO), pfspanoramic (pfstools), ffmpeg's v360, and with --browser the filters
that three.js and Babylon.js run when they load a map (engines.sh; needs node, npm and chromium). What is not installed is left out and named.
The right answers are sums in float64 by truth.py, which shares nothing with envmap. Needs python3-numpy and python3-openimageio.

The maps are latlong, 256x128:
  furnace   1 everywhere: whatever comes out has to be 1
  sun       0.5, and one texel of 59904 in mid-sky
  pole      0.5, and one texel of 59904 beside the pole
  stops     noise from 2^-15 to 2^6: 21 stops from texel to texel
  checker   0 and 1 by turns
Columns are errors: the largest of a texel (max), the root of the mean square (rms), and of all light together (flux). Seconds are
of the whole process on a map of 2048x1024, of all cores, the least of three.
"""
import argparse
import json
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

import truth

HERE = Path(__file__).resolve().parent
CASES = ('furnace', 'sun', 'pole', 'stops', 'checker')
# What of each map's errors is told.
COLUMNS = (('furnace', 'max'), ('sun', 'rms'), ('sun', 'flux'), ('pole', 'rms'), ('pole', 'flux'), ('stops', 'rms'),
           ('checker', 'rms'))
HIGH, ROUGHNESS = 128, 0.5
GGX = f'GGX {ROUGHNESS:g}, 100 directions'


# ---- images ----------------------------------------------------------------------------------------------------------

def write_map(path, grey):
    """As halves, or RGBE in .hdr files."""
    high, wide = grey.shape
    out = oiio.ImageOutput.create(str(path))
    if not out or not out.open(str(path), oiio.ImageSpec(wide, high, 3, 'half')) or not out.write_image(np.repeat(grey[..., None], 3, 2).astype('f4')):
        raise RuntimeError(f'{path}: {oiio.geterror()}')
    out.close()


def read_grey(path, level=0):
    """Red of any image, by OpenImageIO: no tool reads its own files."""
    image = oiio.ImageInput.open(str(path))
    if not image or not image.seek_subimage(0, level):
        raise RuntimeError(f'{path}: {oiio.geterror()}')
    return image.read_image('float')[..., 0].astype(float)


def hard_maps(high):
    """@return high x 2 high x one for each of CASES; values that halves and RGBE hold exactly."""
    j, i = np.mgrid[:high, :2 * high]
    noise = np.random.Generator(np.random.PCG64(1)).integers(0, 22, (high, 2 * high))
    sun, pole = np.full((2, high, 2 * high), 0.5)
    sun[high * 2 // 5, high // 7] = pole[0, high] = 59904
    return np.stack([np.ones_like(sun), sun, pole, np.exp2(noise - 15.0), (i + j) % 2.0], -1)


# ---- tools -----------------------------------------------------------------------------------------------------------

# Job: tool: what it runs, and where its samples lie in source and result. {in}, {out} are EXR files of halves; {h} is the
# height of the source.
def jobs(envmap):
    return {
        'to a cube, a texel for 2 x 2': {
            'envmap': (f'{envmap} convert -q {{in}} {{out}} --to cube --size {{h/4}}', 'centre'),
            'exrenvmap': ('exrenvmap -c -w {h/4} {in} {out}', 'border'),
            'ffmpeg v360': ('ffmpeg -v error -y -i {in} -vf v360=e:c1x6:interp=linear:w={h/4}:h={h*3/2} -c:v exr -format half {out}', 'centre'),
        },
        'to angular': {
            'envmap': (f'{envmap} convert -q {{in}} {{out}} --to angular --size {{h}}', 'centre'),
            'pfspanoramic': ('pfsinexr {in} | pfspanoramic polar+angular -i -w {h} | pfsoutexr --compression ZIP {out}', 'corner'),
        },
        'mip level 3': {
            'envmap': (f'{envmap} mipmap -q {{in}} {{out}}', 'centre'),
            'maketx': ('maketx --envlatl -d half {in} -o {out}', 'centre'),
        },
        'diffuse, cube of 16': {
            'envmap': (f'{envmap} prefilter -q {{in}} {{out}} --lobe diffuse --to cube --size 16', 'centre'),
        },
        GGX: {
            'envmap': (f'{envmap} prefilter -q {{in}} {{out}} --lobe ggx --roughness {ROUGHNESS:g} --to cube --size 64', 'centre'),
        },
    }


def filled(command, files, high):
    words = {'{in}': str(files[0]), '{out}': str(files[1]), '{h}': str(high), '{h/4}': str(high // 4), '{h*3/2}': str(high * 3 // 2)}
    for word, value in words.items():
        command = command.replace(word, value)
    return command


def run(command):
    """@return seconds; raises with what the tool said last."""
    start = time.perf_counter()
    done = subprocess.run(['bash', '-o', 'pipefail', '-c', command], capture_output=True, text=True, stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        raise RuntimeError((done.stderr.strip().splitlines() or ['failed'])[-1])
    return time.perf_counter() - start


def missing(command):
    return [p for p in (part.split()[0] for part in command.split(' | ')) if not shutil.which(p)]


# ---- answers ---------------------------------------------------------------------------------------------------------

def ggx_texels():
    """Texels (face, row, column) of a cube of 64: some by chance, and those about the suns."""
    chance = np.random.Generator(np.random.PCG64(2))
    texels = [tuple(int(k) for k in chance.integers(0, (6, 64, 64))) for _ in range(64)]
    return texels + [(face, row, column) for face in range(6) for row in (4, 30, 50) for column in (12, 40)]


def ggx_directions():
    return np.array([truth.cube_direction(f, np.array((i + 0.5) / 64), np.array((j + 0.5) / 64))[0] for f, j, i in ggx_texels()])


def answer(job, maps, lies):
    """@return the right result and its weights."""
    if job.startswith('to a cube'):
        return truth.converted(maps, truth.cube_direction, 6, HIGH // 4, lies)
    if job == 'to angular':
        found, weights = truth.converted(maps, truth.angular_direction, 1, HIGH, lies)
        middle = (np.arange(HIGH) + 0.5) / HIGH * 2 - 1
        return found, weights * (np.hypot(*np.meshgrid(middle, middle)) < 1)  # Not all write texels whose centre is outside.
    if job == 'mip level 3':
        return truth.level(maps, 3)
    if job.startswith('diffuse'):
        face, v, u = np.meshgrid(np.arange(6), (np.arange(16) + 0.5) / 16, (np.arange(16) + 0.5) / 16, indexing='ij')
        d, w = zip(*(truth.cube_direction(f, u[f], v[f]) for f in range(6)))
        blurred = truth.blurred(maps, np.reshape(d, (-1, 3)), truth.diffuse)
        return blurred.reshape(6, 16, 16, -1), np.array(w)
    found = truth.blurred(maps, ggx_directions(), truth.ggx(ROUGHNESS))
    return found, np.ones(len(found))


def result(job, path):
    """What a tool wrote, in the shape of the answer."""
    image = read_grey(path, 3 if job == 'mip level 3' else 0)
    if job.startswith(('to a cube', 'diffuse', 'GGX')):
        image = image.reshape(6, image.shape[1], image.shape[1])
    else:
        image = image[None]
    return np.array([image[texel] for texel in ggx_texels()]) if job.startswith('GGX') else image


def judged(job, command, lies, maps, truths, folder):
    """@return {case: {max, rms, flux}}."""
    key = (job, lies)
    if key not in truths:
        truths[key] = answer(job, maps, lies)
    right, weights = truths[key]
    found = {}
    for k, case in enumerate(CASES):
        out = folder / 'out.exr'
        out.unlink(missing_ok=True)
        try:
            run(filled(command, (folder / f'{case}.exr', out), HIGH))
            found[case] = truth.errors(result(job, out), right[..., k], weights)
        except (RuntimeError, ValueError) as e:
            found[case] = str(e)
    return found


NAMES = {'three': 'three.js', 'babylon_own': 'Babylon.js'}  # By their modules.


# ---- the table -------------------------------------------------------------------------------------------------------

def cell(errors, metric):
    if isinstance(errors, str):
        return 'failed'
    value = abs(dict(zip(('max', 'rms', 'flux'), errors))[metric])
    return '0' if value < 5e-16 else f'{value:.1e}'


def table(rows):
    lines = [['job', 'tool', 'seconds', *(f'{case} {metric}' for case, metric in COLUMNS)]]
    for k, (job, tool, seconds, found) in enumerate(rows):
        lines.append([job if k == 0 or rows[k - 1][0] != job else '', tool, f'{seconds:.2f}' if seconds else '',
                      *(cell(found[case], metric) for case, metric in COLUMNS)])
    widths = [max(len(line[k]) for line in lines) for k in range(len(lines[0]))]
    lines.insert(1, ['-' * w for w in widths])
    return '\n'.join('| ' + ' | '.join(c.ljust(w) for c, w in zip(line, widths)) + ' |' for line in lines)


def in_browser(maps, folder):
    """Rows of the engines that engines.sh asks."""
    job, asked = GGX, folder / 'asked'
    right, weights = answer(job, maps, 'centre')
    for k, case in enumerate(CASES):
        (asked / case).mkdir(parents=True)
        # What three.js and Babylon.js have in the middle: +X, and +Z where its world is left-handed (found by trying all turns).
        write_map(asked / case / 'background.exr', np.roll(maps[..., k], HIGH // 2, 1))
        write_map(asked / case / 'background.hdr', maps[..., k])
    (asked / 'asked.json').write_text(json.dumps({'directions': ggx_directions().tolist(), 'roughness': ROUGHNESS}))
    done = subprocess.run(['sh', HERE / 'engines.sh', asked, *CASES], stdout=subprocess.PIPE, text=True)
    rows = []
    for line in done.stdout.splitlines():
        if not line.startswith('{'):
            print(line, file=sys.stderr)
            continue
        said = json.loads(line)
        rows.append((job, NAMES[said['engine']], None, {case: truth.errors(np.array(said['found'][case]), right[:, k], weights)
                                                for k, case in enumerate(CASES)}))
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--envmap', default='envmap', help='the program (default: the one installed)')
    parser.add_argument('--json', metavar='FILE', help='all figures')
    parser.add_argument('--only', default='', metavar='TEXT', help='only jobs whose name holds this')
    parser.add_argument('--browser', action='store_true', help='judge what engines filter, too, in headless Chromium')
    o = parser.parse_args()
    envmap = shutil.which(o.envmap)
    if not envmap:
        parser.error(f'{o.envmap}: not there; --envmap says where')
    rows, absent, truths, maps = [], set(), {}, hard_maps(HIGH)
    with tempfile.TemporaryDirectory(prefix='judge-') as temporary:
        folder = Path(temporary)
        for k, case in enumerate(CASES):
            write_map(folder / f'{case}.exr', maps[..., k])
        write_map(folder / 'large.exr', hard_maps(1024)[..., CASES.index('stops')])
        for job, tools in jobs(envmap).items():
            for tool, (command, lies) in tools.items() if o.only in job else ():
                if lacks := missing(command):
                    absent.update(lacks)
                    continue
                print(f'\r\033[K{job}: {tool}', end='', file=sys.stderr, flush=True)
                found = judged(job, command, lies, maps, truths, folder)
                seconds = min(run(filled(command, (folder / 'large.exr', folder / 'out.exr'), 1024)) for _ in range(3))
                rows.append((job, tool, seconds, found))
        if o.browser and o.only in GGX:
            rows += in_browser(maps, folder)
    print('\r\033[K', end='', file=sys.stderr)
    print(table(rows))
    if absent:
        print('\nnot installed, left out:', ', '.join(sorted(absent)))
    if o.json:
        Path(o.json).write_text(json.dumps([{'job': j, 'tool': t, 'seconds': s, 'errors': f} for j, t, s, f in rows], indent=1) + '\n')


if __name__ == '__main__':
    main()

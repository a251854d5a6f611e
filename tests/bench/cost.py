"""Measures the table of envmap-cost(7): processor time and peak memory of whole commands, by the size of the source.

  cost.py ENVMAP PROBE [ROOT] [WORD]   PROBE: a panorama. ROOT: the sources, whose docs/figures.json gets the rows (default: only
                                       printed); figures.py then fills the pages. WORD: only jobs that contain this word.

Every source is a half-float panorama in EXR. Times are the least of three runs with two threads.
"""
import datetime
import os
import pathlib
import subprocess
import sys
import tempfile

import figures

SIZES = (512, 2048, 4096)  # Heights.
# name: words after `envmap`, with IN and OUT.
JOBS = {
    'info': 'info IN',
    'convert, cube of 1/4': 'convert IN OUT.exr --to cube --size QUARTER --depth half',
    'convert, cube of 64': 'convert IN OUT.exr --to cube --size 64',
    'mipmap to KTX2': 'mipmap IN OUT.ktx2 --depth half',
    'sh, degree 2': 'sh IN',
    'preview': 'preview IN OUT.png',
    'bake three --latlong': 'bake IN OUT --for three --latlong',
    'prefilter, diffuse 64': 'prefilter IN OUT.exr',
    'prefilter, 6 GGX of 256': 'prefilter IN OUT.exr --lobe ggx --size 256 --levels 6',
    'bake for Filament': 'bake IN OUT --for filament',
}


def measure(command):
    """@return processor seconds and peak memory in MB."""
    best = None
    for _ in range(3):
        child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, used = os.wait4(child.pid, 0)
        if status != 0:
            sys.exit(f'failed: {" ".join(command)}')
        seconds = used.ru_utime + used.ru_stime
        best = seconds if best is None else min(best, seconds)
    return best, used.ru_maxrss / 1024


def put(root, name, cells):
    """Replaces the row of a job in docs/figures.json."""
    every = figures.load(root)
    row = next(r for r in every['commands']['rows'] if r['job'] == name)
    row['cells'] = [{'seconds': float(f'{seconds:.2g}'), 'megabytes': round(memory)} for seconds, memory in cells]
    every['commands']['date'] = str(datetime.date.today())
    figures.save(root, every)


def main():
    program, probe = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    root = pathlib.Path(sys.argv[3]).resolve() if len(sys.argv) > 3 else None
    word = sys.argv[4] if len(sys.argv) > 4 else ''
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for size in SIZES:
            subprocess.run([program, 'convert', probe, f'in{size}.exr', '--to', 'latlong', '--size', str(size), '--depth', 'half'], check=True)
        for number, (name, words) in enumerate(JOBS.items()):
            cells = []
            for size in SIZES if word in name else ():
                command = words.replace('IN', f'in{size}.exr').replace('OUT', f'out{number}-{size}').replace('QUARTER', str(size // 2))
                cells.append(measure([program, *command.split(), '--threads', '2']))
            if cells:
                print(name, *(f'{seconds:.2g} s, {memory:.0f} MB' for seconds, memory in cells), sep='\t', flush=True)
                if root:
                    put(root, name, cells)


main()

#!/usr/bin/env python3
"""How processor time and memory grow with a map, and where the time goes: the tables of envmap-performance(7).

    python3 tests/bench/scaling.py PROBE [--envmap build/bench/envmap] [--largest 16384] [--runs 3] [--json FILE]

PROBE, a photograph, is resampled to maps of WIDTH x WIDTH/2 as half EXR in a folder of $TMPDIR. Times are processor time (user and
system) of whole processes, the least of the runs, less that of a start: on a busy machine they mean more than a clock. Parts are found
by difference: reading is what a map of one texel takes, computing what an uncompressed KTX2 takes beyond that, writing what the zipped
EXR takes beyond that. The busiest thread, by /proc every 2 ms, bounds what no further thread could take over. Needs only Python's
standard library and envmap.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def thread_times(process):
    """Nanoseconds that each thread has run."""
    found = {}
    try:
        for task in Path(f'/proc/{process.pid}/task').iterdir():
            found[task.name] = int((task / 'schedstat').read_text().split()[0])
    except (OSError, ValueError, IndexError):
        pass  # It ended meanwhile.
    return found


def used(command):
    """Of a command: processor seconds, those of its busiest thread, and peak memory in bytes."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    threads = {}
    while True:
        threads.update(thread_times(process))
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            break
        time.sleep(0.002)
    if status != 0:
        sys.exit(f'scaling: {" ".join(map(str, command))} ended with {status}')
    return usage.ru_utime + usage.ru_stime, max(threads.values(), default=0) / 1e9, usage.ru_maxrss * 1024


def least(commands, runs):
    """Of each command the least of used(), in rounds, so that other work falls on all."""
    found = [(float('inf'),) * 3] * len(commands)
    for _ in range(runs):
        found = [tuple(map(min, old, used(command))) for old, command in zip(found, commands)]
    return found


def jobs(envmap, source, width, out):
    """Name, texels of the result, and its commands: to one texel, to uncompressed floats, whole."""
    cube = width // 4
    raw, zipped = out / 'out.ktx2', out / 'out.exr'
    convert = [envmap, 'convert', source]
    read = convert + [zipped, '--to', 'cube', '--size', '1', '--filter', 'nearest', '-q']
    mipmap, lobe = [envmap, 'mipmap', source], [envmap, 'prefilter', source]
    ggx = ['--lobe', 'ggx', '--roughness', '0.5', '--to', 'cube', '--size', '64', '-q']
    same = ['--to', 'cube', '--size', str(cube), '-q']
    return [('convert', 6 * cube * cube, read, convert + [raw, '--depth', 'half'] + same, convert + [zipped] + same),
            ('mipmap', width * width // 2 * 4 // 3, read, None, mipmap + [zipped, '-q']),
            ('prefilter', width * width // 2, read, lobe + [raw, '--depth', 'half'] + ggx, lobe + [zipped] + ggx)]


def measured(envmap, probe, width, threads, runs, folder):
    source = folder / f'{width}.exr'
    if not source.exists():
        used([envmap, 'convert', probe, source, '--to', 'latlong', '--size', str(width // 2), '--depth', 'half', '--clamp', '-q'])
    rows = []
    for name, texels, read, raw, whole in jobs(envmap, source, width, folder):
        commands = [c + ['--threads', str(threads)] for c in (read, raw, whole) if c]
        start, *parts = least([[envmap, '--version']] + commands, runs)
        seconds = [max(0.0, p[0] - start[0]) for p in parts]
        row = {'job': name, 'width': width, 'threads': threads, 'texels': texels, 'seconds': seconds[-1],
               'busiest': parts[-1][1], 'memory': parts[-1][2], 'read': seconds[0]}
        if raw:
            row['compute'], row['write'] = max(0.0, seconds[1] - seconds[0]), max(0.0, seconds[2] - seconds[1])
        rows.append(row)
    return rows


def line(row):
    total = row['seconds']
    def part(key):
        return f'{100 * row[key] / total:3.0f}%' if key in row and total > 0.05 else '    '  # Less is noise.
    return (f'{row["job"]:10} {row["width"]:6} {row["threads"]:3} {total:9.3f} {1e9 * total / row["texels"]:8.0f} '
            f'{row["busiest"]:8.3f} {row["memory"] / 1e6:8.0f} {part("read"):>8} {part("compute"):>8} {part("write"):>8}')


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('probe')
    parser.add_argument('--envmap', default=str(ROOT / 'build/bench/envmap'))
    parser.add_argument('--smallest', type=int, default=64)
    parser.add_argument('--largest', type=int, default=16384)
    parser.add_argument('--threads', type=int, nargs='+', default=[1, 2])
    parser.add_argument('--runs', type=int, default=3)
    parser.add_argument('--json')
    o = parser.parse_args()
    rows = []
    print(f'load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores', file=sys.stderr)
    print('job         width  th   seconds ns/texel  busiest       MB     read  compute    write')
    with tempfile.TemporaryDirectory() as name:
        width = o.smallest
        while width <= o.largest:
            for threads in o.threads:
                for row in measured(o.envmap, o.probe, width, threads, o.runs if width <= 4096 else 1, Path(name)):
                    rows.append(row)
                    print(line(row), flush=True)
            (Path(name) / f'{width}.exr').unlink()
            width *= 4 if width < 1024 else 2
    if o.json:
        Path(o.json).write_text(json.dumps(rows, indent=1) + '\n')


if __name__ == '__main__':
    main()

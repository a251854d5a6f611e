#!/usr/bin/env python3
"""How far the method that prefilter chooses is from the quickest, in 70 jobs: the time of `auto` over that of the best method.

    python3 tests/bench/methods.py PROBE [--envmap build/bench/envmap] [--runs 2] [--json methods.json]

PROBE is resampled to a latlong map of 1024x512 and to a cube of 256. Times are processor time of whole processes, the least of the runs,
less what reading takes. A method that takes more than 60 s is not the best.
"""
import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LOBES = ([('ggx', '--roughness', r) for r in (0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.7, 0.9)] +
         [('phong', '--exponent', m) for m in (1.5, 2.5, 4, 5, 6, 10, 30, 180, 700, 2100, 7300, 25000, 100000, 1000000)] +
         [('blinn-phong', '--exponent', m) for m in (1, 3, 10, 100, 2000, 30000)] +
         [('charlie', '--roughness', r) for r in (0.2, 0.3, 0.4, 0.6, 1)])
METHODS = ('auto', 'treecode', 'multilevel')
LIMIT = 60


def used(command):
    """Processor seconds of a command, or None where it refuses the job or takes too long."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT)))
    _, status, usage = os.wait4(process.pid, 0)
    return usage.ru_utime + usage.ru_stime if os.waitstatus_to_exitcode(status) == 0 else None


def least(command, runs):
    found = [used(command) for _ in range(runs)]
    return None if None in found else min(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('probe', type=Path)
    parser.add_argument('--envmap', default=str(ROOT / 'build/bench/envmap'))
    parser.add_argument('--runs', type=int, default=2)
    parser.add_argument('--json', type=Path)
    o = parser.parse_args()
    jobs = []
    with tempfile.TemporaryDirectory() as out:
        for to, size in (('latlong', 512), ('cube', 256)):
            source = Path(out) / f'{to}.exr'
            subprocess.run([o.envmap, 'convert', o.probe, source, '--to', to, '--size', str(size), '-q'], check=True)
            reading = least([o.envmap, 'prefilter', source, Path(out) / 'x.exr', '--lobe', 'ggx', '--roughness', '0', '--size', '4', '-q'], 3)
            for lobe, option, value in LOBES:
                command = [o.envmap, 'prefilter', source, Path(out) / 'x.exr', '--lobe', lobe, option, str(value), '--size', '64',
                           '--depth', 'float', '--max-error', '1e-3', '-q', '--method']
                times = {m: least(command + [m], o.runs) for m in METHODS}
                known = [max(t - reading, 0.005) for t in times.values() if t is not None]
                ratio = max(times['auto'] - reading, 0.005) / min(known) if times['auto'] is not None else float('inf')
                jobs.append({'source': f'{to} {size}', 'lobe': lobe, 'parameter': value, 'seconds': times, 'ratio': ratio})
                shown = ', '.join(f'{m} {"-" if t is None else f"{t - reading:.2f}"}' for m, t in times.items())
                print(f'{to:8} {lobe:12} {value:<8g} {ratio:5.2f}   {shown}', flush=True)
    ratios = sorted(j['ratio'] for j in jobs)
    print(f'{len(ratios)} jobs: worst {ratios[-1]:.2f}, {sum(r > 1.3 for r in ratios)} above 1.3, mean {sum(ratios) / len(ratios):.2f}')
    if o.json:
        o.json.write_text(json.dumps({'reading': reading, 'jobs': jobs}, indent=1) + '\n')


if __name__ == '__main__':
    sys.exit(main())

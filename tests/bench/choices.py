#!/usr/bin/env python3
"""How far the filters that convert --max-error chooses are from the best there is, in time: the table of envmap-accuracy(7).

    python3 tests/bench/choices.py PROBE... [--envmap build/bench/envmap] [--runs 3]

Give probes that nothing was fitted to. Times are processor time of whole processes, the least of the runs, in rounds, less what reading
alone takes; a choice is as good as its time over that of the quickest method that keeps the error.
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FILTERS = [('nearest', 1), ('bilinear', 1), ('bicubic', 1), ('bilinear', 2), ('bilinear', 4), ('ewa', 1), ('bilinear', 8)]


def used(command):
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if os.waitstatus_to_exitcode(status) not in (0, 1):
        sys.exit(f'choices: {" ".join(map(str, command))} failed')
    return usage.ru_utime + usage.ru_stime


def least(commands, runs):
    found = [float('inf')] * len(commands)
    for _ in range(runs):
        found = [min(old, used(command)) for old, command in zip(found, commands)]
    return found


def report(command):
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=False).stdout)


def conversions(envmap, probe, runs, out):
    """Ratios of convert --max-error to the quickest filter that is found to keep the error in every texel."""
    for size in (64, 256):
        to = [envmap, 'convert', probe, out / 'out.exr', '--to', 'cube', '--size', str(size), '--depth', 'float', '-q']
        truth = out / 'truth.exr'
        used(to[:3] + [truth] + to[4:] + ['--filter', 'area', '--area-error', '1e-6'])
        ways = [to + ['--filter', f, '--samples', str(n)] if n > 1 else to + ['--filter', f] for f, n in FILTERS]
        ways += [to + ['--filter', 'area', '--area-error', '2.5e-3']]
        errors = []
        for way in ways:
            used(way)
            difference = report([envmap, 'compare', out / 'out.exr', truth, '--json'])
            errors.append(max(difference['max'], difference['rms']))
        for error in (0.1, 1e-2):
            auto, *others = least([to + ['--max-error', str(error)]] + ways, runs)
            good = [t for t, e in zip(others, errors) if e <= error]
            yield f'{size} {error:g}', auto / min(good), auto - min(good)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('probes', nargs='+', type=Path)
    parser.add_argument('--envmap', default=str(ROOT / 'build/bench/envmap'))
    parser.add_argument('--runs', type=int, default=3)
    o = parser.parse_args()
    with tempfile.TemporaryDirectory() as out:
        ratios, late = [], []
        for probe in o.probes:
            for job, ratio, seconds in conversions(o.envmap, probe, o.runs, Path(out)):
                print(f'{probe.stem:24} {job:14} {ratio:6.2f} {seconds:7.3f} s', flush=True)
                ratios.append(ratio), late.append(seconds)
    ratios.sort()
    print(f'{len(ratios)} jobs, median {statistics.median(ratios):.2f}, nine in ten below '
          f'{ratios[len(ratios) * 9 // 10]:.2f}, worst {ratios[-1]:.2f}; at most {max(late):.2f} s late')


if __name__ == '__main__':
    main()

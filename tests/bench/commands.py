#!/usr/bin/env python3
"""Times whole commands: envmap, a plain copy of the file, and other tools at the same job. See README.md beside this.

    python3 tests/bench/commands.py [PROBE] [--runs N] [--json FILE] [--markdown FILE]

PROBE is any map that envmap reads; without one a sky with a sun is generated. Needs only Python's standard library,
envmap, and oiiotool; exrenvmap, maketx, pfstools and ffmpeg are timed where they are installed.
"""
import argparse
import datetime
import json
import os
import shlex
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path

import figures

ROOT = Path(__file__).resolve().parents[2]


# ---- what is run -----------------------------------------------------------------------------------------------------

@dataclass
class Row:
    """One command at one job. The words {in} and {out} stand for its files."""
    tool: str
    command: str
    # Where the tool takes its samples to lie, in the result and in the source: see judge.cpp. None: not judged.
    samples: tuple[str, str] | None = ('centre', 'centre')
    after: str = ''    # Untimed: {out} to {judged}, what is judged in its place.
    times: list[float] = field(default_factory=list)
    cpu: list[float] = field(default_factory=list)
    memory: int = 0    # Bytes.
    failure: str = ''
    error: dict = field(default_factory=dict)


@dataclass
class Job:
    name: str
    source: Path
    source_projection: str
    projection: str
    rows: list[Row]


def jobs(n, latlong, cube, angular, envmaps):
    """The jobs for a latlong map n texels high, and the same map as cube and as angular."""
    def job(name, source, source_projection, projection, size, others, cut=''):
        rows = [Row('copy', f'oiiotool {{in}} {cut} -d half -o {{out}}', None)]
        rows += [Row(label, f'{envmap} {{in}} {{out}} --to {projection} --size {size}') for label, envmap in envmaps]
        return Job(name, source, source_projection, projection, rows + others)

    def pfs(projections, width, after=''):
        # It reads sample i as lying at i/W and writes texel centres; found by trying all ways with judge.
        return Row('pfspanoramic', f'pfsinexr {{in}} | pfspanoramic {projections} -i -w {width} | '
                   'pfsoutexr --compression ZIP {out}', ('centre', 'corner'), after)

    def v360(projections, width, height):
        # 16-bit integers inside: what is over 1 is lost, so there is nothing to judge.
        return Row('ffmpeg', f'ffmpeg -v error -y -i {{in}} -vf v360={projections}:interp=linear:w={width}:h={height} '
                   '-c:v exr -format half -compression zip16 {out}', None)

    def levels(name, source, projection, others):
        # All levels, and beside it what only reads and writes as many: not judged here, see envmap-accuracy(7).
        chain = source.with_name(f'{projection}-levels.exr')
        rows = [Row('copy', f'oiiotool -a {chain} -o {{out}}', None)]
        for label, envmap in envmaps:
            mipmap = envmap.replace(' convert ', ' mipmap ').split(' --filter ')[0]
            rows += [Row(label, f'{mipmap} {{in}} {{out}}', None),
                     Row(f'{label} uniform', f'{mipmap} {{in}} {{out}} --weights uniform', None)]
        return Job(name, source, projection, projection, rows + others)

    def blurred(name, source, projection, options, result):
        # Beside what only reads the source and writes a map of the result's size: envmap checks its own errors.
        rows = [Row('copy', f'oiiotool {{in}} --cut {result}x{6 * result}+0+0 -d half -o {{out}}', None)]
        for label, envmap in envmaps:
            program = envmap.split(' convert ')[0]
            rows.append(Row(label, f'{program} prefilter -q {{in}} {{out}} {options}', None))
        return Job(name, source, projection, 'cube', rows)

    face, small, border = n // 2, n // 32, ('border', 'border')
    flop = 'oiiotool {out} --flop -o {judged}'  # Its mirror ball is seen from the other side.
    mip = 'oiiotool {out} --selectmip 4 -o {judged}'
    return [
        job(f'latlong {2 * n}x{n} to cube {face}', latlong, 'latlong', 'cube', face,
            [Row('exrenvmap', f'exrenvmap -c -w {face} {{in}} {{out}}', border),
             v360('e:c1x6', face, 6 * face)]),
        job(f'latlong {2 * n}x{n} to cube {small}', latlong, 'latlong', 'cube', small,
            [Row('exrenvmap', f'exrenvmap -c -w {small} {{in}} {{out}}', border)],
            f'--cut {small}x{6 * small}+0+0'),
        job(f'latlong {2 * n}x{n} to {n // 8}x{n // 16}', latlong, 'latlong', 'latlong', n // 16,
            [Row('maketx', 'maketx --envlatl -d half {in} -o {out}', after=mip),
             Row('oiiotool --resize', f'oiiotool {{in}} --resize:filter=box {n // 8}x{n // 16} -d half -o {{out}}')],
            f'--cut {n // 8}x{n // 16}+0+0'),
        job(f'latlong {2 * n}x{n} to sphere {2 * n}', latlong, 'latlong', 'sphere', 2 * n,
            [pfs('polar+mirrorball', 2 * n, flop), v360('e:ball', 2 * n, 2 * n)]),
        job(f'latlong {2 * n}x{n} to paraboloid {n}', latlong, 'latlong', 'paraboloid', n, []),
        job(f'latlong {2 * n}x{n} to angular {2 * n}', latlong, 'latlong', 'angular', 2 * n,
            [pfs('polar+angular', 2 * n)]),
        job(f'cube {face} to latlong {2 * n}x{n}', cube, 'cube', 'latlong', n,
            [Row('exrenvmap', f'exrenvmap -ci -l -w {2 * n} {{in}} {{out}}', border),
             v360('c1x6:e', 2 * n, n)]),
        levels(f'levels of latlong {2 * n}x{n}', latlong, 'latlong',
               [Row('maketx', 'maketx --envlatl -d half {in} -o {out}', None)]),
        levels(f'levels of cube {face}', cube, 'cube',
               [Row('exrenvmap', f'exrenvmap -ci -c -m -w {face} {{in}} {{out}}', None)]),
        levels(f'levels of angular {2 * n}', angular, 'angular', []),
        blurred(f'diffuse of latlong {2 * n}x{n}', latlong, 'latlong', '--max-error 1e-4', 64),
        blurred(f'phong chain of latlong {2 * n}x{n}', latlong, 'latlong',
                '--lobe phong --size 256 --levels 9 --exponent 2048', 256),
        blurred(f'ggx chain of cube {face}', cube, 'cube', '--lobe ggx --size 256 --levels 6', 256),
        job(f'angular {2 * n} to latlong {2 * n}x{n}', angular, 'angular', 'latlong', n,
            [pfs('angular+polar', 2 * n)]),
    ]


def programs(row):
    return [shlex.split(part)[0] for part in row.command.split(' | ')]


# ---- running ---------------------------------------------------------------------------------------------------------

def filled(command, **files):
    for name, path in files.items():
        command = command.replace(f'{{{name}}}', shlex.quote(str(path)))
    return command


def run_once(command, limit):
    """@return seconds, processor seconds, largest process in bytes, what went wrong."""
    with tempfile.TemporaryFile() as messages:
        start = time.perf_counter()
        process = subprocess.Popen(['sh', '-c', command if '|' in command else f'exec {command}'],
                                   stdout=subprocess.DEVNULL, stderr=messages, start_new_session=True)
        late = threading.Timer(limit, os.killpg, (process.pid, signal.SIGKILL))
        late.start()
        _, status, used = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - start
        late.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        messages.seek(0)
        said = messages.read().decode(errors='replace').strip().splitlines()
    failure = ''
    if process.returncode != 0:
        failure = f'over {limit:g} s' if process.returncode == -signal.SIGKILL else (said or ['failed'])[-1]
    return seconds, used.ru_utime + used.ru_stime, used.ru_maxrss * 1024, failure


def measure(job, row, out, limit, record):
    command = filled(row.command, **{'in': job.source, 'out': out})
    out.unlink(missing_ok=True)
    seconds, cpu, memory, row.failure = run_once(command, limit)
    if not row.failure and not out.exists():
        row.failure = 'wrote nothing'
    if record and not row.failure:
        row.times.append(seconds)
        row.cpu.append(cpu)
        row.memory = max(row.memory, memory)


def time_job(job, folder, runs, limit):
    """Rounds of all rows, A B C A B C: what else the machine does falls on all of them alike. The first round is not
    recorded: it warms the caches, and its results are the ones judged."""
    for k in range(runs + 1):
        for number, row in enumerate(job.rows):
            progress(f'{job.name}: {row.tool}, ' + (f'run {k} of {runs}' if k else 'warming up'))
            if not row.failure:
                measure(job, row, folder / f'result-{number}.exr', limit, k > 0)


def judge_job(job, folder, judge):
    for number, row in enumerate(job.rows):
        if row.failure or not row.samples:
            continue
        progress(f'{job.name}: {row.tool}, judged')
        result, judged = folder / f'result-{number}.exr', folder / 'judged.exr'
        if row.after:
            subprocess.run(['sh', '-c', filled(row.after, out=result, judged=judged)], check=True)
            result = judged
        said = subprocess.run([judge, result, job.projection, row.samples[0],
                               job.source, job.source_projection, row.samples[1]], capture_output=True, text=True)
        if said.returncode == 0:
            row.error = json.loads(said.stdout)
        else:
            print(f'{row.tool} is not judged: {said.stderr.strip()}', file=sys.stderr)


def progress(text):
    if sys.stderr.isatty():
        print(f'\r\033[K{text}', end='', file=sys.stderr, flush=True)


# ---- inputs ----------------------------------------------------------------------------------------------------------

def make_inputs(envmap, probe, n, folder):
    def run(*words):
        subprocess.run([envmap, *map(str, words)], check=True)

    latlong, cube, angular = (folder / f'{p}.exr' for p in ('latlong', 'cube', 'angular'))
    if probe:
        run('convert', '-q', probe, latlong, '--to', 'latlong', '--size', n, '--depth', 'half', '--clamp')
    else:
        run('generate', '-q', 'sun', latlong, '--size', n, '--depth', 'half',
            '--direction', '2,2,3', '--radius', 4, '--value', '100,80,50')
    run('convert', '-q', latlong, cube, '--to', 'cube', '--filter', 'bilinear')
    run('convert', '-q', latlong, angular, '--to', 'angular', '--filter', 'bilinear')
    for source in (latlong, cube, angular):
        run('mipmap', '-q', source, folder / f'{source.stem}-levels.exr')
    return latlong, cube, angular


# ---- the answer ------------------------------------------------------------------------------------------------------

def ratio_to_copy(row, copy):
    """Of the runs of one round, then the median: load that comes and goes cancels out."""
    return statistics.median(a / b for a, b in zip(row.times, copy.times))


def report(done, runs, source, n):
    float_image = 2 * n * n * 12
    result = {'machine': machine(), 'runs': runs, 'source': source, 'float_image_bytes': float_image, 'jobs': []}
    for job in done:
        copy, rows = job.rows[0], []
        for row in job.rows:
            entry = {'tool': row.tool, 'command': filled(row.command, **{'in': 'IN.exr', 'out': 'OUT.exr'})}
            if row.failure:
                entry['failure'] = row.failure
            else:
                entry.update(seconds=round(statistics.median(row.times), 4),
                             all_seconds=[round(t, 4) for t in row.times],
                             cpu_seconds=round(statistics.median(row.cpu), 4), memory_bytes=row.memory,
                             memory_ratio=round(row.memory / float_image, 2), **row.error)
                if not copy.failure:
                    entry['copies'] = round(ratio_to_copy(row, copy), 2)
            rows.append(entry)
        result['jobs'].append({'job': job.name, 'source_bytes': job.source.stat().st_size, 'rows': rows})
    return result


def machine():
    model = 'unknown processor'
    for line in Path('/proc/cpuinfo').read_text().splitlines():
        if line.startswith('model name'):
            model = line.split(':', 1)[1].strip()
            break
    return {'processor': model, 'cores': len(os.sched_getaffinity(0)), 'load_at_start': LOAD}


def table(result, with_seconds):
    heads = ['job', 'tool', *(['seconds', 'range', 'cpu s'] if with_seconds else []), 'copies', 'memory', 'rms', 'max']
    lines = [heads, ['---'] * len(heads)]
    for job in result['jobs']:
        for k, row in enumerate(job['rows']):
            cells = [job['job'] if k == 0 else '', row['tool']]
            if 'failure' in row:
                cells += [row['failure'].replace('|', '/')] + [''] * (len(heads) - 3)
            else:
                if with_seconds:
                    spread = f'{min(row["all_seconds"]):.2f}-{max(row["all_seconds"]):.2f}'
                    cells += [f'{row["seconds"]:.2f}', spread, f'{row["cpu_seconds"]:.2f}']
                cells += [f'{row["copies"]:.2f}' if 'copies' in row else '', f'{row["memory_ratio"]:.2f}']
                cells += [f'{row[key]:.1e}' if key in row else '' for key in ('rms', 'max')]
            lines.append(cells)
    widths = [max(len(line[c]) for line in lines) for c in range(len(heads))]
    return '\n'.join('| ' + ' | '.join(cell.ljust(w) for cell, w in zip(line, widths)) + ' |' for line in lines)


def markdown(result):
    m = result['machine']
    return (f'{m["processor"]}, {m["cores"]} cores; {result["source"]}; median of {result["runs"]} runs. Only the '
            f'ratios mean anything on another machine.\n\n{table(result, False)}\n')


def put(root, result):
    """Replaces the rows of the jobs that docs/figures.json has."""
    every = figures.load(root)
    known = every['conversions']
    for job in result['jobs']:
        for old in (k for k in known['jobs'] if k['job'] == job['job']):
            names = {'copies': 'copies', 'memory_ratio': 'memory', 'rms': 'rms', 'max': 'max'}
            for row in (r for r in old['rows'] for new in job['rows'] if r['tool'] == new['tool'] and 'failure' not in new):
                measured = next(new for new in job['rows'] if new['tool'] == row['tool'])
                row.update({name: float(f'{measured[key]:.2g}') for key, name in names.items() if key in measured})
    m = result['machine']
    known.update(machine=f"{m['cores']} cores of {m['processor']}", date=str(datetime.date.today()), source=result['source'])
    figures.save(root, every)


# ---- the command line ------------------------------------------------------------------------------------------------

def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('probe', nargs='?', help='map to use in place of a generated sky')
    parser.add_argument('--runs', type=int, default=5, help='of each command (default: 5)')
    parser.add_argument('--size', type=int, default=2048, help='height of the latlong map (default: 2048)')
    parser.add_argument('--only', default='', metavar='TEXT', help='only jobs whose name holds this, such as "to cube"')
    parser.add_argument('--limit', type=float, default=600, help='seconds a command may take (default: 600)')
    parser.add_argument('--envmap', action='append', metavar='PATH',
                        help='program to time (default: build/bench/envmap); twice or more to compare builds')
    parser.add_argument('--filters', default='auto', metavar='NAMES',
                        help='of envmap, with commas between them: a row each (default: auto)')
    parser.add_argument('--judge', default=str(ROOT / 'build/bench/judge'), help='what finds the errors, or none (default: build/bench/judge)')
    parser.add_argument('--folder', help='for inputs and results, about 1 GB (default: a temporary one)')
    parser.add_argument('--json', metavar='FILE', help='every time of every run')
    parser.add_argument('--markdown', metavar='FILE', help='the table without seconds, for documents')
    parser.add_argument('--figures', metavar='ROOT', help='sources whose docs/figures.json gets the rows; figures.py then fills the pages')
    options = parser.parse_args()
    if options.runs < 1 or options.size < 64 or options.size & (options.size - 1):
        parser.error('--runs is 1 or more, --size a power of two from 64')
    options.envmap = options.envmap or [str(ROOT / 'build/bench/envmap')]
    for program in [*options.envmap, 'oiiotool']:
        if not shutil.which(program):
            parser.error(f'{program}: not there; build: cmake --preset bench && cmake --build --preset bench')
    return options


def envmap_commands(o):
    """Label and command of each build with each filter."""
    commands = []
    for path in o.envmap:
        for name in o.filters.split(','):
            label = ['envmap' if len(o.envmap) == 1 else path] + ([] if o.filters == 'auto' else [name])
            commands.append((' '.join(label), f'{shlex.quote(shutil.which(path))} convert -q --filter {name}'))
    return commands


def leave_out_missing(all_jobs):
    missing = set()
    for job in all_jobs:
        absent = {id(row): [p for p in programs(row) if not shutil.which(p)] for row in job.rows}
        missing.update(p for names in absent.values() for p in names)
        job.rows = [row for row in job.rows if not absent[id(row)]]
    return sorted(missing)


def bench(o, folder):
    inputs = make_inputs(o.envmap[0], o.probe, o.size, folder)
    chosen = [job for job in jobs(o.size, *inputs, envmap_commands(o)) if o.only in job.name]
    missing = leave_out_missing(chosen)
    judge = shutil.which(o.judge)
    for job in chosen:
        time_job(job, folder, o.runs, o.limit)
        if judge:
            judge_job(job, folder, judge)
    progress('')

    source = f'{Path(o.probe).name if o.probe else "a generated sky with a sun"} at {2 * o.size}x{o.size}, half EXR'
    result = report(chosen, o.runs, source, o.size)
    result['not_installed'] = missing
    m = result['machine']
    print(f'{m["processor"]}, {m["cores"]} cores, load {LOAD:.1f} at the start; {source}')
    print(table(result, True))
    if missing:
        print('not installed, left out:', ', '.join(missing))
    if not judge:
        print(f'{o.judge}: not there, so no errors')
    if not o.probe:
        print('A generated sky compresses better than a photograph: copies are cheap here. Give a probe of yours.')
    return result


def main():
    o = arguments()
    if LOAD > 0.3:
        print(f'load average {LOAD:.1f}: something else is running, times will be noisy', file=sys.stderr)
    with tempfile.TemporaryDirectory(prefix='envmap-bench-') as temporary:
        folder = Path(o.folder or temporary)
        folder.mkdir(parents=True, exist_ok=True)
        result = bench(o, folder)
    if o.json:
        Path(o.json).write_text(json.dumps(result, indent=1) + '\n')
    if o.markdown:
        Path(o.markdown).write_text(markdown(result))
    if o.figures:
        put(Path(o.figures), result)
    return 1 if any('failure' in row for job in result['jobs'] for row in job['rows']) else 0


LOAD = os.getloadavg()[0]

if __name__ == '__main__':
    sys.exit(main())

"""Fills the tables of README.md, envmap-cost(7), the page of performance and the page of these benchmarks from docs/figures.json, so that
a figure stands in one place.

  figures.py ROOT            writes the pages
  figures.py ROOT --check    fails if a page says something else

A table stands between the comments "figures: NAME" and "figures end". commands.py and cost.py write docs/figures.json.
"""
import json
import pathlib
import re
import sys

FILE = 'docs/figures.json'


# ---- figures -----------------------------------------------------------------------------------------------------------

def load(root):
    return json.loads((root / FILE).read_text())


def in_lines(value, indent=0):
    """JSON with a row in a line, so that a change of a figure is a line of a diff."""
    flat, pad = json.dumps(value), ' ' * (indent + 1)
    if len(flat) + indent <= 118 or not isinstance(value, (dict, list)):
        return flat
    if isinstance(value, list):
        return '[\n' + ',\n'.join(pad + in_lines(v, indent + 1) for v in value) + '\n' + ' ' * indent + ']'
    return '{\n' + ',\n'.join(f'{pad}{json.dumps(k)}: {in_lines(v, indent + 1)}' for k, v in value.items()) + '\n' + ' ' * indent + '}'


def save(root, figures):
    (root / FILE).write_text(in_lines(figures) + '\n')


def rows_of(figures, job):
    return next(j for j in figures['conversions']['jobs'] if j['job'] == job)['rows']


def row(figures, job, tool):
    return next(r for r in rows_of(figures, job) if r['tool'].startswith(tool))


# ---- words -------------------------------------------------------------------------------------------------------------

def percent(value):
    return f'{100 * value:.2g}%'


def flux_error(value):
    return f'{value:.0e}'.replace('e-0', 'e-') if value < 1e-3 else percent(value)


def times(value):
    return f'{value:.2g} x'


def measured(part):
    return ', '.join(part[key] for key in ('machine', 'date') if key in part) + f", version {part['version']}"


def markdown(heads, rows):
    return '\n'.join('| ' + ' | '.join(cells) + ' |' for cells in [heads] + rows).replace('\n', '\n|' + '---|' * len(heads) + '\n', 1)


# ---- tables ------------------------------------------------------------------------------------------------------------

CUBE, LEVELS, CUBE_LEVELS = 'latlong 4096x2048 to cube 1024', 'levels of latlong 4096x2048', 'levels of cube 1024'


def benefits(f):
    ours, theirs = row(f, CUBE, 'envmap'), row(f, CUBE, 'exrenvmap')
    faster, worse = theirs['copies'] / ours['copies'], theirs['rms'] / ours['rms']
    return (f'- **Fast and accurate.** On two cores, a 4096x2048 panorama becomes a cube {faster:.0f} times faster than with `exrenvmap`, which\n'
            f'  uses one, and with an error that is {worse:.1f} times smaller.')


def comparisons(f):
    def levels(job):
        return next(e for e in f['levels']['worst_flux_error'] if e['job'] == job)

    def converted(job, words, tool, command):
        ours, theirs = row(f, job, 'envmap'), row(f, job, tool)
        return [words, f"{times(ours['copies'])}, rms {percent(ours['rms'])}", f"`{tool}` {times(theirs['copies'])}, rms {percent(theirs['rms'])}", command]

    def with_levels(job, words, tool, command):
        error = levels(job)
        return [words, f"{times(row(f, job, 'envmap')['copies'])}, flux {flux_error(error['envmap'])}",
                f"`{tool}` {times(row(f, job, tool)['copies'])}, flux {flux_error(error['tool_error'])}", command]

    d = f['diffuse']
    rows = [
        converted(CUBE, 'panorama of 4096x2048 to a cube of 1024', 'exrenvmap', "`commands.py PROBE --only 'to cube 1024'`"),
        converted('latlong 4096x2048 to angular 4096', 'the panorama to an angular map of 4096', 'pfspanoramic', '`commands.py PROBE --only angular`'),
        with_levels(LEVELS, 'mip levels of the panorama', 'maketx', "`commands.py PROBE --only 'levels of latlong'`"),
        with_levels(CUBE_LEVELS, 'mip levels of a cube of 1024', 'exrenvmap', "`commands.py PROBE --only 'levels of cube'`"),
        ['diffuse map of 64 from a cube of 256', f"{d['seconds']:.2g} s, largest {percent(d['largest_error'])}",
         f"`{d['peer']['tool']}` {d['peer']['seconds']:.2g} s, largest {percent(d['peer']['largest_error'])}", '`prefilter --size 64 --max-error 1e-4`']]
    c = f['conversions']
    return (f"Each row is a job: time and error. `x` is a multiple of the time in which `oiiotool` reads and writes the same files without other\n"
            f"work. The last row is in seconds, on another machine. [What the errors mean](docs/reference/which-when.md#what-the-errors-mean).\n\n"
            + markdown(['job', 'envmap', 'other tool', 'measured by'], rows)
            + f"\n\nMap: {c['source']}. Machine: {measured(c)}. Last row: {measured(d)}.")


def conversion(f):
    rows = []
    for tool, words in (('envmap', '`envmap convert`'), ('envmap, `--filter bilinear`', '`envmap convert --filter bilinear`'),
                        ('exrenvmap', '`exrenvmap`'), ('copy', '`oiiotool` copy')):
        r = next(r for r in rows_of(f, CUBE) if r['tool'] == tool or r['tool'].startswith(tool + ' '))
        rows.append([words, times(r['copies']), percent(r['rms']) if 'rms' in r else '-', f"{r['memory']:.2g} x"])
    return markdown(['command', 'time', 'rms error', 'peak memory, by the float image'], rows)


def mip_levels(f):
    rows = []
    for job, words in ((LEVELS, '4096x2048 panorama'), (CUBE_LEVELS, 'cube of 1024'), ('levels of angular 4096', 'angular map of 4096')):
        others = [r for r in rows_of(f, job) if r['tool'] in ('maketx', 'exrenvmap')]
        rows.append([words, times(row(f, job, 'envmap')['copies']), ', '.join(f"`{r['tool']}` {times(r['copies'])}" for r in others) or '-'])
    return markdown(['job', 'envmap', 'other tool'], rows)


def bench(f):
    rows = []
    for job in f['conversions']['jobs']:
        for k, r in enumerate(job['rows']):
            rows.append(['' if k else job['job'], r['tool'], f"{r['copies']:.3g}", f"{r['memory']:.3g}" if 'memory' in r else '',
                         *(f'{r[key]:.1e}' if key in r else '' for key in ('rms', 'max'))])
    return f"{f['conversions']['source']}; {measured(f['conversions'])}.\n\n" + markdown(['job', 'tool', 'copies', 'memory', 'rms', 'max'], rows)


def cost(f):
    c = f['commands']
    lines = ['.TS', 'lB2 ' * len(c['sizes']) + 'lB', 'l2 ' * len(c['sizes']) + 'l.', '\t'.join(['job', *c['sizes']])]
    for r in c['rows']:
        lines.append('\t'.join([r['job'], *(f"{cell['seconds']:.2g} s, {cell['megabytes']:.0f} MB" for cell in r['cells'])]))
    return '\n'.join([f"Processor time and peak memory of whole commands: {measured(c)}. The source is {c['source']}.", '.PP', *lines, '.TE', '.PP',
                      f"There \\fBoiiotool\\fR copies the 4096x2048 map in {c['copy_seconds']:g} s of processor time."]).replace('half-float', 'half\\-float')


def start(f):
    s = f['start']
    return (f"A start takes {1000 * s['seconds']:.0f} ms. Reading a format of \\fIenvmap\\-formats.so\\fR (HEIF, TGA, rare TIFF) adds "
            f"{s['module_seconds']:g} s.")


TABLES = {'README.md': (benefits, comparisons), 'docs/explanation/performance.md': (conversion, mip_levels),
          'tests/bench/README.md': (bench,), 'man/envmap-cost.7': (cost, start)}


# ---- pages -------------------------------------------------------------------------------------------------------------

def filled(page, text, tables, figures):
    """@return the page's text with its tables. @throws ValueError if one has no place there."""
    opening, closing = (r'\.\\" figures: {}\n', r'\.\\" figures end\n') if page.endswith('.7') else ('<!-- figures: {} -->\n', '<!-- figures end -->\n')
    for table in tables:
        between = re.compile(f'({opening.format(table.__name__)})(.*?)({closing})', re.S)
        if len(between.findall(text)) != 1:
            raise ValueError(f'{page}: no place, or several, for the figures of {table.__name__}')
        text = between.sub(lambda m: m[1] + table(figures) + '\n' + m[3], text)
    return text


def main():
    root, check = pathlib.Path(sys.argv[1]), '--check' in sys.argv
    figures, wrong = load(root), []
    for page, tables in TABLES.items():
        text = (root / page).read_text()
        new = filled(page, text, tables, figures)
        if check and new != text:
            wrong.append(f'{page}: differs from {FILE}: run python3 tests/bench/figures.py .')
        elif new != text:
            (root / page).write_text(new)
    if check:  # The test is able to fail.
        figures['start']['seconds'] *= 2
        page = 'man/envmap-cost.7'
        if filled(page, (root / page).read_text(), TABLES[page], figures) == (root / page).read_text():
            wrong.append('another figure was not seen')
    print('\n'.join(wrong) or f'{len(TABLES)} pages agree with {FILE}')
    return 1 if wrong else 0


if __name__ == '__main__':
    sys.exit(main())

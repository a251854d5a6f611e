"""Draws the plots of the manual from what `envmap` measures, as SVG.

  figures.py sampling|mipmap|filters|sh OUT.svg [ENVMAP]

sampling: solid angle and anisotropy of texels from the centre of a face to its worst place, by projection.
mipmap:   flux that plain means of four texels (glGenerateMipmap) gain or lose, level by level, under a sky without a sun.
filters:  error of each filter where the texels of a mirror ball grow long: from its middle, where four of them make one of
          the result, to its rim, where one of them spans many.
sh:       what is lost of a sun by spherical harmonics: of its radiance, and of the diffuse light that it makes.
"""
import json
import math
import os
import struct
import subprocess
import sys
import tempfile

PROJECTIONS = ('latlong', 'cube', 'sphere', 'paraboloid', 'angular', 'octahedral', 'equal-area')
# Okabe and Ito (2008), told apart by colour-blind eyes, too; the dashes differ in print.
COLOURS = ('#000000', '#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9')
DASHES = ('', '8 3', '2 3', '8 3 2 3', '12 4', '4 4', '1 2')


class Plot:
    """Curves over one or two panels, each with a logarithmic axis upwards."""
    width, height, left, top, bottom = 420, 330, 62, 40, 46

    def __init__(self, title, panels):
        self.title, self.panels = title, panels  # Panel: title, x axis, range of x, decades of y, {name: [(x, y)]}

    def svg(self):
        names = list(dict.fromkeys(name for panel in self.panels for name in panel[4]))
        whole = self.width * len(self.panels) + 150
        out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{whole}" height="{self.height + 30}" font-family="sans-serif" '
               f'font-size="12" fill="#222"><rect width="100%" height="100%" fill="white"/>'
               f'<text x="14" y="22" font-size="16">{self.title}</text>']
        for k, panel in enumerate(self.panels):
            out += self.panel(self.width * k, names, *panel)
        for k, name in enumerate(names):
            x, y = whole - 140, self.top + 34 + 20 * k
            out.append(f'<path d="M{x} {y - 4}h26" {self.stroke(k)}/><text x="{x + 32}" y="{y}">{name}</text>')
        return '\n'.join(out) + '\n</svg>\n'

    @staticmethod
    def stroke(k):
        return f'fill="none" stroke="{COLOURS[k]}" stroke-width="2" stroke-dasharray="{DASHES[k]}"'

    def panel(self, at, names, title, x_axis, x_range, decades, curves):
        x0, x1, y0, y1 = at + self.left, at + self.width - 16, self.height - self.bottom + 26, self.top + 22
        x_of = lambda x: x0 + (x - x_range[0]) / (x_range[1] - x_range[0]) * (x1 - x0)
        y_of = lambda y: y0 + (math.log10(y) - decades[0]) / (decades[1] - decades[0]) * (y1 - y0)
        out = [f'<text x="{x0}" y="{y1 - 8}">{title}</text>',
               f'<text x="{(x0 + x1) / 2}" y="{y0 + 34}" text-anchor="middle">{x_axis}</text>']
        for d in range(decades[0], decades[1] + 1):
            y = y_of(10.0 ** d)
            out.append(f'<path d="M{x0} {y:.1f}H{x1}" stroke="#ddd"/><text x="{x0 - 6}" y="{y + 4:.1f}" text-anchor="end">{10.0 ** d:g}</text>')
        for k in range(5):
            x = x_range[0] + k / 4 * (x_range[1] - x_range[0])
            out.append(f'<text x="{x_of(x):.1f}" y="{y0 + 16}" text-anchor="middle">{x:g}</text>')
        for name, points in curves.items():
            inside = [(x, min(max(y, 10.0 ** decades[0]), 10.0 ** decades[1])) for x, y in points]
            path = ' '.join(f'{"ML"[n > 0]}{x_of(x):.1f} {y_of(y):.1f}' for n, (x, y) in enumerate(inside))
            out.append(f'<path d="{path}" {self.stroke(names.index(name))}><title>{name}</title></path>')
        return out


def sampling(run):
    solid, stretched = {}, {}
    for p in PROJECTIONS:
        run('generate', 'constant', 'map.exr', '--to', p, '--size', '128')
        rows = json.loads(run('info', 'map.exr', '--sampling', '--json'))['sampling']
        last = rows[-1]['degrees']
        whole = rows[:-1] if p in ('sphere', 'angular') else rows  # The last texel of a disc is cut by the rim.
        solid[p] = [(row['degrees'] / last, row['relative']) for row in whole]
        stretched[p] = [(row['degrees'] / last, row['anisotropy']) for row in rows]
    where = 'from the centre (0) to pole, corner or rim (1)'
    return Plot('How evenly texels sample the sphere', [('solid angle of a texel over the mean', where, (0, 1), (-2, 1), solid),
                                                        ('longest over shortest side on the sphere', where, (0, 1), (0, 3), stretched)])


def mipmap(run):
    panels = {}
    for p in ('latlong', 'cube', 'paraboloid', 'octahedral', 'equal-area'):
        run('generate', 'sky', 'sky.exr', '--to', p, '--size', '256')
        run('mipmap', 'sky.exr', 'levels.exr', '--weights', 'uniform', '-q')
        table = json.loads(run('info', 'levels.exr', '--levels', '--json'))['level_table']
        panels[p] = [(k, max(max(map(abs, row['flux_difference'])), 1e-9)) for k, row in enumerate(table[:9])]
    return Plot('Plain mip levels change the light', [('largest change of flux of a channel', 'level', (0, 8), (-6, 0), panels)])


def read_pfm(path):
    """@return rows of red, from the top."""
    with open(path, 'rb') as file:
        wide, high = map(int, (file.readline(), file.readline())[1].split())
        order = '<' if float(file.readline()) < 0 else '>'
        numbers = struct.unpack(f'{order}{3 * wide * high}f', file.read())
    return [numbers[3 * wide * j:3 * wide * (j + 1):3] for j in reversed(range(high))]


def filters(run):
    high, rings = 64, 18
    run('generate', 'checker', 'ball.exr', '--to', 'sphere', '--size', '256', '--squares', '32')

    def converted(*words):
        run('convert', 'ball.exr', 'made.pfm', '--to', 'latlong', '--size', str(high), '-q', *words)
        return read_pfm(os.path.join(run.folder, 'made.pfm'))

    right = converted('--filter', 'area', '--area-error', '1e-5')
    curves = {}
    for words in ('nearest', 'bilinear', 'bicubic', 'trilinear', 'sat', 'ewa', 'bilinear --samples 4'):
        lost, all_of_it = [0] * rings, [0] * rings
        for j, (row, truth) in enumerate(zip(converted('--filter', *words.split()), right)):
            up = math.pi * (0.5 - (j + 0.5) / high)
            for i, (a, b) in enumerate(zip(row, truth)):
                z = math.cos(math.pi * (2 * i + 1) / (2 * high) - math.pi) * math.cos(up)
                ring = min(int(math.acos(z) / math.pi * rings), rings - 1)
                lost[ring] += math.cos(up) * (a - b) ** 2
                all_of_it[ring] += math.cos(up) * b * b
        curves['bilinear, 4 x 4' if 'samples' in words else words] = [((k + 0.5) * 180 / rings, math.sqrt(a / b)) for k, (a, b) in enumerate(zip(lost, all_of_it))]
    return Plot('Filters where texels grow long', [('rms error of a ring about +Z', 'degrees from +Z, the middle of the ball; -Z is its rim', (0, 180),
                                                    (-3, 0), curves)])


def sh(run):
    orders = (0, 1, 2, 3, 4, 6, 8, 12)
    radiance, diffuse = {}, {}
    for radius in (45, 20, 10, 5):
        name = f'sun of {radius} degrees'
        run('generate', 'sun', 'sun.exr', '--size', '64', '--radius', str(radius), '--direction', '1,2,3')
        run('prefilter', 'sun.exr', 'diffuse.exr', '--size', '16', '--method', 'exact', '--scale', str(math.pi), '-q')
        radiance[name], diffuse[name] = [], []
        for order in orders:
            run('sh', 'sun.exr', '--order', str(order), '--evaluate', 'series.exr', '--to', 'latlong', '--size', '64')
            radiance[name].append((order, json.loads(run('compare', 'series.exr', 'sun.exr', '--json'))['rms']))
            run('sh', 'sun.exr', '--order', str(order), '--irradiance', '--evaluate', 'series.exr', '--to', 'cube', '--size', '16')
            diffuse[name].append((order, json.loads(run('compare', 'series.exr', 'diffuse.exr', '--json'))['rms']))
    return Plot('Suns by spherical harmonics', [('rms error of radiance', 'largest degree l', (0, 12), (-1, 0), radiance),
                                                ('rms error of diffuse light', 'largest degree l', (0, 12), (-4, 0), diffuse)])


def main():
    kind, path = sys.argv[1:3]
    envmap = sys.argv[3] if len(sys.argv) > 3 else 'envmap'
    with tempfile.TemporaryDirectory() as folder:
        def run(*words):
            return subprocess.run([envmap, *words], cwd=folder, check=True, capture_output=True, text=True).stdout

        run.folder = folder
        text = {'sampling': sampling, 'mipmap': mipmap, 'filters': filters, 'sh': sh}[kind](run).svg()
    with open(path, 'w') as file:
        file.write(text)


main()

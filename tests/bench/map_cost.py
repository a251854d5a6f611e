#!/usr/bin/env python3
"""Draws the tables and the plot of docs/explanation/dynamic-maps.md from runs of map_bench:

    python3 tests/bench/map_cost.py docs/explanation/dynamic-maps.md tests/bench/runs/*.csv

The tables replace what stands between the two marks of the page."""
import math
import os
import sys

BEGIN, END = "<!-- tables of tests/bench/map_cost.py -->", "<!-- end of tables -->"
WAYS = [("cube", "distort", "cube, six passes"), ("cube", "exact", "cube, `exact`"),
        ("sphere", "exact", "sphere, `exact`"), ("sphere", "distort", "sphere, `distort`"),
        ("sphere", "tessellate", "sphere, `tessellate`"),
        ("paraboloid", "exact", "two paraboloids, `exact`"), ("paraboloid", "distort", "two paraboloids, `distort`"),
        ("paraboloid", "tessellate", "two paraboloids, `tessellate`"),
        ("sphere", "resample", "sphere from a cube, `resample`"),
        ("sphere", "raycast", "sphere, `raycast`"), ("paraboloid", "raycast", "two paraboloids, `raycast`"),
        ("cube", "raycast", "cube, `raycast`")]
FRAME = 1 / 60


class Run:
    def __init__(self, path):
        lines = open(path).read().splitlines()
        about = [line[2:] for line in lines if line.startswith("#")]
        self.name = os.path.splitext(os.path.basename(path))[0]
        self.renderer, self.opened, self.clock = about[0], about[1], about[2].removeprefix("seconds of ")
        self.rows = {}
        for line in lines:
            if line[0].isdigit():
                count, to, method, size, draw, whole, wrong, chosen = line.split(",")
                self.rows[to, method, int(count), int(size)] = (float(draw), float(whole), float(wrong), chosen == "1")
        self.counts = sorted({key[2] for key in self.rows})
        self.sizes = sorted({key[3] for key in self.rows})

    def cell(self, way, count, size, show):
        row = self.rows.get((way[0], way[1], count, size))
        return "-" if row is None else show(row)


def digits(x):
    return f"{x:.0f}" if x >= 100 else f"{x:.{max(0, 1 - math.floor(math.log10(x)))}f}" if x > 0 else "0"


def table(head, rows):
    return "\n".join("| " + " | ".join(row) + " |" for row in [head, ["---"] * len(head), *rows]) + "\n"


def by_triangles(run, show, ways=WAYS, size=512):
    return table(["map"] + [f"{n:,}" for n in run.counts],
                 [[way[2]] + [run.cell(way, n, size, show) for n in run.counts] for way in ways])


def by_size(run, show, count):
    return table(["map"] + [str(n) for n in run.sizes],
                 [[way[2]] + [run.cell(way, count, n, show) for n in run.sizes] for way in WAYS])


def automatic(run):
    """How much longer the method of `auto` takes than the best that is exact, as factors, worst first."""
    cases = {}
    for (to, method, count, size), row in run.rows.items():
        name = "resample" if (to, method) == ("cube", "distort") else method
        if name in ("exact", "resample", "raycast"):
            cases.setdefault((to, count, size), {})[name] = row
    factors = []
    for key, ways in cases.items():
        best = min(ways, key=lambda way: ways[way][1])
        # Of a cube, which the program calls resampled, no row says that it was chosen.
        chosen = next((way for way, row in ways.items() if row[3]), "resample")
        factors.append((ways[chosen][1] / ways[best][1], *key, chosen, best))
    return sorted(factors, reverse=True)


def plot(runs, path):
    """Milliseconds by triangles at 512, logarithmic: a panel a run."""
    ways = [(WAYS[0], "#0072b2"), (WAYS[2], "#d55e00"), (WAYS[5], "#009e73"), (WAYS[7], "#cc79a7"),
            (WAYS[9], "#555555")]
    wide, high, left, top = 300, 240, 60, 30
    least, most = -4.5, 1
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{len(runs) * (wide + 70) + 20}" height="{high + 90}" '
           'font-family="sans-serif" font-size="11"><rect width="100%" height="100%" fill="white"/>']
    for k, run in enumerate(runs):
        x0 = left + k * (wide + 70)
        at = lambda n, s: (x0 + wide * (math.log10(n) - 2) / 4, top + high * (most - math.log10(s)) / (most - least))
        out.append(f'<rect x="{x0}" y="{top}" width="{wide}" height="{high}" fill="none" stroke="#999"/>'
                   f'<text x="{x0}" y="{top - 8}">{run.renderer.split(", OpenGL")[0]}</text>')
        for power in range(-4, 1):
            y = at(100, 10.0 ** power)[1]
            out.append(f'<path d="M{x0} {y:.1f}h{wide}" stroke="#ddd"/><text x="{x0 - 4}" y="{y + 4:.1f}" '
                       f'text-anchor="end">{10.0 ** (power + 3):g} ms</text>')
        for power in range(2, 7):
            out.append(f'<text x="{at(10 ** power, 1)[0]:.1f}" y="{top + high + 14}" text-anchor="middle">'
                       f'{10 ** power:,}</text>')
        for way, colour in ways:
            keys = [(way[0], way[1], n, 512) for n in run.counts]
            points = [at(key[2], run.rows[key][0]) for key in keys if key in run.rows]
            out.append(f'<path d="M{"L".join(f"{x:.1f} {y:.1f}" for x, y in points)}" fill="none" stroke="{colour}" '
                       'stroke-width="2"/>')
    for k, (way, colour) in enumerate(ways):
        out.append(f'<text x="{left + 150 * (k % 4)}" y="{top + high + 34 + 16 * (k // 4)}" fill="{colour}">'
                   f'{way[2].replace("`", "")}</text>')
    open(path, "w").write("\n".join(out) + "\n</svg>\n")


def text_of(run):
    ms = lambda row: digits(1e3 * row[0])
    middle = min(run.counts, key=lambda n: abs(math.log(n / 1e4)))
    drawn = [WAYS[k] for k in (0, 2, 5, 7, 9)]
    factors = automatic(run)
    near = sum(f[0] <= 1.2 for f in factors)
    out = [f"## {run.renderer}\n", f"Context {run.opened}. Times are {run.clock}.\n",
           "Milliseconds per map of 512 by triangles, map left where it was drawn:\n", by_triangles(run, ms),
           f"Milliseconds per map of {middle:,} triangles by size:\n", by_size(run, ms, middle),
           "Milliseconds until a map of 512 is in memory with distances, and for `raycast` with the tree:\n",
           by_triangles(run, lambda row: digits(1e3 * row[1])),
           "Maps of 256 in a frame of 1/60 s:\n",
           by_triangles(run, lambda row: f"{int(FRAME / max(row[0], 1e-9))}", drawn, 256),
           "Texels of a map of 512 with another surface than `raycast`, or a distance off by over 1%, in percent:\n",
           by_triangles(run, lambda row: f"{row[2]:.3g}", [w for w in WAYS if w[1] != "raycast"]),
           f"`auto` takes at most 20% longer than the best method in {near} of {len(factors)} cases. The worst:\n",
           table(["map", "triangles", "size", "`auto`", "best", "factor"],
                 [[to, f"{count:,}", str(size), chosen, best, f"{f:.2f}"]
                  for f, to, count, size, chosen, best in factors[:4]])]
    return "\n".join(out)


def main():
    page, runs = sys.argv[1], [Run(path) for path in sys.argv[2:]]
    image = os.path.splitext(page)[0] + ".svg"
    plot(runs, image)
    text = open(page).read()
    before, after = text.split(BEGIN)[0], text.split(END)[1]
    tables = f"![Milliseconds by triangles]({os.path.basename(image)})\n\n" + "\n".join(text_of(run) for run in runs)
    open(page, "w").write(f"{before}{BEGIN}\n\n{tables}\n{END}{after}")


main()

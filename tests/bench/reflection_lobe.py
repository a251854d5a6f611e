"""The lobe that envmap_lobe() of src/envmap/engine/shaders/envmap.glsl looks up, beside others and beside the integral of the BRDF.

  reflection_lobe.py          prints the tables of docs/explanation/rough-reflections.md, in some minutes
  reflection_lobe.py --fit    finds the constants of envmap_lobe()

The truth is GGX with Smith's height-correlated masking and Schlick's Fresnel term (glTF 2.0, appendix B), integrated over the disc of a
sun. The split sum is the integral of a level's lobe over the disc, times the albedo. The mirrored direction passes the middle of the sun by
up to a diameter of the sun, or by 3 r^2 radians at roughness r if that is more, along the plane of view and across it. The error is the
rms over these passes, over the rms of the truth. Levels are taken at their very roughness: mixing two adds its own error. Wants numpy.
"""
import sys

import numpy as np
from numpy import arccos, arctan2, clip, cos, maximum, minimum, pi, sin, sqrt

SUNS, ROUGHNESSES, VIEWS = (1, 5, 20), (0.1, 0.3, 0.5, 0.8, 1), (0, 30, 60, 75, 85)
MATERIALS = {'metal': 1, 'dielectric': 0.04}  # Reflectance along the normal.
CONSTANTS = (0.16, 0.3, 2)  # Of envmap_lobe(), rounded from what fit() finds.


# ---- what is looked up: of the normal (0) and the mirrored direction (1) the place t, and the roughness of the level ----

def mirrored(n_v, roughness, edge):
    return np.ones_like(roughness), roughness


def frostbite(n_v, roughness, edge):
    """Lagarde and de Rousiers 2014, "Moving Frostbite to physically based rendering", getSpecularDominantDir()."""
    smooth = 1 - roughness**2
    return smooth * (sqrt(smooth) + roughness**2), roughness


def filament(n_v, roughness, edge):
    """Filament's shader getReflectedVector()."""
    return 1 - roughness**4, roughness


def corrected(n_v, roughness, edge, constants=CONSTANTS):
    """envmap_lobe()."""
    wide, narrow, power = constants
    alpha = roughness**2
    narrower = (1 - n_v) * (narrow * (1 - alpha) + alpha * edge)
    return 1 - alpha**2 * (1 - edge)**power, clip(roughness * (1 + wide * alpha) * (1 - narrower), 1e-3, 1)


# ---- the truth ----------------------------------------------------------------------------------------------------------

def lambda_of(cosine, a2):
    return 0.5 * (sqrt(1 + a2 * maximum(0, 1 / cosine**2 - 1)) - 1)


def brdf(v, l, alpha):
    """BRDF times cosine for reflectances 0 and 1 along the normal, which is z; all others lie between."""
    n_l, n_v, a2 = l[:, 2], v[2], alpha * alpha
    h = l + v
    h /= np.linalg.norm(h, axis=1, keepdims=True)
    q = a2 * h[:, 2]**2 + h[:, 0]**2 + h[:, 1]**2
    lit = n_l > 0
    value = np.where(lit, a2 / (pi * q * q) / (1 + lambda_of(np.where(lit, n_l, 1), a2) + lambda_of(n_v, a2)) / (4 * n_v), 0)
    return np.stack([value * (1 - h @ v)**5, value])


def over_disc(v, sun, radius, alpha):
    rings = int(min(300, max(24, 8 * radius / alpha)))
    polar, turn = radius * (np.arange(rings) + 0.5) / rings, pi * (np.arange(2 * rings) + 0.5) / rings
    side = np.cross([0, 1, 0], sun)
    side /= np.linalg.norm(side)
    p, t = (x.ravel() for x in np.meshgrid(polar, turn, indexing='ij'))
    l = np.outer(cos(p), sun) + np.outer(sin(p) * cos(t), side) + np.outer(sin(p) * sin(t), np.cross(sun, side))
    return brdf(v, l, alpha) @ (sin(p) * radius / rings * pi / rings)


def albedo(n_v, alpha, steps=400, azimuths=200):
    """For reflectances 0 and 1, by half vectors."""
    t, a2 = (np.arange(steps) + 0.5) / steps, alpha * alpha
    h = sqrt(t**3 / (1 + (a2 - 1) * (1 - t**3)))[:, None]
    v_h = sqrt(1 - n_v * n_v) * sqrt(1 - h * h) * cos(pi * (np.arange(azimuths) + 0.5) / azimuths) + n_v * h
    n_l = 2 * v_h * h - n_v
    lit = n_l > 0
    value = np.where(lit, 3 * t[:, None]**2 * v_h / (n_v * h * (1 + lambda_of(n_v, a2) + lambda_of(np.where(lit, n_l, 1), a2))), 0)
    return np.array([(value * (1 - v_h)**5).mean(), value.mean()])


# ---- the split sum ------------------------------------------------------------------------------------------------------

def level_over_disc(alpha, off, radius):
    """The integral of Ggx of src/envmap/prefilter/lobe_formulas.h over discs whose middles are `off` from its own, row by row."""
    node, weight = np.polynomial.legendre.leggauss(24)
    a, b = 2 * alpha**2, (1 - alpha) * (1 + alpha)
    t = maximum(1e-9, b / a)
    scale = a * a / (2 * pi * np.where(t < 1e-3, 0.5 - t / 3, (t - np.log1p(t)) / t**2))
    a, b, scale, alpha, radius = (np.broadcast_to(x[:, None], off.shape) for x in (a, b, scale, alpha, radius))
    low, high = maximum(0, off - radius), minimum(pi / 2, off + radius)
    cuts = np.stack([low, abs(radius - off), 0.5 * alpha, 2 * alpha, 8 * alpha, high])
    cuts = np.sort(clip(cuts, low, maximum(low, high)), axis=0)
    total = np.zeros_like(off)
    for first, last in zip(cuts, cuts[1:]):
        half, turn = 0.5 * (last - first)[..., None], pi * (node + 1) / 2
        angle = 0.5 * (first + last)[..., None] - half * cos(turn)
        inside = (cos(radius)[..., None] - cos(angle) * cos(off)[..., None]) / maximum(1e-300, sin(angle) * sin(off)[..., None])
        x = 2 * sin(angle / 2)**2
        lobe = scale[..., None] * maximum(0, 1 - x) / (a[..., None] + b[..., None] * x)**2
        total += (lobe * 2 * sin(angle) * arccos(clip(inside, -1, 1)) * half * pi / 2 * sin(turn) * weight).sum(-1)
    return total


class Cases:
    """Suns, roughnesses and views in the order of the tables."""

    def __init__(self, suns, roughnesses, views):
        cases = [(s, r, max(v, 1e-3)) for s in suns for r in roughnesses for v in views]
        sun, self.roughness, view = (np.array(x, float) for x in zip(*cases))
        self.radius, self.view = np.radians(sun / 2), np.radians(view)
        self.suns, self.truth, self.albedo = [], [], []
        for radius, roughness, view in zip(self.radius, self.roughness, self.view):
            alpha, v, r = roughness**2, np.array([sin(view), 0, cos(view)]), np.array([-sin(view), 0, cos(view)])
            step, across = max(0.75 * alpha, radius / 2), np.array([0, 1, 0])
            passes = [cos(k * step) * r + sin(k * step) * d for d in (np.cross(across, r), across) for k in range(-4, 5)]
            self.suns.append(passes)
            self.truth.append([over_disc(v, s, radius, alpha) for s in passes])
            self.albedo.append(albedo(cos(view), alpha))
        self.suns, self.truth, self.albedo = (np.array(x) for x in (self.suns, self.truth, self.albedo))

    def errors(self, lookup, f0):
        of_edge, of_all = self.albedo.T
        whole = f0 * (of_all - of_edge) + of_edge
        t, roughness = lookup(cos(self.view), self.roughness, of_edge / whole)
        axis = np.stack([-t * sin(self.view), 0 * t, 1 - t + t * cos(self.view)], -1)
        axis = (axis / np.linalg.norm(axis, axis=1, keepdims=True))[:, None, :]
        off = arctan2(np.linalg.norm(np.cross(self.suns, axis), axis=-1), (self.suns * axis).sum(-1))
        found = whole[:, None] * level_over_disc(maximum(1e-6, roughness**2), off, self.radius)
        truth = f0 * (self.truth[..., 1] - self.truth[..., 0]) + self.truth[..., 0]
        return sqrt(((found - truth)**2).sum(1) / (truth**2).sum(1))


# ---- tables and constants ----------------------------------------------------------------------------------------------

def short(x):
    return f'{x:.3f}'.lstrip('0') if x < 1 else f'{x:.2f}'


def tables():
    cases = Cases(SUNS, ROUGHNESSES, VIEWS)
    for material, f0 in MATERIALS.items():
        before, after = (cases.errors(lookup, f0).reshape(-1, len(VIEWS)) for lookup in (mirrored, corrected))
        print(f'| {material}, sun | roughness | ' + ' | '.join(f'{v} degrees' for v in VIEWS) + ' |\n|' + '---|' * (2 + len(VIEWS)))
        rows = [(s, r) for s in SUNS for r in ROUGHNESSES]
        for (sun, roughness), old, new in zip(rows, before, after):
            print(f'| {sun} degree{"s" if sun > 1 else ""} | {roughness} | ' +
                  ' | '.join(f'{short(a)} / {short(b)}' for a, b in zip(old, new)) + ' |')
        print()
    print('| looked up | rms, metal | worst, metal | rms, dielectric | worst, dielectric |\n|---|---|---|---|---|')
    for name, lookup in (('mirrored direction', mirrored), ("Frostbite's direction", frostbite), ("Filament's direction", filament),
                         ('`envmap_lobe()`', corrected)):
        errors = [cases.errors(lookup, f0) for f0 in MATERIALS.values()]
        print(f'| {name} | ' + ' | '.join(f'{short(sqrt((e**2).mean()))} | {short(e.max())}' for e in errors) + ' |')


def fit():
    """Levenberg's and Marquardt's steps over other views and roughnesses than those of the tables. What is worse than the mirrored
    direction counts three times."""
    cases = Cases(SUNS, (0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 1), (0, 20, 40, 55, 65, 75, 82, 86))
    reflectances = (1, 0.5, 0.04)
    before = [cases.errors(mirrored, f0) for f0 in reflectances]

    def residuals(p):
        after = [cases.errors(lambda *a: corrected(*a, constants=p), f0) for f0 in reflectances]
        return np.concatenate(after + [2 * maximum(0, a - b) for a, b in zip(after, before)])
    p, damping = np.array([0.1, 0.2, 1]), 0.1
    now = residuals(p)
    for _ in range(12):
        slopes = np.stack([(residuals(p + h) - now) / 1e-3 for h in 1e-3 * np.eye(3)], 1)
        square = slopes.T @ slopes
        step = np.linalg.solve(square + damping * np.diag(np.diag(square)), -slopes.T @ now)
        after = residuals(p + step)
        if (after**2).sum() < (now**2).sum():
            p, now, damping = p + step, after, damping / 4
        else:
            damping *= 8
        print(np.round(p, 3), f'mean square {(now**2).mean():.4f}')


if __name__ == '__main__':
    fit() if sys.argv[1:] == ['--fit'] else tables()

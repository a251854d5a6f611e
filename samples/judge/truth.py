"""Right answers in float64, by sums over points, from formulae of their own: nothing of envmap is used.

A source is a latlong image of H x 2H x K numbers: K maps at once. Directions: +Y up, +Z in the middle, u to the right, v down.
"""
import numpy as np


def latlong_place(d):
    """@return u, v of directions (..., 3)."""
    x, y, z = d[..., 0], d[..., 1], d[..., 2]
    return 0.5 - np.arctan2(x, z) / (2 * np.pi), 0.5 - np.arctan2(y, np.hypot(x, z)) / np.pi


def latlong_direction(u, v):
    turn, up = (0.5 - u) * 2 * np.pi, (0.5 - v) * np.pi
    return np.stack([np.sin(turn) * np.cos(up), np.sin(up), np.cos(turn) * np.cos(up)], -1)


def cube_direction(face, u, v):
    """Faces +X -X +Y -Y +Z -Z as OpenEXR has them, seen from inside. @return unit vectors, steradians per du dv."""
    s, t, one = 2 * u - 1, 1 - 2 * v, np.ones_like(u)
    d = np.stack([(one, t, s), (-one, t, -s), (s, one, t), (s, -one, -t), (-s, t, one), (s, t, -one)][face], -1)
    square = 1 + s * s + t * t
    return d / np.sqrt(square)[..., None], 4 * square ** -1.5


def angular_direction(_, u, v):
    s, t = 2 * u - 1, 1 - 2 * v
    r = np.hypot(s, t)
    k = np.pi * np.sinc(r)
    density = np.where(r < 1, 4 * np.pi ** 2 * np.sinc(r), 0)
    return np.stack([-s * k, t * k, np.cos(np.pi * r)], -1), density


def lookup(source, d, lies):
    """Bilinear and seamless. lies: where samples do: in texels' 'centre', on the image's 'border' (OpenEXR's envmap attribute),
    or sample i at i / width ('corner')."""
    high, wide = source.shape[:2]
    u, v = latlong_place(d)
    border, shift = lies == 'border', 0.5 if lies == 'centre' else 0
    x, y = u * (wide - border) - shift, v * (high - border) - shift
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    a, b = (x - i)[..., None], (y - j)[..., None]

    def texel(i, j):
        if border:
            return source[np.clip(j, 0, high - 1), np.clip(i, 0, wide - 1)]
        over = (j < 0) | (j >= high)  # On over the pole: the other half of the same row.
        return source[np.clip(j, 0, high - 1), (i + np.where(over, wide // 2, 0)) % wide]

    return (1 - b) * ((1 - a) * texel(i, j) + a * texel(i + 1, j)) + b * ((1 - a) * texel(i, j + 1) + a * texel(i + 1, j + 1))


def over_texel(source, direction, face, lies, centre, step, points):
    """Solid-angle weighted means over texels about centres (N, 2), by points x points each. @return (N, K), (N,)."""
    inside = ((np.arange(points) + 0.5) / points - 0.5) * step
    u = centre[:, 0, None, None] + inside[None, None, :] + 0 * inside[None, :, None]
    v = centre[:, 1, None, None] + inside[None, :, None] + 0 * u
    d, w = direction(face, u, v)
    whole = w.sum((1, 2))
    light = (w[..., None] * lookup(source, d, lies)).sum((1, 2))
    return np.where(whole[:, None] > 0, light / np.maximum(whole, 1e-300)[:, None], 0), whole / points ** 2


def converted(source, direction, faces, size, lies, points=32, at_poles=1024):
    """Means over texels of the reconstructed source, by points x points a texel; more about the poles of the source, where its
    texels are slivers. A sample on the border stands for what is half a step around it. @return (faces, size, size, K), weights."""
    step, shift = (1 / (size - 1), 0) if lies == 'border' else (1 / size, 0.5)
    maps, weights = np.zeros((faces, size, size, source.shape[2])), np.zeros((faces, size, size))
    for face in range(faces):
        for row in range(size):
            centre = np.stack([(np.arange(size) + shift) * step, np.full(size, (row + shift) * step)], -1)
            maps[face, row], weights[face, row] = over_texel(source, direction, face, lies, centre, step, points)
            near = np.abs(direction(face, centre[:, 0], centre[:, 1])[0][:, 1]) > np.cos(2 * np.pi / source.shape[0])
            for k in np.flatnonzero(near & (weights[face, row] > 0)):
                maps[face, row, k] = over_texel(source, direction, face, lies, centre[k:k + 1], step, at_poles)[0][0]
    return maps, weights


def latlong_weights(high, wide):
    """Steradians of texels."""
    edge = np.arange(high + 1) / high * np.pi
    return np.outer(np.cos(edge[:-1]) - np.cos(edge[1:]), np.full(wide, 2 * np.pi / wide))


def level(source, k):
    """Mip level k: solid-angle weighted means of 2^k x 2^k texels. @return maps, weights, as of one face."""
    high, wide, kinds = source.shape
    w, n = latlong_weights(high, wide), 2 ** k
    blocks = lambda a: a.reshape(high // n, n, wide // n, n, -1).sum((1, 3))
    whole = blocks(w[..., None])
    return (blocks(source * w[..., None]) / whole)[None], whole[None, ..., 0]


def blurred(source, at, lobe, points=4):
    """Means of the source, constant over each texel, under lobe(cosine) about directions at (N, 3). @return (N, K)."""
    high, wide, kinds = source.shape
    v = (np.arange(high * points) + 0.5) / (high * points)
    u = (np.arange(wide * points) + 0.5) / (wide * points)
    fine = np.repeat(np.repeat(source, points, 0), points, 1)
    total, whole = np.zeros((len(at), kinds)), np.zeros(len(at))
    edge = np.arange(high * points + 1) / (high * points) * np.pi
    for j in range(high * points):
        d = latlong_direction(u, np.full_like(u, v[j]))
        w = lobe(at @ d.T) * (np.cos(edge[j]) - np.cos(edge[j + 1]))
        total += w @ fine[j]
        whole += w.sum(1)
    return total / whole[:, None]


def diffuse(cosine):
    return np.maximum(cosine, 0)


def ggx(roughness):
    """The half vector's density times n.l, seen along the normal (Karis 2013), alpha = roughness^2 (Walter et al. 2007)."""
    a2 = roughness ** 4

    def lobe(cosine):
        square = 0.5 + 0.5 * cosine  # cos^2 of the half angle.
        return np.maximum(cosine, 0) / (square * (a2 - 1) + 1) ** 2

    return lobe


def errors(found, truth, weights):
    """Of two maps: largest |a-b| / max(|b|, 0.001 x mean of b), sqrt(sum w |a-b|^2 / sum w |b|^2), and what flux is off by."""
    weights = weights / weights.sum()
    mean = (weights * np.abs(truth)).sum()
    off = np.abs(found - truth)
    most = np.max(np.where(weights > 0, off / np.maximum(np.abs(truth), 1e-3 * mean), 0))
    rms = np.sqrt((weights * off ** 2).sum() / (weights * truth ** 2).sum())
    return float(most), float(rms), float((weights * (found - truth)).sum() / (weights * truth).sum())

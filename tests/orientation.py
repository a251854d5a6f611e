#!/usr/bin/env python3
"""Pictures of every format that OpenImageIO writes show the directions where they are: read by readers of this file's
own, or by the programs of libjpeg-turbo and WebP. Without one of them its format is named and the exit status is 77.

  orientation.py ENVMAP
"""
import math
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib

ENVMAP = str(pathlib.Path(sys.argv[1]).resolve())
WIDTH, HEIGHT = 32, 16


def encoded(c):
    return 12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055


def wanted(i, j):
    longitude, latitude = (0.5 - (i + 0.5) / WIDTH) * 2 * math.pi, (0.5 - (j + 0.5) / HEIGHT) * math.pi
    direction = math.cos(latitude) * math.sin(longitude), math.sin(latitude), math.cos(latitude) * math.cos(longitude)
    return tuple(encoded((x + 1) / 2) for x in direction)


def rows_of(data, order=(0, 1, 2)):
    """Rows from the top, of pixels as red, green, blue from 0 to 1."""
    pixels = [tuple(data[3 * k + c] / 255 for c in order) for k in range(WIDTH * HEIGHT)]
    return [pixels[j * WIDTH:(j + 1) * WIDTH] for j in range(HEIGHT)]


def ppm(data):
    kind, width, height, most, pixels = data.split(maxsplit=4)
    assert (kind, int(width), int(height), int(most)) == (b'P6', WIDTH, HEIGHT, 255)
    return rows_of(data[-3 * WIDTH * HEIGHT:])


def bmp(data):
    start, = struct.unpack_from('<I', data, 10)
    width, height, _, bits, compression = struct.unpack_from('<iiHHI', data, 18)
    assert (width, abs(height), bits, compression) == (WIDTH, HEIGHT, 24, 0)
    rows = rows_of(data[start:], (2, 1, 0))  # 96 bytes a row: no padding.
    return rows[::-1] if height > 0 else rows


def tga(data):
    length, kind, width, height, bits, how = data[0], data[2], *struct.unpack_from('<HHBB', data, 12)
    assert (kind, width, height, bits, how & 0x10) == (2, WIDTH, HEIGHT, 24, 0)
    rows = rows_of(data[18 + length:], (2, 1, 0))
    return rows if how & 0x20 else rows[::-1]


def png(data):
    at, packed = 8, b''
    while at < len(data):
        size, = struct.unpack_from('>I', data, at)
        kind, body = data[at + 4:at + 8], data[at + 8:at + 8 + size]
        assert kind != b'IHDR' or struct.unpack('>IIBBBBB', body) == (WIDTH, HEIGHT, 8, 2, 0, 0, 0)
        packed += body if kind == b'IDAT' else b''
        at += 12 + size
    raw, above, out = zlib.decompress(packed), bytes(3 * WIDTH), b''
    for j in range(HEIGHT):
        filter_type, line = raw[j * (3 * WIDTH + 1)], bytearray(raw[j * (3 * WIDTH + 1) + 1:(j + 1) * (3 * WIDTH + 1)])
        for k in range(3 * WIDTH):
            a, b, c = (line[k - 3], above[k], above[k - 3]) if k >= 3 else (0, above[k], 0)
            paeth = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            line[k] = (line[k] + (0, a, b, (a + b) // 2, paeth)[filter_type]) % 256
        above = bytes(line)
        out += above
    return rows_of(out)


def tif(data):
    assert data[:4] == b'II*\0'
    at, = struct.unpack_from('<I', data, 4)
    tags = {}
    for k in range(struct.unpack_from('<H', data, at)[0]):
        tag, kind, count = struct.unpack_from('<HHI', data, at + 2 + 12 * k)
        form = f'<{count}{ {1: "B", 2: "s", 3: "H", 4: "I"}.get(kind, "x") }'
        place = at + 2 + 12 * k + 8
        if struct.calcsize(form) > 4:
            place, = struct.unpack_from('<I', data, place)
        tags[tag] = struct.unpack_from(form, data, place)
    assert (tags[256], tags[257], tags[258], tags.get(274, (1,))) == ((WIDTH,), (HEIGHT,), (8, 8, 8), (1,))
    strips = [data[o:o + n] for o, n in zip(tags[273], tags[279])]
    if tags[259] != (1,):
        assert tags[259] in ((8,), (32946,)), tags[259]
        strips = [zlib.decompress(s) for s in strips]
    out = bytearray(b''.join(strips))
    if tags.get(317) == (2,):
        for k in range(len(out)):
            out[k] = (out[k] + (out[k - 3] if k % (3 * WIDTH) >= 3 else 0)) % 256
    return rows_of(out)


def by_program(*command):
    return lambda data: ppm(subprocess.run(command, input=data, capture_output=True, check=True).stdout)


# Of each: its reader, and how far a colour may be off.
FORMATS = {'ppm': (ppm, 0.005), 'bmp': (bmp, 0.005), 'tga': (tga, 0.005), 'png': (png, 0.005), 'tif': (tif, 0.005),
           'jpg': (by_program('djpeg', '-pnm'), 0.2),
           'webp': (by_program('dwebp', '-quiet', '-ppm', '-o', '-', '--', '-'), 0.2)}
unread = [name for name, program in (('jpg', 'djpeg'), ('webp', 'dwebp')) if not shutil.which(program)]

failed = False
with tempfile.TemporaryDirectory() as folder:
    for name, (reader, most) in FORMATS.items():
        if name in unread:
            continue
        file = pathlib.Path(folder) / f'map.{name}'
        subprocess.run([ENVMAP, 'generate', 'directions', file, '--to', 'latlong', '--size', str(HEIGHT), '--depth', 'uint8'],
                       check=True)
        rows = reader(file.read_bytes())
        off = max(abs(a - b) for j in range(HEIGHT) for i in range(WIDTH) for a, b in zip(rows[j][i], wanted(i, j)))
        print(f'{name}: off by {off:.3f} at most')
        failed = failed or off > most
for name in unread:
    print(f'{name}: no program reads it here')
sys.exit(1 if failed else 77 if unread else 0)

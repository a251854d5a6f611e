#!/usr/bin/env python3
"""JPEG files with a gain map hold the light that they were made of: read by a reader of this file's own (djpeg decodes
the two images; container, metadata and light are worked out here by the formulae of ISO 21496-1), and by the formulae of
three.js' UltraHDRLoader. The errors that the program tells are found again, and limits hold. Without djpeg the exit
status is 77.

  gain_map.py ENVMAP
"""
import json
import math
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

ENVMAP = str(pathlib.Path(sys.argv[1]).resolve())
WIDTH, HEIGHT = 96, 48
HDRGM = '{http://ns.adobe.com/hdr-gain-map/1.0/}'
ITEM = '{http://ns.google.com/photos/1.0/container/item/}'


# ---- the light ------------------------------------------------------------------------------------------------------

def light(i, j):
    """A sky with clouds of grain, a reddish sun of 700, a dark floor and a saturated lamp."""
    grain = ((i * 7919 + j * 104729) % 251) / 251
    if (i - 70) ** 2 + (j - 14) ** 2 <= 2:
        return 700.0, 420.0, 90.0
    if 20 <= i < 26 and 30 <= j < 34:
        return 0.05, 6.0, 0.4
    if j >= HEIGHT // 2:
        return tuple(v * (0.6 + 0.8 * grain) for v in (0.02, 0.015, 0.008))
    glow = 2.5 / (1 + 0.01 * ((i - 70) ** 2 + (j - 14) ** 2))
    return tuple(v * (0.9 + 0.2 * grain) + glow for v in (0.3, 0.45, 0.8))


def single(x):
    return struct.unpack('<f', struct.pack('<f', x))[0]


LIGHT = [[tuple(single(v) for v in light(i, j)) for i in range(WIDTH)] for j in range(HEIGHT)]


def weight(j):
    return math.sin(math.pi * (0.5 - j / HEIGHT)) - math.sin(math.pi * (0.5 - (j + 1) / HEIGHT))


def floor():
    return 0.001 * sum(weight(j) * sum(map(sum, row)) / (3 * WIDTH) for j, row in enumerate(LIGHT)) / 2



def write_pfm(path, rows):
    texels = b''.join(struct.pack('<3f', *c) for row in reversed(rows) for c in row)
    path.write_bytes(b'PF\n%d %d\n-1\n' % (WIDTH, HEIGHT) + texels)


def read_pfm(path):
    head, texels = path.read_bytes().split(b'\n-1', 1)
    assert head == b'PF\n%d %d' % (WIDTH, HEIGHT), head
    v = struct.unpack('<%df' % (3 * WIDTH * HEIGHT), texels[-12 * WIDTH * HEIGHT:])
    rows = [[v[3 * (j * WIDTH + i):][:3] for i in range(WIDTH)] for j in range(HEIGHT)]
    return rows[::-1]


# ---- the file -------------------------------------------------------------------------------------------------------

def segments(data):
    at = 2
    assert data[:2] == b'\xff\xd8'
    while data[at + 1] != 0xda:
        size, = struct.unpack_from('>H', data, at + 2)
        yield data[at + 1], at + 4, data[at + 4:at + 2 + size]
        at += 2 + size


def one(data, marker, mark):
    found = [(at, text[len(mark):]) for kind, at, text in segments(data) if kind == marker and text.startswith(mark)]
    assert len(found) == 1, (mark, len(found))
    return found[0]


def xmp(data):
    return xml.etree.ElementTree.fromstring(one(data, 0xe1, b'http://ns.adobe.com/xap/1.0/\0')[1])


def iso(data):
    return one(data, 0xe2, b'urn:iso:std:iso:ts:21496:-1\0')[1]


def split(data):
    """The two images, by the index of MPF, which XMP has to agree with."""
    at, index = one(data, 0xe2, b'MPF\0')
    at += 4
    assert index[:4] == b'MM\0*'
    directory, = struct.unpack_from('>I', index, 4)
    entries, = struct.unpack_from('>H', index, directory)
    tags = {}
    for k in range(entries):
        tag, kind, count, value = struct.unpack_from('>HHI4s', index, directory + 2 + 12 * k)
        tags[tag] = (kind, count, value)
    assert tags[0xb000] == (7, 4, b'0100') and tags[0xb001] == (4, 1, b'\0\0\0\2') and tags[0xb002][:2] == (7, 32)
    images, = struct.unpack('>I', tags[0xb002][2])
    first = struct.unpack_from('>IIIHH', index, images)
    second = struct.unpack_from('>IIIHH', index, images + 16)
    assert first[2:] == (0, 0, 0) and second[3:] == (0, 0)
    # UltraHDRLoader reads the numbers where they lie from the segment's length on.
    assert images == 50
    picture, gains = data[:first[1]], data[at + second[2]:at + second[2] + second[1]]
    assert picture + gains == data and picture[-2:] == gains[-2:] == b'\xff\xd9' and gains[:2] == b'\xff\xd8'
    items = [dict(e.attrib) for e in xmp(picture).iter() if ITEM + 'Semantic' in e.attrib]
    assert [e[ITEM + 'Semantic'] for e in items] == ['Primary', 'GainMap'], items
    assert {e[ITEM + 'Mime'] for e in items} == {'image/jpeg'} and int(items[1][ITEM + 'Length']) == len(gains)
    described, = [e for e in xmp(picture).iter() if HDRGM + 'Version' in e.attrib]
    assert described.attrib[HDRGM + 'Version'] == '1.0' and iso(picture) == b'\0\0\0\0'
    return picture, gains


def metadata(gains, channels):
    """Of ISO 21496-1, with which XMP has to agree."""
    said = iso(gains)
    minimum, writer, flags = struct.unpack_from('>HHB', said)
    assert (minimum, writer) == (0, 0) and flags == (0xc0 if channels == 3 else 0x40)
    numbers = struct.unpack_from('>%dI' % ((len(said) - 5) // 4), said, 5)
    signed = struct.unpack_from('>%di' % ((len(said) - 5) // 4), said, 5)
    parts = [(signed if k % 10 in (4, 6, 0, 2) else numbers)[k] / numbers[k + 1] for k in range(0, len(numbers), 2)]
    low, high, of = parts[0], parts[1], parts[2:]
    assert len(of) == 5 * channels and all(of[k] == of[k % 5] for k in range(len(of)))
    told, = [e.attrib for e in xmp(gains).iter() if HDRGM + 'GainMapMax' in e.attrib]
    names = 'GainMapMin', 'GainMapMax', 'Gamma', 'OffsetSDR', 'OffsetHDR'
    assert [float(told[HDRGM + n]) for n in names] == of[:5]
    assert (float(told[HDRGM + 'HDRCapacityMin']), float(told[HDRGM + 'HDRCapacityMax'])) == (low, high) == (0, high)
    assert told[HDRGM + 'Version'] == '1.0' and told[HDRGM + 'BaseRenditionIsHDR'] == 'False'
    return dict(zip(('least', 'most', 'gamma', 'below', 'above'), of), headroom=high)


def pixels(data):
    out = subprocess.run(['djpeg', '-pnm'], input=data, stdout=subprocess.PIPE, check=True).stdout
    kind, width, height, most, _ = out.split(maxsplit=4)
    width, height, channels = int(width), int(height), {b'P5': 1, b'P6': 3}[kind]
    v = out[-width * height * channels:]
    return channels, [[v[(j * width + i) * channels:][:channels] for i in range(width)] for j in range(height)]


def decoded(byte):
    v = byte / 255
    return v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4


def between(k, of, size):
    place = min(max((k + 0.5) * size / of - 0.5, 0), size - 1)
    first = int(place)
    return first, min(first + 1, size - 1), place - first


def gain_at(gains, i, j, c):
    j0, j1, v = between(j, HEIGHT, len(gains))
    i0, i1, u = between(i, WIDTH, len(gains[0]))
    c = c if len(gains[0][0]) > 1 else 0
    across = [row[i0][c] * (1 - u) + row[i1][c] * u for row in (gains[j0], gains[j1])]
    return (across[0] * (1 - v) + across[1] * v) / 255


def by_iso(said, byte, gain):
    share = gain ** (1 / said['gamma'])
    stops = said['least'] * (1 - share) + said['most'] * share
    return max((decoded(byte) + said['below']) * 2 ** stops - said['above'], 0)


def by_three(said, byte, gain):
    """UltraHDRLoader of three 0.187: gains multiply what is encoded, with a power that makes up for the curve."""
    stops = said['least'] + (said['most'] - said['least']) * gain ** (1 / said['gamma'])
    part = math.log2(1.8 ** (said['headroom'] * 0.5)) / said['headroom']
    value = (byte + said['below'] * 64) * 2 ** (stops * part) - said['above'] * 64
    if value < 10.31475:
        return max(value * 0.000303527, 0)
    return ((int(value) if value < 1024 else value) * 0.003717127 + 0.0521327014) ** 2.4


# ---- runs -----------------------------------------------------------------------------------------------------------

def errors(rows):
    """Max and rms above and below white."""
    found, least = {True: [], False: []}, floor()
    for is_row, row in zip(LIGHT, rows):
        for wanted, seen in zip(is_row, row):
            found[max(wanted) > 1] += [abs(b - a) / max(a, least) for a, b in zip(wanted, seen)]
    return {side: (max(e), math.sqrt(sum(x * x for x in e) / len(e))) for side, e in found.items()}


def run(folder, *options, status=0):
    command = [ENVMAP, 'convert', 'light.pfm', 'light.jpg', '--gain-map', '--json', *options]
    done = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert done.returncode == status, (options, done.returncode, done.stderr)
    return done


def check(folder, options, channels):
    said = json.loads(run(folder, *options).stdout)['gain_map']
    data = (folder / 'light.jpg').read_bytes()
    assert said['bytes'] == len(data) and said['channels'] == channels
    picture, gains = split(data)
    of = metadata(gains, channels)
    assert of['headroom'] == said['headroom'] and 0 < of['below'] == of['above'] < 1 / 500
    (three, base), (is_of, shares) = pixels(picture), pixels(gains)
    assert (three, is_of) == (3, channels) and (len(base[0]), len(base)) == (WIDTH, HEIGHT)
    assert (len(shares[0]), len(shares)) == (said['width'], said['height'])

    def rows(formula):
        return [[tuple(formula(of, base[j][i][c], gain_at(shares, i, j, c)) for c in range(3)) for i in range(WIDTH)]
                for j in range(HEIGHT)]
    ours = rows(by_iso)
    found = errors(ours)
    for side, name in ((True, 'above_white'), (False, 'below_white')):
        for k, what in enumerate(('max', 'rms')):
            assert abs(found[side][k] - said[name][what]) < 1e-3 * found[side][k] + 1e-6, (options, name, found, said)
    subprocess.run([ENVMAP, 'convert', 'light.jpg', 'back.pfm', '-q'], cwd=folder, check=True)
    for mine, theirs in zip(ours, read_pfm(folder / 'back.pfm')):
        for a, b in zip(mine, theirs):
            assert all(abs(x - y) <= 5e-4 * x + 1e-7 for x, y in zip(a, b)), (options, a, b)
    print(' '.join(options) or '(no limit)', len(data), 'bytes, above white %.3g %.3g, below %.3g %.3g'
          % (found[True] + found[False]))
    return said, found, base, errors(rows(by_three))


def main():
    if not shutil.which('djpeg'):
        print('djpeg is not here (libjpeg-turbo-progs)')
        return 77
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_pfm(folder / 'light.pfm', LIGHT)
        said, found, base, three = check(folder, (), 3)
        assert found[True][1] < 0.06 and found[False][1] < 0.06, found
        # Up to 3/4 of white the picture is the light; highlights are rolled off, not cut.
        for j, i in ((5, 5), (20, 30), (40, 10)):
            for c in range(3):
                assert LIGHT[j][i][c] > 0.75 or abs(decoded(base[j][i][c]) - LIGHT[j][i][c]) < 0.03, (j, i, c)
        assert all(v < 255 for v in base[11][70]) and min(base[14][70]) > 250
        # Known of the loader: below white right to some percent, bright lights up to 21% too bright.
        assert three[True][0] < 0.5 and three[True][1] < 0.15 and three[False][1] < 0.1, three
        _, grey, _, _ = check(folder, ('--gain-map-channels', '1'), 1)
        assert grey[True][1] < 0.5, grey
        for error in (0.5, 0.2):
            _, found, _, _ = check(folder, ('--max-error', str(error)), 3)
            assert max(found[True][0], found[False][0]) <= error, (error, found)
        sizes = []
        for size in (30000, 9000, 3200):
            said, found, _, _ = check(folder, ('--max-bytes', str(size)), 3)
            assert said['bytes'] <= size
            sizes.append((found[True][1] + found[False][1], said['width']))
        assert sizes[0][0] < sizes[1][0] < sizes[2][0] and sizes[2][1] == WIDTH, sizes  # A sun is not spread.
        (folder / 'light.jpg').unlink()
        refused = run(folder, '--max-error', '0.001', status=1)
        assert 'the least error that can be reached is' in refused.stderr and not (folder / 'light.jpg').exists()
        least = float(refused.stderr.split('reached is ')[1].split(',')[0])
        _, found, _, _ = check(folder, ('--max-error', str(least * 1.06)), 3)
        assert max(found[True][0], found[False][0]) > least * 0.9, (least, found)
        refused = run(folder, '--max-bytes', '500', status=1)
        assert 'the smallest file has' in refused.stderr
        refused = run(folder, '--max-error', '0.2', '--max-bytes', '3000', status=1)
        assert 'within this error' in refused.stderr
        # A smooth sky does with a small map of gains.
        for j in range(HEIGHT):
            for i in range(WIDTH):
                LIGHT[j][i] = tuple(single(v * (3 + math.sin(i / 15)) * (1.2 + math.cos(j / 15))) for v in (0.5, 0.6, 0.7))
        write_pfm(folder / 'light.pfm', LIGHT)
        said, _, _, _ = check(folder, ('--max-error', '0.15'), 3)
        assert said['width'] < WIDTH, said
        check(folder, ('--display', 'clip'), 3)
        check(folder, ('--display', 'neutral'), 3)
        for options, output, words in (
                ((), 'light.png', 'a gain map is written to one .jpg file'),
                (('--to', 'cube'), 'light_{face}.jpg', 'a gain map is written to one .jpg file'),
                (('--depth', 'uint8'), 'light.jpg', 'a gain map has no depth'),
                (('--shard', '1/2'), 'light.exr', '--gain-map cannot be used with --shard')):
            done = subprocess.run([ENVMAP, 'convert', 'light.pfm', output, '--gain-map', *options], cwd=folder,
                                  stderr=subprocess.PIPE, text=True)
            assert done.returncode == 2 and words in done.stderr, (options, done)
        # Pictures of other layouts and spaces are light again, too.
        run(folder, '--output-space', 'lin_p3d65', '--to', 'cube', '--layout', 'cross')
        told = json.loads(subprocess.run([ENVMAP, 'info', 'light.jpg', '--json'], cwd=folder, check=True,
                                         stdout=subprocess.PIPE).stdout)
        assert told['projection'] == 'cube' and told['layout'] == 'cross' and 'P3' in str(told['space']), told
    return 0


sys.exit(main())

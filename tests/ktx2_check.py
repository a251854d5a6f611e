#!/usr/bin/env python3
"""Checks KTX2 files against the KTX File Format Specification 2.0 (document revision 4) and the Khronos Data Format
Specification 1.4, with no code of envmap's. Knows the formats that envmap writes; others are refused.

    python3 tests/ktx2_check.py FILE...

One line a fault; exit status 1 where there is any. Zstandard levels are unpacked with the program zstd.
"""
import math
import re
import struct
import subprocess
import sys

IDENTIFIER = b'\xabKTX 20\xbb\r\n\x1a\n'
RED, GREEN, BLUE, ALPHA = 0, 1, 2, 15
EXPONENT, SIGNED, FLOAT = 0x20, 0x40, 0x80
ONE, MINUS_ONE = 0x3f800000, 0xbf800000


def sfloat(bits, *channels):
    """Samples (offset, length, type, lower, upper) of signed floats side by side."""
    return [(k * bits, bits, c | FLOAT | SIGNED, MINUS_ONE, ONE) for k, c in enumerate(channels)]


# VkFormat: name, bytes of a texel or of a block, typeSize, samples. Of ASTC the part that Basis Universal's transcoder reads.
SHARED = [s for c in (RED, GREEN, BLUE) for s in ((9 * c, 9, c, 0, 8448), (27, 5, c | EXPONENT, 15, 31))]
FORMATS = {
    97: ('R16G16B16A16_SFLOAT', 8, 2, sfloat(16, RED, GREEN, BLUE, ALPHA)),
    109: ('R32G32B32A32_SFLOAT', 16, 4, sfloat(32, RED, GREEN, BLUE, ALPHA)),
    123: ('E5B9G9R9_UFLOAT_PACK32', 4, 4, SHARED),
    131: ('BC6H_UFLOAT_BLOCK', 16, 1, [(0, 128, FLOAT, 0, ONE)]),
    1000066000: ('ASTC_4x4_SFLOAT_BLOCK', 16, 1, [(0, 128, FLOAT, 0, ONE)]),
}

# Colour models of blocks; others are RGBSDA, 1: BC6H, and UASTC HDR 4x4 of Basis Universal.
MODELS = {131: 133, 1000066000: 167}

# Khronos Data Format 1.4, colorPrimaries and transferFunction, for what envmap:space says; without it BT.709, linear.
COLOURS = {
    '': (1, 1),
    'sRGB': (1, 2),
    'Rec.2020': (4, 1),
    'XYZ': (5, 1),
    'ACES2065-1': (6, 1),
    'ACEScg': (7, 1),
    'lin_p3d65': (10, 1),
    'display_p3': (10, 2),
}


class File:
    def __init__(self, name):
        self.name, self.faults = name, []
        with open(name, 'rb') as file:
            self.bytes = file.read()

    def expect(self, sound, text):
        if not sound:
            self.faults.append(text)
        return sound

    def part(self, what, offset, size):
        self.expect(offset + size <= len(self.bytes), f'{what}: bytes {offset} to {offset + size} are beyond the end')
        return self.bytes[offset:offset + size]

    def check(self):
        if not self.expect(self.bytes[:12] == IDENTIFIER, 'identifier: not KTX2'):
            return
        if not self.expect(len(self.bytes) >= 80, 'header: cut'):
            return
        (self.format, self.type_size, self.width, self.height, self.depth, self.layers, self.faces, self.levels,
         self.scheme) = struct.unpack_from('<9I', self.bytes, 12)
        self.dfd, self.kvd = struct.unpack_from('<2I', self.bytes, 48), struct.unpack_from('<2I', self.bytes, 56)
        self.sgd = struct.unpack_from('<2Q', self.bytes, 64)
        self.colour = None
        if self.header():
            self.index()
            self.descriptor()
            self.key_values()
            self.mip_levels()

    # ---- section 4: header ----------------------------------------------------------------------------------------

    def header(self):
        if not self.expect(self.format in FORMATS, f'vkFormat: {self.format} is not one that is known here'):
            return False
        self.format_name, self.texel, type_size, self.samples = FORMATS[self.format]
        self.side = 1 if self.format not in MODELS else 4
        self.expect(self.type_size == type_size, f'typeSize: {self.type_size}, not {type_size}')
        self.expect(self.width > 0 and self.height > 0, 'pixelWidth, pixelHeight: 0')
        self.expect(self.depth == 0, 'pixelDepth: not 0 for a 2D texture')
        self.expect(self.layers == 0, 'layerCount: not 0 for what is no array')
        self.expect(self.faces in (1, 6), f'faceCount: {self.faces}')
        self.expect(self.faces == 1 or self.width == self.height, 'a cube map must be square')
        most = int(math.log2(max(self.width, self.height))) + 1
        self.expect(1 <= self.levels <= most, f'levelCount: {self.levels}, at most {most} for {self.width}x{self.height}')
        self.expect(self.scheme in (0, 2), f'supercompressionScheme: {self.scheme}')
        return not self.faults

    def index(self):
        end = 80 + 24 * self.levels
        self.expect(self.dfd[0] == end, f'dfdByteOffset: {self.dfd[0]}, not {end}')
        end += self.dfd[1]
        if self.kvd[1]:
            self.expect(self.kvd[0] == end, f'kvdByteOffset: {self.kvd[0]}, not {end}: no padding is allowed before it')
            end += self.kvd[1]
        else:
            self.expect(self.kvd[0] == 0, 'kvdByteOffset: not 0 without data')
        self.expect(self.sgd == (0, 0), 'sgdByteOffset, sgdByteLength: not 0 for a scheme without global data')
        self.data_start = end

    # ---- section 5: data format descriptor ---------------------------------------------------------------------------

    def descriptor(self):
        data = self.part('data format descriptor', *self.dfd)
        size = 4 + 24 + 16 * len(self.samples)
        if not self.expect(len(data) == size, f'dfdByteLength: {len(data)}, not {size} for {self.format_name}'):
            return
        words = struct.unpack(f'<{len(data) // 4}I', data)
        self.expect(words[0] == size, f'dfdTotalSize: {words[0]}, not {size}')
        self.expect(words[1] == 0, 'vendorId, descriptorType: not those of a basic descriptor block')
        self.expect(words[2] & 0xffff == 2, f'versionNumber: {words[2] & 0xffff}, not 2')
        self.expect(words[2] >> 16 == size - 4, f'descriptorBlockSize: {words[2] >> 16}, not {size - 4}')
        model, primaries, transfer, flags = data[12:16]
        wanted = MODELS.get(self.format, 1)
        self.expect(model == wanted, f'colorModel: {model}, not {wanted}')
        self.colour = primaries, transfer
        self.expect(flags == 0, f'flags: {flags}, not straight alpha')
        self.expect(words[4] == (self.side - 1) * 0x101, 'texelBlockDimension: not that of the format')
        self.expect(data[20:28] == bytes([self.texel] + 7 * [0]), 'bytesPlane: not one plane of the size of a texel')
        for k, (offset, length, channel, lower, upper) in enumerate(self.samples):
            found = struct.unpack_from('<HBBIII', data, 28 + 16 * k)
            wanted = (offset, length - 1, channel, 0, lower, upper)
            self.expect(found == wanted, f'sample {k}: {found}, not {wanted} for {self.format_name}')

    # ---- section 6: key/value data ----------------------------------------------------------------------------------

    def key_values(self):
        data, at, keys, pairs = self.part('key/value data', *self.kvd), 0, [], {}
        while at < len(data):
            if not self.expect(at + 4 <= len(data), 'key/value data: ends in a length'):
                return
            size, = struct.unpack_from('<I', data, at)
            pair = data[at + 4:at + 4 + size]
            padding = data[at + 4 + size:at + 4 + (size + 3) // 4 * 4]
            if not self.expect(size >= 2 and len(pair) == size and b'\0' in pair, f'key/value pair at {at}: cut'):
                return
            self.expect(padding == bytes(-size % 4), f'key/value pair at {at}: padding is not 0')
            key, value = pair.split(b'\0', 1)
            keys.append(key.decode())  # UTF-8, or this fails.
            self.expect(not key.startswith(b'\xef\xbb\xbf'), f'{keys[-1]}: begins with a byte order mark')
            pairs[keys[-1]] = value
            at += 4 + (size + 3) // 4 * 4
        self.expect(at == len(data), 'kvdByteLength: not the sum of the pairs with their padding')
        self.expect(keys == sorted(keys), f'keys are not in the order of their code points: {keys}')
        self.expect(len(set(keys)) == len(keys), f'a key is there twice: {keys}')
        for key, value in pairs.items():
            self.expect(value.endswith(b'\0') and b'\0' not in value[:-1], f'{key}: not a text that ends in NUL')
            known = key in ('KTXorientation', 'KTXwriter') or not key.lower().startswith('ktx')
            self.expect(known, f'{key}: reserved name')
        space = pairs.get('envmap:space', b'\0').decode()[:-1]
        if self.expect(space in COLOURS, f'envmap:space: {space} is not one that is known here'):
            self.expect(self.colour == COLOURS[space], f'colorPrimaries, transferFunction: {self.colour} of {space or "BT.709"}')
        orientation = pairs.get('KTXorientation', b'rd\0')
        self.expect(re.fullmatch(b'[rl][du]\0', orientation), f'KTXorientation: {orientation}')
        self.expect(self.faces == 1 or orientation == b'rd\0', f'KTXorientation: {orientation} of a cube map, not rd')
        self.expect(len(pairs.get('KTXwriter', b'')) > 1, 'KTXwriter: missing, and strongly recommended')

    # ---- section 7: mip levels --------------------------------------------------------------------------------------

    def mip_levels(self):
        align = 1 if self.scheme else math.lcm(self.texel, 4)
        end = self.data_start
        for level in reversed(range(self.levels)):
            offset, size, plain = struct.unpack_from('<3Q', self.bytes, 80 + 24 * level)
            columns, rows = (-(-max(1, size >> level) // self.side) for size in (self.width, self.height))
            wanted = columns * rows * self.faces * self.texel
            start = (end + align - 1) // align * align
            self.expect(offset == start, f'level {level}: at {offset}, not {start}')
            self.expect(self.bytes[end:offset] == bytes(max(0, offset - end)), f'level {level}: padding is not 0')
            self.expect(plain == wanted, f'level {level}: uncompressedByteLength {plain}, not {wanted}')
            data = self.part(f'level {level}', offset, size)
            if self.scheme:
                data = self.unpacked(level, data)
            self.expect(len(data) == wanted, f'level {level}: {len(data)} bytes, not {wanted}')
            self.texels(level, data)
            end = offset + size
        self.expect(end == len(self.bytes), f'{len(self.bytes) - end} bytes after the last level')

    def unpacked(self, level, data):
        self.expect(data[:4] == b'\x28\xb5\x2f\xfd', f'level {level}: not a Zstandard frame')
        run = subprocess.run(['zstd', '-d', '-c', '-q'], input=data, capture_output=True)
        self.expect(run.returncode == 0, f'level {level}: {run.stderr.decode().strip()}')
        return run.stdout

    def texels(self, level, data):
        """Values are finite and alpha is 1: nothing that a sampler would spread."""
        if self.texel == 4 or self.side > 1 or len(data) % self.texel:
            return
        code = 'e' if self.texel == 8 else 'f'
        values = struct.unpack(f'<{len(data) // self.type_size}{code}', data)
        self.expect(all(map(math.isfinite, values)), f'level {level}: a value is not finite')
        self.expect(set(values[3::4]) <= {1.0}, f'level {level}: alpha is not 1')


def main():
    status = 0
    for name in sys.argv[1:]:
        file = File(name)
        file.check()
        for fault in file.faults:
            print(f'{name}: {fault}')
            status = 1
    return status


if __name__ == '__main__':
    sys.exit(main() if len(sys.argv) > 1 else __doc__)

"""A small writer of glTF 2.0 binary files, and the simple shapes that scenes are made of."""
import json
import math
import struct
import zlib


def png(width, height, pixel):
    """A PNG; pixel(x, y) gives (r, g, b) from 0 to 255."""
    rows = b"".join(b"\0" + bytes(c for x in range(width) for c in pixel(x, y)) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")


class Scene:
    """Nodes, meshes and materials as they are added; save() writes them."""

    def __init__(self):
        self.json = {"asset": {"version": "2.0", "generator": "envmap samples"}, "scene": 0, "scenes": [{"nodes": []}]}
        self.bytes = b""

    def _add(self, kind, thing):
        self.json.setdefault(kind, []).append(thing)
        return len(self.json[kind]) - 1

    def _view(self, data):
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        self.bytes += data
        return self._add("bufferViews", {"buffer": 0, "byteOffset": len(self.bytes) - len(data), "byteLength": len(data)})

    def accessor(self, rows, kind, bounds=False):
        """Of numbers in tuples; kind SCALAR with whole numbers holds indices."""
        flat = [x for row in rows for x in row]
        whole = all(isinstance(x, int) for x in flat)
        data = struct.pack("<%d%s" % (len(flat), "I" if whole else "f"), *flat)
        made = {"bufferView": self._view(data), "componentType": 5125 if whole else 5126, "count": len(rows), "type": kind}
        if bounds:
            made["min"], made["max"] = [min(c) for c in zip(*rows)], [max(c) for c in zip(*rows)]
        return self._add("accessors", made)

    def texture(self, image):
        source = self._add("images", {"bufferView": self._view(image), "mimeType": "image/png"})
        return self._add("textures", {"source": source})

    def material(self, name, colour=(1, 1, 1), metallic=0.0, roughness=0.8, texture=None, emissive=None, strength=1.0,
                 transmission=0.0, ior=1.5, thickness=0.0, attenuation=None):
        """attenuation: of a solid, what is left of white light, and after how many metres."""
        base = {"baseColorFactor": [*colour, 1], "metallicFactor": metallic, "roughnessFactor": roughness}
        if texture is not None:
            base["baseColorTexture"] = {"index": texture}
        made = {"name": name, "pbrMetallicRoughness": base}
        extensions = {}
        if emissive:
            made["emissiveFactor"] = list(emissive)
            extensions["KHR_materials_emissive_strength"] = {"emissiveStrength": strength}
        if transmission:
            extensions["KHR_materials_transmission"] = {"transmissionFactor": transmission}
            extensions["KHR_materials_ior"] = {"ior": ior}
            if thickness:  # A solid, not a thin wall.
                extensions["KHR_materials_volume"] = {"thicknessFactor": thickness}
                if attenuation:
                    extensions["KHR_materials_volume"].update(attenuationColor=list(attenuation[0]),
                                                              attenuationDistance=attenuation[1])
        if extensions:
            made["extensions"] = extensions
            self.json["extensionsUsed"] = sorted({*self.json.get("extensionsUsed", []), *extensions})
        return self._add("materials", made)

    def mesh(self, shape, material):
        positions, normals, coordinates, triangles = shape
        attributes = {"POSITION": self.accessor(positions, "VEC3", bounds=True), "NORMAL": self.accessor(normals, "VEC3"),
                      "TEXCOORD_0": self.accessor(coordinates, "VEC2")}
        indices = self.accessor([(k,) for triangle in triangles for k in triangle], "SCALAR")
        return self._add("meshes", {"primitives": [{"attributes": attributes, "indices": indices, "material": material}]})

    def node(self, name, mesh=None, parent=None, **more):
        """more: translation, rotation, scale, camera, extensions."""
        made = {"name": name, **more}
        if mesh is not None:
            made["mesh"] = mesh
        index = self._add("nodes", made)
        roots = self.json["scenes"][0]["nodes"]
        (roots if parent is None else self.json["nodes"][parent].setdefault("children", [])).append(index)
        return index

    def light(self, name, kind, intensity, colour=(1, 1, 1), parent=None, spot=None, **more):
        lights = self.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append({"type": kind, "intensity": intensity, "color": list(colour), **({"spot": spot} if spot else {})})
        self.json["extensionsUsed"] = sorted({*self.json.get("extensionsUsed", []), "KHR_lights_punctual"})
        return self.node(name, parent=parent, extensions={"KHR_lights_punctual": {"light": len(lights) - 1}}, **more)

    def camera(self, name, at, towards, field=0.9):
        camera = self._add("cameras", {"type": "perspective", "name": name,
                                       "perspective": {"yfov": field, "znear": 0.05, "zfar": 100}})
        return self.node(name, camera=camera, translation=list(at), rotation=look(at, towards))

    def animate(self, node, path, times, values):
        kind = "VEC4" if path == "rotation" else "VEC3"
        animation = self.json.setdefault("animations", [{"channels": [], "samplers": []}])[0]
        animation["samplers"].append({"input": self.accessor([(float(t),) for t in times], "SCALAR", bounds=True),
                                      "output": self.accessor([tuple(map(float, v)) for v in values], kind)})
        animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": {"node": node, "path": path}})

    def save(self, path):
        self.json["buffers"] = [{"byteLength": len(self.bytes)}]
        text = json.dumps(self.json, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        data = self.bytes + b"\0" * (-len(self.bytes) % 4)
        with open(path, "wb") as file:
            file.write(b"glTF" + struct.pack("<II", 2, 28 + len(text) + len(data)))
            file.write(struct.pack("<I", len(text)) + b"JSON" + text + struct.pack("<I", len(data)) + b"BIN\0" + data)


# ---- turns -----------------------------------------------------------------------------------------------------------

def turn(axis, degrees):
    """A quaternion about a unit axis."""
    half = math.radians(degrees) / 2
    return [*(math.sin(half) * a for a in axis), math.cos(half)]


def look(at, towards):
    """The turn of a camera, which looks along -Z with +Y up."""
    x, y, z = (b - a for a, b in zip(at, towards))
    yaw, pitch = math.atan2(-x, -z) / 2, math.atan2(y, math.hypot(x, z)) / 2
    cy, sy, cp, sp = math.cos(yaw), math.sin(yaw), math.cos(pitch), math.sin(pitch)
    return [cy * sp, sy * cp, -sy * sp, cy * cp]


# ---- shapes: positions, normals, texture coordinates, triangles ------------------------------------------------------

def united(*shapes):
    positions, normals, coordinates, triangles = [], [], [], []
    for p, n, c, t in shapes:
        triangles += [tuple(k + len(positions) for k in triangle) for triangle in t]
        positions, normals, coordinates = positions + p, normals + n, coordinates + c
    return positions, normals, coordinates, triangles


def moved(shape, x, y, z):
    positions, *rest = shape
    return ([(a + x, b + y, c + z) for a, b, c in positions], *rest)


def grid(columns, rows, point, normal, tiles=(1, 1)):
    """point(u, v) and normal(u, v) over [0,1]^2; its front has u to the right and v down."""
    places = [(i / columns, j / rows) for j in range(rows + 1) for i in range(columns + 1)]
    triangles = []
    for j in range(rows):
        for i in range(columns):
            a = j * (columns + 1) + i
            b = a + columns + 1
            triangles += [(a, b, b + 1), (a, b + 1, a + 1)]
    return ([tuple(map(float, point(u, v))) for u, v in places], [tuple(map(float, normal(u, v))) for u, v in places],
            [(u * tiles[0], v * tiles[1]) for u, v in places], triangles)


def wall(corner, right, down, cells=1, tiles=(1, 1)):
    """A parallelogram from its upper left corner."""
    n = (down[1] * right[2] - down[2] * right[1], down[2] * right[0] - down[0] * right[2], down[0] * right[1] - down[1] * right[0])
    length = math.hypot(*n)
    return grid(cells, cells, lambda u, v: [c + u * r + v * d for c, r, d in zip(corner, right, down)],
                lambda u, v: [x / length for x in n], tiles)


def box(width, height, depth, cells=1, inside=False):
    """Centred, its walls seen from outside or from inside."""
    x, y, z = width / 2, height / 2, depth / 2
    sides = [((x, y, z), (0, 0, -depth), (0, -height, 0)), ((-x, y, -z), (0, 0, depth), (0, -height, 0)),
             ((-x, y, -z), (width, 0, 0), (0, 0, depth)), ((-x, -y, z), (width, 0, 0), (0, 0, -depth)),
             ((-x, y, z), (width, 0, 0), (0, -height, 0)), ((x, y, -z), (-width, 0, 0), (0, -height, 0))]
    if inside:
        sides = [([c + r for c, r in zip(corner, right)], [-r for r in right], down) for corner, right, down in sides]
    return united(*(wall(*side, cells) for side in sides))


def lathe(profile, segments=32, rows=1):
    """A profile of (radius, height) from the top down, turned about +Y; straight between its points."""
    parts = []
    for (r0, h0), (r1, h1) in zip(profile, profile[1:]):
        length = math.hypot(r1 - r0, h1 - h0)
        across, up = (h0 - h1) / length, (r1 - r0) / length
        parts.append(grid(segments, rows,
                          lambda u, v: ((r0 + v * (r1 - r0)) * math.sin(2 * math.pi * u), h0 + v * (h1 - h0),
                                        (r0 + v * (r1 - r0)) * math.cos(2 * math.pi * u)),
                          lambda u, v: (across * math.sin(2 * math.pi * u), up, across * math.cos(2 * math.pi * u))))
    return united(*parts)


def ball(radius, cells=24):
    def normal(u, v):
        a, b = 2 * math.pi * u, math.pi * v
        return math.sin(b) * math.sin(a), math.cos(b), math.sin(b) * math.cos(a)
    return grid(2 * cells, cells, lambda u, v: [radius * n for n in normal(u, v)], normal)


def torus(ring, tube, cells=24):
    def normal(u, v):
        a, b = 2 * math.pi * u, 2 * math.pi * v
        return math.cos(b) * math.sin(a), math.sin(-b), math.cos(b) * math.cos(a)

    def point(u, v):
        n, a = normal(u, v), 2 * math.pi * u
        return ring * math.sin(a) + tube * n[0], tube * n[1], ring * math.cos(a) + tube * n[2]
    return grid(2 * cells, cells, point, normal)


def arch(inner, outer, depth, cells=16):
    """Half a ring that stands on its ends, its middle at the origin."""
    def ring(radius, sign):
        def at(u, v, r=radius):
            a = math.pi * (u if sign < 0 else 1 - u)
            return r * math.cos(a), r * math.sin(a), depth * (v - 0.5)
        return grid(cells, 1, at, lambda u, v: [sign * math.cos(math.pi * (u if sign < 0 else 1 - u)),
                                                sign * math.sin(math.pi * u), 0])

    def face(z):
        def at(u, v):
            a = math.pi * (1 - u if z > 0 else u)
            r = outer + v * (inner - outer)
            return r * math.cos(a), r * math.sin(a), z
        return grid(cells, 1, at, lambda u, v: (0, 0, math.copysign(1, z)))
    return united(ring(outer, 1), ring(inner, -1), face(depth / 2), face(-depth / 2))

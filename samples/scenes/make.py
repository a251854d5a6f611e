#!/usr/bin/env python3
"""Writes the sample scenes as glTF 2.0 (.glb): python3 samples/scenes/make.py OUT_DIR

room-2, room-4, room-21   a coloured room whose walls have that many vertices an edge, with a box, a ball and a ring in it
room-21-two-sided         the room of 21 vertices with doubleSided materials
wire-cube                 the edges of a cube
ball                      a mirror ball ("ball") on a table
balls                     mirror, glass, metals and plastics on tiles, for a sunny sky
terrace                   a paved square in the open, with columns, a brick wall and a ball of gold: what sample.hdr shows
metals                    four balls of white metal: roughness 0.1, 0.3, 0.5, 0.8
depth                     a wall of two triangles and a card 1.8 m behind it, seen from 1 m
plane                     a checkered plane that reaches to the horizon
facing                    a candle between two mirrors that face each other
cellar                    a furnished cellar with two mirrors ("mirror ball", "mirror ring"), glass, lamps and cameras;
                          the lamp swings, the ring turns and the ball rises (6 s)
"""
import math
import os
import sys

from gltf import Scene, arch, ball, box, lathe, moved, png, torus, turn, united, wall


def room(vertices, two_sided=False):
    """4 x 3 x 4 m about the origin."""
    scene, cells = Scene(), vertices - 1
    colours = {"+x": (0.8, 0.1, 0.1), "-x": (0.1, 0.6, 0.1), "+y": (0.9, 0.9, 0.85), "-y": (0.35, 0.3, 0.25),
               "+z": (0.1, 0.2, 0.8), "-z": (0.85, 0.7, 0.1)}
    x, y, z = 2.0, 1.5, 2.0
    sides = {"+x": ((x, y, -z), (0, 0, 2 * z), (0, -2 * y, 0)), "-x": ((-x, y, z), (0, 0, -2 * z), (0, -2 * y, 0)),
             "+y": ((-x, y, z), (2 * x, 0, 0), (0, 0, -2 * z)), "-y": ((-x, -y, -z), (2 * x, 0, 0), (0, 0, 2 * z)),
             "+z": ((x, y, z), (-2 * x, 0, 0), (0, -2 * y, 0)), "-z": ((-x, y, -z), (2 * x, 0, 0), (0, -2 * y, 0))}
    for name, side in sides.items():
        scene.node("wall " + name, scene.mesh(wall(*side, cells), scene.material(name, colours[name])))
    white = scene.material("white", (0.9, 0.9, 0.9), roughness=0.4)
    orange = scene.material("orange", (0.9, 0.4, 0.05), roughness=0.3)
    metal = scene.material("metal", (0.9, 0.85, 0.7), metallic=1.0, roughness=0.25)
    scene.node("box", scene.mesh(box(0.7, 0.9, 0.7, cells), orange), translation=[-1.1, -1.05, -0.9], rotation=turn((0, 1, 0), 25))
    scene.node("ball", scene.mesh(ball(0.4, max(8, cells)), white), translation=[1.0, -1.1, -0.6])
    scene.node("ring", scene.mesh(torus(0.4, 0.13, max(8, cells)), metal), translation=[0.6, 0.2, 1.2], rotation=turn((1, 0, 0), 70))
    scene.light("lamp", "point", 25, translation=[0, 1.2, 0])
    scene.camera("corner", (-1.6, 0.6, 1.7), (0.4, -0.5, -0.6), 1.2)
    for material in scene.json["materials"] if two_sided else ():
        material["doubleSided"] = True
    return scene


def wire_cube():
    """Edges of 2 m."""
    scene = Scene()
    bar, knot = scene.material("bars", (0.8, 0.8, 0.8), metallic=1, roughness=0.3), scene.material("corners", (0.9, 0.2, 0.1))
    corner = scene.mesh(ball(0.09, 12), knot)
    edges = {"x": scene.mesh(box(2, 0.08, 0.08), bar), "y": scene.mesh(box(0.08, 2, 0.08), bar),
             "z": scene.mesh(box(0.08, 0.08, 2), bar)}
    for a in (-1, 1):
        for b in (-1, 1):
            scene.node(f"x {a} {b}", edges["x"], translation=[0, a, b])
            scene.node(f"y {a} {b}", edges["y"], translation=[a, 0, b])
            scene.node(f"z {a} {b}", edges["z"], translation=[a, b, 0])
            for c in (-1, 1):
                scene.node(f"corner {a} {b} {c}", corner, translation=[a, b, c])
    scene.light("lamp", "point", 30, translation=[0.5, 0.8, 0.3])
    scene.camera("outside", (3, 2, 4), (0, 0, 0), 0.7)
    return scene


def noise(x, y):
    """Something uneven from 0 to 1 that is always the same."""
    return (x * 7919 ^ y * 104729 ^ x * y * 31) * 2654435761 % 4294967296 / 4294967296


def bricks(x, y):
    row = y // 16
    joint = y % 16 < 1 or (x + 16 * (row % 2)) % 32 < 1
    shade = 0.75 + 0.25 * noise((x + 16 * (row % 2)) // 32 + 91, row) + 0.08 * noise(x, y)
    return (150, 142, 130) if joint else [min(255, int(c * shade)) for c in (176, 104, 78)]


def flags(x, y):
    joint = x % 32 < 1 or y % 32 < 1
    shade = 0.75 + 0.2 * noise(x // 32 + 5, y // 32 + 9) + 0.08 * noise(x, y)
    return (90, 85, 80) if joint else [min(255, int(c * shade)) for c in (168, 160, 150)]


def planks(x, y):
    shade = 0.8 + 0.2 * noise(y // 16, 3) + 0.1 * math.sin(x / 9 + 4 * noise(y // 4, 1)) - (0.4 if y % 16 < 1 else 0)
    return [min(255, max(0, int(c * shade))) for c in (150, 98, 56)]


def table(scene, wood):
    top = moved(box(1.8, 0.07, 0.9), 0, 0.78, 0)
    legs = [moved(box(0.09, 0.75, 0.09), x, 0.375, z) for x in (-0.8, 0.8) for z in (-0.36, 0.36)]
    return scene.mesh(united(top, *legs), wood)


def shelf(scene, wood):
    boards = [moved(box(1.4, 0.04, 0.35), 0, y, 0) for y in (0.1, 0.65, 1.2, 1.75)]
    sides = [moved(box(0.05, 1.85, 0.36), x, 0.925, 0) for x in (-0.7, 0.7)]
    return scene.mesh(united(*boards, *sides), wood)


def barrel(scene, parent, name, at, wood, iron):
    """Staves that bulge, and three hoops."""
    bulge = [(0.33 + 0.09 * math.sin(math.pi * k / 8), 0.95 * (1 - k / 8)) for k in range(9)]
    node = scene.node(name, scene.mesh(lathe([(0, 0.93), (0.3, 0.93), (0.33, 0.95), *bulge[1:], (0, 0)], 32), wood), parent,
                      translation=at)
    hoops = [moved(torus(0.33 + 0.09 * math.sin(math.pi * y / 0.95), 0.02, 16), 0, y, 0) for y in (0.18, 0.475, 0.77)]
    scene.node(name + " hoops", scene.mesh(united(*hoops), iron), node)


def cellar():
    """8 x 6 m of floor, walls of 2 m and a vault above them; +Z is the wall with the stairs, the floor at 0."""
    scene = Scene()
    brick = scene.material("bricks", texture=scene.texture(png(128, 128, bricks)), roughness=0.9)
    floor = scene.material("flags", texture=scene.texture(png(128, 128, flags)), roughness=0.7)
    wood = scene.material("planks", texture=scene.texture(png(128, 128, planks)), roughness=0.6)
    stone = scene.material("stone", (0.55, 0.52, 0.48), roughness=0.9)
    iron = scene.material("iron", (0.35, 0.35, 0.37), metallic=1.0, roughness=0.45)
    copper = scene.material("copper", (0.95, 0.64, 0.54), metallic=1.0, roughness=0.2)
    dark = scene.material("door", (0.16, 0.09, 0.05), roughness=0.7)
    mirror = scene.material("mirror", (0.95, 0.95, 0.95), metallic=1.0, roughness=0.0)
    glass = scene.material("glass", (0.75, 0.95, 0.8), roughness=0.0, transmission=0.9, ior=1.45, thickness=0.2)
    wine = scene.material("wine", (0.25, 0.45, 0.2), roughness=0.1, transmission=0.5, ior=1.5, thickness=0.08)
    wax = scene.material("wax", (0.9, 0.85, 0.7), roughness=0.5)
    flame = scene.material("flame", (0, 0, 0), emissive=(1, 0.55, 0.2), strength=60)
    bulb = scene.material("bulb", (0, 0, 0), emissive=(1, 0.85, 0.6), strength=40)

    # The room: walls, floor, and a barrel vault along X, seen from inside.
    scene.node("floor", scene.mesh(wall((-4, 0, -3), (8, 0, 0), (0, 0, 6), 8, (4, 3)), floor))
    for name, side, tiles in (("wall -z", ((-4, 2, -3), (8, 0, 0), (0, -2, 0)), (8, 2)),
                              ("wall +z", ((4, 2, 3), (-8, 0, 0), (0, -2, 0)), (8, 2)),
                              ("wall +x", ((4, 3.2, -3), (0, 0, 6), (0, -3.2, 0)), (6, 3)),
                              ("wall -x", ((-4, 3.2, 3), (0, 0, -6), (0, -3.2, 0)), (6, 3))):
        scene.node(name, scene.mesh(wall(*side, 8, tiles), brick))
    steps = 24
    curve = [(-3 * math.cos(math.pi * k / steps), 2 + 1.2 * math.sin(math.pi * k / steps)) for k in range(steps + 1)]
    vault = [wall((-4, y1, z1), (8, 0, 0), (0, y0 - y1, z0 - z1), 1, (8, 0.5)) for (z0, y0), (z1, y1) in zip(curve, curve[1:])]
    scene.node("vault", scene.mesh(united(*vault), brick))
    for x in (-2.6, 0, 2.6):
        rib = scene.node(f"rib {x}", scene.mesh(arch(0.93, 1.0, 0.3, 24), stone), translation=[x, 2, 0],
                         rotation=turn((0, 1, 0), 90), scale=[3, 1.2, 1])
        for z in (-2.9, 2.9):
            scene.node(f"pillar {x} {z}", scene.mesh(moved(box(0.3, 2, 0.2), x, 1, z), stone))

    # Stairs up to a door in its arch, in the corner of +X and +Z.
    stairs = [moved(box(1.2, 0.2 * (k + 1), 0.3), 0, 0.1 * (k + 1), 0.3 * k) for k in range(6)]
    scene.node("stairs", scene.mesh(united(*stairs), stone), translation=[3.3, 0, 1.35])
    scene.node("door", scene.mesh(moved(box(0.05, 1.1, 0.9), 3.97, 1.75, 2.3), dark))
    scene.node("door arch", scene.mesh(arch(0.45, 0.62, 0.25), stone), translation=[3.92, 2.3, 2.3], rotation=turn((0, 1, 0), 90))

    scene.node("table", table(scene, wood), translation=[0.3, 0, -0.3], rotation=turn((0, 1, 0), 12))
    for k, (x, z, angle) in enumerate(((-0.5, 0.75, 15), (0.9, 0.7, -10))):
        stool = united(lathe([(0, 0.47), (0.2, 0.47), (0.2, 0.42), (0, 0.42)]),
                       *(moved(box(0.05, 0.43, 0.05), 0.13 * math.cos(a), 0.215, 0.13 * math.sin(a)) for a in (0.5, 2.6, 4.7)))
        scene.node(f"stool {k + 1}", scene.mesh(stool, wood), translation=[x, 0, z], rotation=turn((0, 1, 0), angle))
    bottle = scene.mesh(lathe([(0, 0.32), (0.016, 0.32), (0.016, 0.22), (0.042, 0.17), (0.042, 0.0), (0, 0)], 24), wine)
    jar = scene.mesh(lathe([(0, 0.2), (0.05, 0.2), (0.085, 0.15), (0.085, 0.02), (0.06, 0), (0, 0)], 24), copper)
    for s, x in enumerate((-2.9, -1.3)):
        node = scene.node(f"shelf {s + 1}", shelf(scene, wood), translation=[x, 0, -2.78])
        for board, y in enumerate((0.12, 0.67, 1.22)):
            for k in range(5):
                if noise(5 * s + k, board + 2) > 0.25:
                    scene.node(f"bottle {s + 1}.{board + 1}.{k + 1}", bottle if noise(k, 7 * board + s) > 0.3 else jar, node,
                               translation=[-0.5 + 0.25 * k, y, 0.02])
    for k, (x, y, z) in enumerate(((2.2, 0, -2.4), (3.1, 0, -2.35), (3.3, 0, -1.4))):
        barrel(scene, None, f"barrel {k + 1}", [x, y, z], wood, iron)
    lying = scene.node("lying barrel", translation=[2.7, 1.28, -2.35], rotation=turn((1, 0, 0), 90))
    barrel(scene, lying, "barrel 4", [0, -0.5, 0], wood, iron)
    scene.node("tumbler", scene.mesh(lathe([(0.04, 0.13), (0.045, 0.13), (0.04, 0), (0, 0)], 24), glass), translation=[0.75, 0.815, -0.15])
    scene.node("glass ball", scene.mesh(ball(0.14, 20), glass), translation=[-0.35, 0.955, -0.35])
    for k, (x, z, h) in enumerate(((0.9, -0.55, 0.2), (1.0, -0.45, 0.13))):
        scene.node(f"candle {k + 1}", scene.mesh(lathe([(0, h), (0.025, h), (0.025, 0), (0, 0)], 16), wax), translation=[x, 0.815, z])
        scene.node(f"flame {k + 1}", scene.mesh(ball(0.018, 8), flame), translation=[x, 0.84 + h, z], scale=[1, 2, 1])
    scene.light("candlelight", "point", 3, (1, 0.6, 0.3), translation=[0.95, 1.1, -0.5])

    # Two mirrors, and what moves.
    quarter = [0, 1.5, 3, 4.5, 6]
    rising = scene.node("mirror ball", scene.mesh(ball(0.3, 32), mirror), translation=[0.3, 1.25, -0.3])
    scene.animate(rising, "translation", quarter, [(0.3, y, -0.3) for y in (1.25, 1.45, 1.25, 1.12, 1.25)])
    ring = scene.node("mirror ring", scene.mesh(torus(0.42, 0.13, 32), mirror), translation=[-2.2, 1.3, 0.3], rotation=turn((1, 0, 0), 65))
    scene.animate(ring, "rotation", quarter, [multiplied(turn((0, 1, 0), 90 * k), turn((1, 0, 0), 65)) for k in range(5)])
    swing = scene.node("lamp", translation=[0.3, 3.15, 0.6])
    scene.node("cord", scene.mesh(moved(box(0.015, 0.8, 0.015), 0, -0.4, 0), iron), swing)
    scene.node("shade", scene.mesh(lathe([(0.05, -0.75), (0.24, -0.95)], 32), copper), swing)
    scene.node("bulb", scene.mesh(moved(ball(0.07, 16), 0, -0.92, 0), bulb), swing)
    scene.light("lamplight", "point", 22, (1, 0.85, 0.65), parent=swing, translation=[0, -1.02, 0])
    scene.animate(swing, "rotation", quarter, [turn((0, 0, 1), a) for a in (0, 14, 0, -14, 0)])
    scene.light("moonlight", "spot", 40, (0.6, 0.75, 1.0), spot={"innerConeAngle": 0.25, "outerConeAngle": 0.5},
                translation=[3.6, 2.4, 2.2], rotation=turn((0, 1, 0), 60))

    scene.camera("entrance", (3.2, 1.9, 2.2), (-0.6, 0.9, -0.9), 1.0)
    scene.camera("tabletop", (-0.9, 1.5, 1.6), (0.3, 1.05, -0.3), 0.8)
    return scene


def ball_on_a_table():
    scene = Scene()
    wood = scene.material("planks", texture=scene.texture(png(128, 128, planks)), roughness=0.6)
    wall_colour, floor = scene.material("wall", (0.5, 0.55, 0.6), roughness=0.9), scene.material("floor", (0.3, 0.28, 0.26), roughness=0.9)
    mirror = scene.material("mirror", (0.95, 0.95, 0.95), metallic=1.0, roughness=0.0)
    red, green = scene.material("red", (0.8, 0.1, 0.08), roughness=0.4), scene.material("green", (0.1, 0.5, 0.15), roughness=0.4)
    scene.node("floor", scene.mesh(wall((-2, 0, -2), (4, 0, 0), (0, 0, 4)), floor))
    for angle in (0, 90, 180, 270):
        scene.node(f"wall {angle}", scene.mesh(wall((-2, 2.5, -2), (4, 0, 0), (0, -2.5, 0)), wall_colour), rotation=turn((0, 1, 0), angle))
    scene.node("table", table(scene, wood))
    scene.node("ball", scene.mesh(ball(0.2, 48), mirror), translation=[0, 1.015, 0])
    scene.node("box", scene.mesh(moved(box(0.15, 0.15, 0.15), 0.38, 0.89, 0.1), red), rotation=turn((0, 1, 0), 10))
    scene.node("pole", scene.mesh(moved(box(0.05, 0.4, 0.05), -0.35, 1.015, 0.12), green))
    scene.light("lamp", "point", 20, (1, 0.95, 0.85), translation=[0.5, 2.2, 1])
    scene.camera("front", (0.1, 1.3, 1.1), (0, 0.98, 0), 0.8)
    return scene


def balls():
    """Eight balls on 6 x 6 m of tiles; no light of its own."""
    scene = Scene()
    tiles = scene.material("tiles", texture=scene.texture(png(128, 128, flags)), roughness=0.6)
    scene.node("floor", scene.mesh(wall((-3, 0, -3), (6, 0, 0), (0, 0, 6), 1, (4, 4)), tiles))
    made = (("mirror", (0, 0.6, -0.35), 0.6, dict(colour=(0.95, 0.95, 0.95), metallic=1.0, roughness=0.0)),
            ("glass", (-0.55, 0.3, 0.75), 0.3, dict(colour=(0.97, 0.99, 0.98), roughness=0.0, transmission=1.0, thickness=0.6)),
            ("gold", (-1.35, 0.45, 0.05), 0.45, dict(colour=(1.0, 0.77, 0.34), metallic=1.0, roughness=0.25)),
            ("copper", (1.3, 0.4, 0.1), 0.4, dict(colour=(0.95, 0.64, 0.54), metallic=1.0, roughness=0.45)),
            ("red plastic", (0.5, 0.25, 0.85), 0.25, dict(colour=(0.75, 0.05, 0.04), roughness=0.25)),
            ("blue plastic", (1.05, 0.16, 0.95), 0.16, dict(colour=(0.05, 0.15, 0.65), roughness=0.1)),
            ("chalk", (-1.15, 0.18, 0.95), 0.18, dict(colour=(0.85, 0.83, 0.8), roughness=1.0)),
            ("small mirror", (0.02, 0.14, 1.15), 0.14, dict(colour=(0.95, 0.95, 0.95), metallic=1.0, roughness=0.0)))
    for name, at, radius, material in made:
        scene.node(name, scene.mesh(ball(radius, 64), scene.material(name, **material)), translation=list(at))
    scene.camera("front", (0.4, 1.35, 4.2), (0, 0.42, 0), 0.52)
    return scene


def terrace():
    """14 x 14 m of flags about the origin, their top at 0; no light of its own."""
    scene = Scene()
    floor = scene.material("flags", (0.55, 0.52, 0.48), roughness=0.9)
    brick = scene.material("bricks", (0.65, 0.3, 0.2), roughness=0.9)
    stone = scene.material("stone", (0.75, 0.71, 0.62), roughness=0.8)
    blue = scene.material("blue", (0.15, 0.3, 0.7), roughness=0.4)
    gold = scene.material("gold", (1.0, 0.77, 0.34), metallic=1.0, roughness=0.2)
    scene.node("floor", scene.mesh(moved(box(14, 0.2, 14), 0, -0.1, 0), floor))
    column = scene.mesh(united(moved(box(0.8, 0.2, 0.8), 0, 0.1, 0), lathe([(0.24, 3), (0.3, 0.2)], 32),
                               moved(box(0.75, 0.2, 0.75), 0, 3.1, 0)), stone)
    for k in range(5):
        scene.node(f"column {k + 1}", column, translation=[-4.5, 0, 2.4 * (k - 2)])
    scene.node("beam", scene.mesh(moved(box(0.75, 0.4, 10.6), -4.5, 3.4, 0), stone))
    for name, z, depth in (("left", -3, 4), ("right", 3, 4)):
        scene.node(f"wall {name}", scene.mesh(moved(box(0.5, 2.4, depth), 5, 1.2, z), brick))
    scene.node("arch", scene.mesh(arch(1, 1.5, 0.6), stone), translation=[5, 2.4, 0], rotation=turn((0, 1, 0), 90))
    scene.node("plinth", scene.mesh(moved(box(0.9, 1, 0.9), 0.6, 0.5, -3.2), stone))
    scene.node("ball", scene.mesh(ball(0.6, 64), gold), translation=[0.6, 1.6, -3.2])
    scene.node("bench", scene.mesh(moved(box(2.6, 0.45, 0.7), 0, 0.225, 4.2), blue))
    return scene


def metals():
    """Four balls of white metal in a row; no light of its own."""
    scene, round_ball = Scene(), ball(1, 96)
    for k, roughness in enumerate((0.1, 0.3, 0.5, 0.8)):
        metal = scene.material(f"metal {roughness}", (1, 1, 1), metallic=1.0, roughness=roughness)
        scene.node(f"ball {roughness}", scene.mesh(round_ball, metal), translation=[2.1 * (k - 1.5), 0, 0])
    scene.camera("front", (0, 0, 12), (0, 0, 0), math.radians(10.5))
    return scene


def chrome_ball():
    """A ball of 20 cm that a camera photographs from 1.5 m, 15 radii away; no light of its own. The ball mirrors the camera."""
    scene = Scene()
    chrome = scene.material("chrome", (0.6, 0.6, 0.6), metallic=1.0, roughness=0.0)
    scene.node("ball", scene.mesh(ball(0.1, 96), chrome))
    scene.node("camera body", scene.mesh(moved(box(0.16, 0.12, 0.1), 0, 0, 1.58), scene.material("black", (0.01, 0.01, 0.01))))
    scene.camera("front", (0, 0, 1.5), (0, 0, 0), math.radians(11.5))
    return scene


def facing():
    """Two mirrors of 2 x 2 m, 2 m apart along X, in a lit room of 6 x 5 x 6 m."""
    scene = Scene()
    mirror = scene.material("mirror", (0.95, 0.95, 0.95), metallic=1.0, roughness=0.0)
    wax = scene.material("wax", (0.9, 0.3, 0.2), roughness=0.5)
    wall_colour = scene.material("wall", (0.3, 0.4, 0.5), roughness=0.9)
    scene.node("floor", scene.mesh(wall((-3, -1, -3), (6, 0, 0), (0, 0, 6), 8), scene.material("floor", (0.4, 0.35, 0.3), roughness=0.9)))
    for angle in (0, 90, 180, 270):
        scene.node(f"wall {angle}", scene.mesh(wall((-3, 4, -3), (6, 0, 0), (0, -5, 0)), wall_colour), rotation=turn((0, 1, 0), angle))
    scene.node("ceiling", scene.mesh(wall((-3, 4, 3), (6, 0, 0), (0, 0, -6)), wall_colour))
    scene.node("left", scene.mesh(wall((-1, 1, 1), (0, 0, -2), (0, -2, 0)), mirror))
    scene.node("right", scene.mesh(wall((1, 1, -1), (0, 0, 2), (0, -2, 0)), mirror))
    scene.node("candle", scene.mesh(moved(box(0.2, 0.7, 0.2), 0.2, -0.65, -0.2), wax))
    scene.light("lamp", "point", 25, translation=[0, 1.5, 0])
    scene.camera("between", (0.85, 0.3, 0.8), (-1, -0.1, -0.2), 0.9)
    return scene


def plane():
    """400 x 400 m of checks of 25 cm, seen from 60 cm above them; no light of its own."""
    scene, half = Scene(), 200.0
    checks = png(32, 32, lambda x, y: (235, 225, 200) if (x < 16) == (y < 16) else (20, 45, 90))
    material = scene.material("checks", texture=scene.texture(checks), roughness=1.0)
    scene.node("plane", scene.mesh(wall((-half, 0, -half), (2 * half, 0, 0), (0, 0, 2 * half), 1, (800, 800)), material))
    scene.camera("low", (0.2, 0.6, 0.1), (0, 0.45, -1), 0.7)
    return scene


def depth():
    """A wall of 4 x 4 m at z = 1, red, hides a green card; both face the origin. No light of its own."""
    scene = Scene()
    red, green = scene.material("red", (0.8, 0.15, 0.1)), scene.material("green", (0.1, 0.7, 0.2))
    scene.node("wall", scene.mesh(wall((2, 2, 1), (-4, 0, 0), (0, -4, 0)), red))
    scene.node("card", scene.mesh(wall((0.8, 0.8, 2.8), (-1.6, 0, 0), (0, -1.6, 0), 16), green))
    return scene


def multiplied(a, b):
    """Quaternions: b first."""
    (ax, ay, az, aw), (bx, by, bz, bw) = a, b
    return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz]


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__.strip())
    folder = sys.argv[1]
    os.makedirs(folder, exist_ok=True)
    for name, scene in (("room-2", room(2)), ("room-4", room(4)), ("room-21", room(21)),
                        ("room-21-two-sided", room(21, True)), ("wire-cube", wire_cube()), ("ball", ball_on_a_table()),
                        ("balls", balls()), ("terrace", terrace()), ("metals", metals()), ("chrome-ball", chrome_ball()),
                        ("depth", depth()), ("plane", plane()), ("facing", facing()), ("cellar", cellar())):
        scene.save(os.path.join(folder, name + ".glb"))


if __name__ == "__main__":
    main()

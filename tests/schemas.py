"""What --json prints, of every command that has it, against the JSON Schemas that `envmap manual --schemas` writes: maps of every
projection and kind, black, flawed and one texel large. A schema that lets everything through is found by reports that are
damaged: without a key, with one more, with a value of another kind. VALUES has what reports of known maps say.

  schemas.py ENVMAP          ends with 77 where there is no python3-jsonschema
"""
import copy
import json
import os
import pathlib
import struct
import subprocess
import sys
import tempfile

try:
    import jsonschema
except ImportError:
    sys.exit(77)

ENVMAP = sys.argv[1]
NAN, INFINITY = float('nan'), float('inf')


def run(*arguments, statuses=(0,)):
    done = subprocess.run([ENVMAP, *arguments], capture_output=True, text=True)
    assert done.returncode in statuses, (arguments, done.returncode, done.stderr)
    return done.stdout


def exr(name, width, height, texel):
    """Floats without compression; envmap itself writes neither NaN nor infinities."""
    box = struct.pack('<4i', 0, 0, width - 1, height - 1)
    channels = b''.join(c + b'\0' + struct.pack('<4i', 2, 0, 1, 1) for c in (b'B', b'G', b'R')) + b'\0'
    header = b'\x76\x2f\x31\x01\x02\0\0\0'
    for key, kind, value in ((b'channels', b'chlist', channels), (b'compression', b'compression', b'\0'), (b'dataWindow', b'box2i', box),
                             (b'displayWindow', b'box2i', box), (b'lineOrder', b'lineOrder', b'\0'),
                             (b'pixelAspectRatio', b'float', struct.pack('<f', 1)), (b'screenWindowCenter', b'v2f', struct.pack('<2f', 0, 0)),
                             (b'screenWindowWidth', b'float', struct.pack('<f', 1))):
        header += key + b'\0' + kind + b'\0' + struct.pack('<i', len(value)) + value
    line = 12 * width
    begin = len(header) + 1 + 8 * height
    offsets = struct.pack(f'<{height}Q', *(begin + y * (8 + line) for y in range(height)))
    rows = b''.join(struct.pack('<2i', y, line) + b''.join(struct.pack('<f', texel(x, y)[c]) for c in (2, 1, 0) for x in range(width))
                    for y in range(height))
    pathlib.Path(name).write_bytes(header + b'\0' + offsets + rows)


# What a report says at its JSON pointers; a function: what it says holds.
VALUES = [
    ('info latlong.exr --from-forward -x', {'/file': 'latlong.exr', '/format': 'openexr', '/width': 16, '/height': 8, '/face_width': 16, '/face_height': 8}),
    ('info shown.hdr --from-forward -x', {'/format': 'hdr', '/forward': '-x'}),
    ('info latlong.exr', {'/not_finite': 'absent'}),
    ('info black.exr', {'/stops': None, '/not_finite//stops': 'nan'}),
    ('info nothing.exr', {'/nan': 8}),
    ('info flawed.exr', {'/nan': 2, '/infinite': 2, '/negative': 4, '/first_flaw/texel': [0, 0]}),
    ('compare latlong.exr black8.exr', {'/rms': None, '/not_finite//rms': 'infinite'}),
    ('compare latlong.exr black8.exr --max-error 1', {'/within': False}),
    ('convert latlong.exr out.exr --to cube --max-error 0.5',
     {'/error/max': lambda e: e <= 0.5, '/error/within': True, '/output': 'out.exr', '/seconds': lambda t: t > 0}),
    ('convert latlong.exr out.jpg --gain-map', {'/gain_map': lambda g: g['gain_quality'] == 95}),
    ('convert sun.exr out.exr --to cube --size 64 --max-error 1e-5 --depth float', {'/error': lambda e: e is not None}),
    ('mipmap latlong.exr out.exr',
     {'/levels': lambda levels: len(levels) == 5 and all(abs(off) < 1e-6 for level in levels for off in level['flux_difference'])}),
    ('prefilter latlong.exr out.exr --size 4 --method exact', {'/levels/0/method': 'exact', '/levels/0/max': None}),
    ('view plate.obj {frame}.png --width 16 --height 16 --ambient 1 --mirror plate --frames 0:2',
     {'/frames': 3, '/outputs': lambda o: len(o) == 3, '/mirrors': lambda m: len(m) == 1, '/mirrors/0/drawn': lambda n: n > 0,
      '/mirrors/0/size': lambda n: n > 0, '/mirrors/0/unchanged': 2}),
]


def says(report, values, line):
    there = dict(places(report))
    for place, wanted in values.items():
        # A pointer as a key of not_finite stands after a second slash.
        found = there.get(place, 'absent')
        assert wanted(found) if callable(wanted) else found == wanted, f'envmap {line}: {place} is {found}'


def places(value, path=''):
    """Every value in a report by its JSON pointer."""
    yield path, value
    for key, member in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        yield from places(member, f'{path}/{key}')


def check(schemas, tried, command, *arguments, statuses=(0,)):
    text = run(command, *arguments, '--json', statuses=statuses)
    report = json.loads(text, parse_constant=lambda word: sys.exit(f'{command} {arguments}: {word} is no JSON'))
    try:
        schemas[command].validate(report)
    except jsonschema.ValidationError as e:
        sys.exit(f'envmap {command} {" ".join(arguments)}: {e.json_path}: {e.message}')
    there = dict(places(report))
    for place in report.get('not_finite', {}):
        assert there[place] is None, (command, arguments, place)
    tried.setdefault(command, []).append(report)
    return report


def refuses_damage(schema, report):
    required = schema.schema.get('required') or schema.schema['anyOf'][0]['required']
    damaged = [dict(report, surprise=1), dict(report, version=2)]
    for key, value in report.items():
        if key in required:
            damaged.append({k: v for k, v in report.items() if k != key})
        damaged.append(dict(report, **{key: [value] if key != 'metadata' else 1}))
        if isinstance(value, dict) and key not in ('metadata', 'not_finite'):
            damaged += [dict(report, **{key: {k: v for k, v in value.items() if k != gone}}) for gone in value]
        if isinstance(value, list) and value and isinstance(value[0], dict):
            for gone in value[0]:
                one = copy.deepcopy(report)
                del one[key][0][gone]
                if not (gone == 'bytes'):
                    damaged.append(one)
    for one in damaged:
        assert not schema.is_valid(one), (schema.schema['title'], one)


def main():
    run('manual', '--schemas', '.')
    schemas, tried = {}, {}
    for file in pathlib.Path().glob('*.json'):
        text = json.loads(file.read_text())
        jsonschema.Draft202012Validator.check_schema(text)
        schemas[file.stem] = jsonschema.Draft202012Validator(text)

    def tell(*arguments, **how):
        return check(schemas, tried, *arguments, **how)

    for projection in ('latlong', 'cube', 'sphere', 'paraboloid', 'angular', 'octahedral', 'equal-area'):
        run('generate', 'directions', f'{projection}.exr', '--to', projection, '--size', '8')
        tell('info', f'{projection}.exr', '--levels', '--sampling')
        tell('compare', f'{projection}.exr', 'latlong.exr')
    run('convert', 'cube.exr', 'border.exr', '--openexr-envmap', '--depth', 'float')
    tell('info', 'border.exr')
    run('generate', 'constant', '{face}.exr', '--to', 'cube', '--size', '1')
    tell('info', '{face}.exr', '--levels', '--sampling')

    # Black, dark to the last bit, bright to the last, and what is no number.
    tiny = struct.unpack('<f', b'\1\0\0\0')[0]
    largest = struct.unpack('<f', b'\xff\xff\x7f\x7f')[0]
    for name, light in {'black': 0, 'tiny': tiny, 'largest': largest, 'one': 1}.items():
        exr(f'{name}.exr', 4, 2, lambda x, y: (light, light, light))
    exr('flawed.exr', 4, 2, lambda x, y: (NAN if x == 1 else INFINITY if x == 2 else -1, 0, 1))
    exr('nothing.exr', 4, 2, lambda x, y: (NAN, NAN, NAN))
    exr('endless.exr', 4, 2, lambda x, y: (INFINITY, -INFINITY, INFINITY))
    exr('texel.exr', 1, 1, lambda x, y: (1, 2, 3))
    for name in ('black', 'tiny', 'largest', 'flawed', 'nothing', 'endless'):
        tell('info', f'{name}.exr', '--levels', '--sampling')
    tell('info', 'texel.exr', '--from', 'sphere', '--sampling')
    sound = ('black', 'tiny', 'largest', 'one')
    for name in sound:
        tell('compare', f'{name}.exr', 'black.exr')
        tell('compare', 'black.exr', f'{name}.exr')
        tell('sh', f'{name}.exr')
        tell('sh', f'{name}.exr', '--irradiance', '--window', 'auto', statuses=(0, 3) if name == 'largest' else (0,))
        tell('mipmap', f'{name}.exr', 'levels.exr', '--depth', 'float')
        tell('convert', f'{name}.exr', 'out.exr', '--to', 'cube', '--size', '2', '--max-error', '1', '--depth', 'float')
        tell('prefilter', f'{name}.exr', 'out.exr', '--size', '2', '--depth', 'float')
    tell('mipmap', 'latlong.exr', 'levels.exr')
    tell('compare', 'levels.exr', 'levels.exr')
    tell('compare', 'levels.exr', 'latlong.exr', statuses=(0, 1))
    tell('compare', 'latlong.exr', 'cube.exr', '--golden', '--max-flux', '0', '--max-rms', '0', statuses=(1,))
    tell('info', 'levels.exr', '--levels')
    tell('sh', 'latlong.exr', '--order', '3', '--window', 'hann')
    tell('generate', 'sun', 'sun.exr', '--to', 'latlong', '--size', '16')
    tell('generate', 'atmosphere', 'day.exr', '--size', '8')
    tell('generate', 'atmosphere', 'night.exr', '--size', '8', '--elevation', '-90')
    tell('convert', 'largest.exr', 'out.exr', '--depth', 'half', '--clamp')
    tell('convert', 'latlong.exr', 'out.dds', '--for', 'babylon')
    tell('convert', 'latlong.exr', 'out.png', '--to', 'fisheye', '--size', '8')
    tell('mipmap', 'latlong.exr', 'out.dds', '--for', 'babylon')
    tell('prefilter', 'latlong.exr', 'out.ktx', '--for', 'filament', '--size', '16', '--max-error', '0.1')
    for lobe in (['phong', '--exponent', '3'], ['ggx', '--levels', '3', '--method', 'exact'], ['charlie', '--roughness', '0.5'], ['blinn-phong', '--exponent', '3']):
        tell('prefilter', 'latlong.exr', 'out.exr', '--size', '4', '--lobe', *lobe)
    pathlib.Path('lobe.txt').write_text('1 1\n0.5 0\n')
    tell('prefilter', 'latlong.exr', 'out.exr', '--size', '4', '--lobe-table', 'lobe.txt')
    pathlib.Path('plate.obj').write_text('o plate\nv -1 -1 -1\nv 1 -1 -1\nv 0 1 -1\nf 1 2 3\n')
    tell('info', 'plate.obj')
    tell('render', 'plate.obj', 'drawn.exr', '--size', '8', '--to', 'sphere', '--method', 'distort', '--ambient', '1')
    tell('render', 'plate.obj', '{index}.exr', '--size', '8', '--method', 'raycast', '--ambient', '1', '--at', '0,0,0', '--at', '0,0,1')
    tell('render', 'plate.obj', 'grid.json', '--grid', '2,2,1', '--grid-high', '1,1,1', '--size', '8', '--ambient', '1')
    tell('view', 'plate.obj', 'seen.png', '--width', '16', '--height', '16', '--ambient', '1', '--method', 'raycast')
    run('generate', 'sun', 'clear.exr', '--to', 'latlong', '--size', '128', '--radius', '2')
    tell('lights', 'clear.exr', '--remainder', 'rest.exr', '--gltf', 'suns.gltf')
    tell('lights', 'clear.exr', '--count', '5')
    tell('lights', 'black.exr', statuses=(1,))
    tell('info', 'clear.exr')
    tell('bake', 'clear.exr', 'sunny', '--for', 'blender', '--suns')
    tell('convert', 'clear.exr', 'brighter.exr', '--restore-sun', 'irradiance=1e5,2e5,3e5', '--depth', 'float')
    tell('bake', '--list')
    tell('bake', 'latlong.exr', 'folder', '--for', 'gltf', '--chain-size', '16', '--max-error', '0.1')
    tell('bake', 'latlong.exr', 'other', '--for', 'blender')
    for task in ('convert:cube:2', 'mipmap:1', 'diffuse:cube:2', 'depth'):
        tell('tradeoff', 'latlong.exr', '--task', task, '--budget', '0.1')
    tell('tradeoff', 'black.exr', '--task', 'convert:cube:2', '--budget', '0.1')

    exr('black8.exr', 16, 8, lambda x, y: (0, 0, 0))
    run('convert', 'latlong.exr', 'shown.hdr')
    for line, values in VALUES:
        says(tell(*line.split(), statuses=(0, 1)), values, line)
    for command in ('convert', 'mipmap', 'prefilter'):
        run(command, 'latlong.exr', '-', '--json', statuses=(2,))
    assert set(tried) == set(schemas), set(tried) ^ set(schemas)
    for command, reports in tried.items():
        refuses_damage(schemas[command], max(reports, key=len))
    print(f'{sum(map(len, tried.values()))} reports of {len(tried)} commands')


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    main()

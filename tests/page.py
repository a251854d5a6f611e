"""The page of `envmap preview --html`, in headless Chromium: every view against `envmap generate directions` of that projection,
whose colours are (direction + 1) / 2; the camera, balls, blur and readings against formulae; keys and pointers against what they do.

  page.py ENVMAP          ends with 77 where there is no chromium
"""
import base64
import json
import math
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile

SIZE = 64
VIEWS = {'latlong': (1, 2, 1), 'cube': (2, 4, 3), 'sphere': (3, 1, 1), 'paraboloid': (4, 2, 1), 'angular': (5, 1, 1),
         'octahedral': (6, 1, 1), 'equal-area': (7, 1, 1)}  # Its number in the page; columns and rows of SIZE texels.
WITHIN = 0.008  # A byte and a texel's 9 bits, both linear.

# Runs in the page after its own script, all at once, so that nothing is drawn in between.
PROBE = '''
const result = { views: {}, unlabelled: [...document.querySelectorAll('input,select')].filter((e) => e.labels.length === 0).length };
function pixels(width, height) {
  canvas.width = width; canvas.height = height;
  draw();
  const bytes = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  return [...bytes];
}
for (const [name, [view, columns, rows, forward]] of Object.entries(VIEWS)) {
  Object.assign(state, { view });
  data.forward = forward;
  result.views[name] = pixels(columns * SIZE, rows * SIZE);
}
data.forward = 0;
Object.assign(state, { view: 0, yaw: 30, pitch: 20, fov: 60, ballsShown: false });
result.camera = pixels(96, 64);
result.picked = pick(10.5, 20.5);
state.ballsShown = true;
state.balls = [{ x: 0.2, y: 0.1, surface: 'ggx', roughness: 0 }, { x: -0.8, y: 0, surface: 'diffuse', roughness: 0 },
  { x: 0.9, y: 0, surface: 'dielectric', roughness: 0 }];
result.balls = pixels(96, 64);
state.ballsShown = false;
const choose = (id, value) => { element(id).value = value; element(id).dispatchEvent(new Event('input')); };
choose('image', images.findIndex(({ image }) => image === 1)); choose('blur', 0.5);
result.blurred = pixels(96, 64);
choose('image', 0);
state.ballsShown = true;
const key = (name, shiftKey) => canvas.dispatchEvent(new KeyboardEvent('keydown', { key: name, shiftKey }));
const point = (type, x, y, pointerId) => canvas.dispatchEvent(new PointerEvent(type, { clientX: x, clientY: y, pointerId }));
canvas.setPointerCapture = () => {};  // Of pointers that nobody holds it would throw.
state.yaw = 0;
key('ArrowRight'); result.yaw = state.yaw;
key('+'); result.fov = state.fov;
state.ball = 0; key('ArrowUp', true); result.keyed = state.balls[0].y;
const box = canvas.getBoundingClientRect(), from = [box.left + box.width / 2, box.top + box.height / 2];
state.balls[0].x = state.balls[0].y = 0;
point('pointerdown', from[0], from[1], 7); point('pointermove', from[0] + box.height / 4, from[1], 7); point('pointerup', 0, 0, 7);
result.dragged = state.balls[0].x;
state.ballsShown = false;
point('pointerdown', from[0], from[1], 7); point('pointermove', from[0] + 10, from[1], 7);
result.turned = state.yaw;
const fov = state.fov;
point('pointerdown', from[0] + 50, from[1], 8); point('pointermove', from[0] + 110, from[1], 8);
result.pinched = state.fov / fov;
result.failure = document.getElementById('failure').textContent;
const told = document.createElement('pre');
told.id = 'result';
told.textContent = JSON.stringify(result);
document.body.append(told);
'''

failures = []


def expect(right, what):
    if not right:
        failures.append(what)


def linear(byte):
    x = byte / 255
    return x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4


def pixel(image, width, x, y):
    """Of what WebGL reads: rows from below."""
    at = 4 * (y * width + x)
    return [linear(b) for b in image[at:at + 3]]


def expect_colour(found, wanted, what):
    expect(all(abs(f - w) < WITHIN for f, w in zip(found, wanted)), f'{what}: {found}, not {wanted}')


def read_pfm(path):
    """Width, height, rows from below."""
    with open(path, 'rb') as file:
        assert file.readline().strip() == b'PF'
        width, height = map(int, file.readline().split())
        order = '<' if float(file.readline()) < 0 else '>'
        return width, height, struct.unpack(f'{order}{3 * width * height}f', file.read())


def check_view(name, image, reference):
    width, height, values = read_pfm(reference)
    worst, count = 0, 0
    for y in range(height):
        for x in range(width):
            wanted = values[3 * (y * width + x):3 * (y * width + x) + 3]
            s, t = 2 * (x + 0.5) / width - 1, 2 * (y + 0.5) / height - 1
            if wanted == (0, 0, 0) or name in ('sphere', 'angular') and math.hypot(s, t) > 1 - 2 / width:
                continue  # Beside the faces, and the rim.
            worst, count = max([worst] + [abs(f - w) for f, w in zip(pixel(image, width, x, y), wanted)]), count + 1
    expect(worst < WITHIN and count > 0.4 * width * height, f'{name}: off by {worst} in {count} pixels')


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    return [x / math.sqrt(dot(a, a)) for x in a]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def camera(yaw, pitch):
    """Forward, right, up: turned from +Z towards +X, then up."""
    y, p = math.radians(yaw), math.radians(pitch)
    forward = [math.sin(y) * math.cos(p), math.sin(p), math.cos(y) * math.cos(p)]
    right = unit(cross(forward, [0, 1, 0]))
    return forward, right, cross(right, forward)


def ray(x, y, axes, fov):
    """Of a place in half heights of the canvas."""
    forward, right, up = axes
    k = math.tan(math.radians(fov / 2))
    return unit([f + k * (x * r + y * u) for f, r, u in zip(forward, right, up)])


def check_camera(result):
    axes = camera(30, 20)
    for x, y in [(0, 0), (95, 0), (48, 32), (20, 50)]:
        d = ray((2 * x + 1 - 96) / 64, (2 * y + 1 - 64) / 64, axes, 60)
        expect_colour(pixel(result['camera'], 96, x, y), [(c + 1) / 2 for c in d], f'camera at {x}, {y}')
    d = ray((2 * 10.5 - 96) / 64, (2 * 20.5 - 64) / 64, axes, 60)
    expect(max(abs(a - b) for a, b in zip(result['picked']['direction'], d)) < 1e-5, f'picked {result["picked"]}, not {d}')
    expect_colour(result['picked']['radiance'], [(c + 1) / 2 for c in d], 'picked radiance')


def schlick(cosine):
    return 0.04 + 0.96 * (1 - cosine) ** 5


def check_balls(image):
    axes = camera(30, 20)
    for middle, reflected in [((0.2, 0.1), lambda cosine: 1), ((-0.8, 0), lambda cosine: 0), ((0.9, 0), schlick)]:
        away = ray(*middle, axes, 60)
        side = unit([r - dot(axes[1], away) * a for r, a in zip(axes[1], away)])
        for dx, dy in [(0, 0), (5, 3), (-6, 2), (1, -7)]:
            x, y = round(48 + 32 * middle[0]) + dx, round(32 + 32 * middle[1]) + dy
            s, t = ((2 * x + 1 - 96) / 64 - middle[0]) / 0.3, ((2 * y + 1 - 64) / 64 - middle[1]) / 0.3
            normal = [s * a + t * b - math.sqrt(1 - s * s - t * t) * c for a, b, c in zip(side, cross(side, away), away)]
            mirrored = [a - 2 * dot(away, normal) * n for a, n in zip(away, normal)]
            part = reflected(-dot(away, normal))
            wanted = [part * (c + 1) / 2 + (1 - part) * (0.5 + n / 3) for c, n in zip(mirrored, normal)]
            expect_colour(pixel(image, 96, x, y), wanted, f'ball at {middle}, {dx}, {dy}')


def check_blur(image):
    """GGX of roughness 0.5 with n = v = r keeps 1 and shrinks directions by a factor: D(h) cos(l) for l at twice h's angle."""
    steps, alpha2 = 20000, 0.5 ** 4
    whole = along = 0.0
    for k in range(steps):
        angle = (k + 0.5) / steps * math.pi / 2
        weight = math.cos(angle) * math.sin(angle) / (math.cos(angle / 2) ** 2 * (alpha2 - 1) + 1) ** 2
        whole, along = whole + weight, along + weight * math.cos(angle)
    axes = camera(30, 20)
    for x, y in [(0, 0), (95, 0), (48, 32), (20, 50)]:
        d = ray((2 * x + 1 - 96) / 64, (2 * y + 1 - 64) / 64, axes, 60)
        expect_colour(pixel(image, 96, x, y), [(c * along / whole + 1) / 2 for c in d], f'blurred background at {x}, {y}')


def check_handling(result):
    expect(result['failure'] == '', result['failure'])
    expect(result['unlabelled'] == 0, f'{result["unlabelled"]} controls without a label')
    expect(result['yaw'] == -5, f'arrow key: yaw {result["yaw"]}')
    expect(abs(result['fov'] - 54) < 1e-9, f'+: fov {result["fov"]}')
    expect(abs(result['keyed'] - 0.15) < 1e-9, f'shift and arrow key: ball at {result["keyed"]}')
    expect(abs(result['dragged'] - 0.5) < 0.02, f'drag: ball at {result["dragged"]}')
    expect(result['turned'] > -5, f'drag to the right: yaw {result["turned"]}')
    expect(0.2 < result['pinched'] < 0.8, f'two fingers apart: {result["pinched"]}')


def check_bright(envmap, folder):
    """Beyond what RGB9E5 holds, all is divided by a power of 2; decoded here by the definition of the format."""
    subprocess.run([envmap, 'generate', 'sun', 'sun.exr', '--size', '32', '--value', '5e5,2e5,1e5', '--radius', '20', '--depth',
                    'float', '--direction', '1,0,0'], cwd=folder, check=True)
    subprocess.run([envmap, 'preview', 'sun.exr', '--html', 'sun.html', '--size', '16', '-q'], cwd=folder, check=True)
    data = json.loads(re.search(r'id="data">(.*?)</script>', (folder / 'sun.html').read_text(), re.S)[1])
    level = data['textures']['map']['levels'][0]
    word, = struct.unpack_from('<I', base64.b64decode(level['texels']), 4 * (8 * 16 + 8))  # The middle of +X.
    value = [(word >> 9 * k & 511) * 2.0 ** ((word >> 27) - 24) * data['scale'] for k in range(3)]
    expect(max(abs(v - w) for v, w in zip(value, (5e5, 2e5, 1e5))) < 5e5 / 512, f'a sun of 5e5 is {value}')


def browse(envmap, folder):
    run = lambda *words: subprocess.run([envmap, *words], cwd=folder, check=True)
    turned = {'latlong': ('-z', 180), 'angular': ('+x', 90)}
    run('generate', 'directions', 'in.exr', '--to', 'cube', '--size', '64')
    run('preview', 'in.exr', '--html', 'page.html', '--exposure', '0', '--display', 'clip', '--size', '64', '-q')
    for name in VIEWS:
        more = ['--layout', 'cross'] if name == 'cube' else ['--forward', turned[name][0]] if name in turned else []
        run('generate', 'directions', f'{name}.pfm', '--to', name, '--size', str(SIZE), *more)
    page = (folder / 'page.html').read_text()
    expect(not re.search(r'(src|href)\s*=|https?:', page), 'the page names another file')
    views = json.dumps({name: [*how, turned.get(name, ('', 0))[1]] for name, how in VIEWS.items()})
    (folder / 'page.html').write_text(
        page.replace('</body>', f'<script>const VIEWS = {views}, SIZE = {SIZE};{PROBE}</script></body>'))
    done = subprocess.run(['chromium', '--headless=new', '--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader',
                           '--enable-unsafe-swiftshader', f'--user-data-dir={folder}/profile', '--window-size=600,500', '--dump-dom',
                           (folder / 'page.html').as_uri()], capture_output=True, text=True, timeout=110)
    found = re.search(r'<pre id="result">(.*?)</pre>', done.stdout, re.S)
    failure = re.search(r'<p id="failure".*?</p>', done.stdout, re.S)
    return json.loads(found[1]) if found else sys.exit(f'page: nothing was drawn: {failure and failure[0]} {done.stderr[-600:]}')


def main():
    envmap = str(pathlib.Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        check_bright(envmap, folder)
        if not shutil.which('chromium'):
            print('\n'.join(failures) or 'page: no chromium: not looked at in a browser')
            return 1 if failures else 77
        result = browse(envmap, folder)
        for view, image in result['views'].items():
            check_view(view, image, folder / f'{view}.pfm')
    check_camera(result)
    check_balls(result['balls'])
    check_blur(result['blurred'])
    check_handling(result)
    print('\n'.join(failures) or 'page: 7 views, camera, balls, blur, readings, keys and pointers are right')
    return 1 if failures else 0


sys.exit(main())

"""The Python module against formulae of numpy's own, and what it draws against the command."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import threading

import envmap
import numpy as np
import pytest


def latlong_directions(height):
    """Unit vectors at texel centres, +Y up, +Z in the middle."""
    v, u = np.meshgrid((np.arange(height) + 0.5) / height, (np.arange(2 * height) + 0.5) / (2 * height), indexing='ij')
    longitude, latitude = (0.5 - u) * 2 * np.pi, (0.5 - v) * np.pi
    return np.stack([np.cos(latitude) * np.sin(longitude), np.sin(latitude), np.cos(latitude) * np.cos(longitude)], -1)


def latlong_weights(height):
    edges = np.cos(np.pi * np.arange(height + 1) / height)
    return np.repeat(((edges[:-1] - edges[1:]) * np.pi / height)[:, None], 2 * height, 1)


def cube_directions(size):
    s, t = np.meshgrid((2 * np.arange(size) + 1) / size - 1, 1 - (2 * np.arange(size) + 1) / size)
    one = np.ones_like(s)
    faces = [(one, t, s), (-one, t, -s), (s, one, t), (s, -one, -t), (-s, t, one), (s, t, -one)]
    d = np.stack([np.stack(f, -1) for f in faces])
    return d / np.linalg.norm(d, axis=-1, keepdims=True)


def noise(height, seed=1):
    return np.random.default_rng(seed).uniform(0.1, 2, (height, 2 * height, 3)).astype(np.float32)


def test_solid_angles_are_those_of_the_sphere():
    np.testing.assert_allclose(envmap.solid_angles('latlong', 33), latlong_weights(33), rtol=1e-12)
    for projection, faces in (('cube', 6), ('sphere', 1), ('paraboloid', 2), ('angular', 1), ('octahedral', 1), ('equal-area', 1)):
        assert faces * envmap.solid_angles(projection, 20).sum() == pytest.approx(4 * np.pi, rel=1e-12)


def test_directions_are_where_the_manual_says():
    for projection, d in (('latlong', latlong_directions(16)), ('cube', cube_directions(12))):
        made = envmap.generate('directions', projection, d.shape[-3])
        np.testing.assert_allclose(made.array, (d + 1) / 2, atol=1e-6)


def test_arrays_are_views_of_the_map():
    made = envmap.generate('constant', 'cube', 8, radiance=(1, 2, 3))
    assert made.array.shape == (6, 8, 8, 3) and made.array.dtype == np.float32
    made.array[3, 2, 1] = (7, 8, 9)
    assert np.shares_memory(made.array, made.array)
    np.testing.assert_array_equal(np.asarray(made)[3, 2, 1], (7, 8, 9))
    view = made.array
    del made  # The view keeps the texels.
    assert view[3, 2, 1, 2] == 9


def test_arrays_in_any_layout_come_back():
    a = noise(10)
    for given in (a, np.asfortranarray(a), a.astype(np.float64), np.repeat(a, 2, 1)[:, ::2], a.tolist()):
        np.testing.assert_array_equal(envmap.Map(given).array, a)
    cube = np.random.default_rng(2).uniform(size=(6, 5, 5, 3)).astype(np.float32)
    assert envmap.Map(cube).projection == 'cube'
    np.testing.assert_array_equal(envmap.Map(cube).array, cube)


def test_conversion_is_bilinear_between_centres():
    source, height = noise(16), 16
    made = envmap.convert(source, 'cube', size=7, filter='bilinear').array
    d = cube_directions(7)
    u = 0.5 - np.arctan2(d[..., 0], d[..., 2]) / (2 * np.pi)
    v = 0.5 - np.arctan2(d[..., 1], np.hypot(d[..., 0], d[..., 2])) / np.pi
    x, y = u * 2 * height - 0.5, v * height - 0.5
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    inside = (j >= 0) & (j < height - 1)  # Not over the poles.
    assert inside.mean() > 0.9
    fx, fy = (x - i)[..., None], (y - j)[..., None]
    at = lambda b, a: source[np.clip(b, 0, height - 1), a % (2 * height)]
    wanted = (1 - fy) * ((1 - fx) * at(j, i) + fx * at(j, i + 1)) + fy * ((1 - fx) * at(j + 1, i) + fx * at(j + 1, i + 1))
    np.testing.assert_allclose(made[inside], wanted[inside], rtol=2e-5)


def test_diffuse_map_is_the_sum_over_all_texels():
    source = noise(24)
    done = envmap.prefilter(source, 'diffuse', size=4, max_error=1e-5)
    # The cosine over a texel is not that at its centre: finer texels of the same map.
    k = 4
    fine, fine_d, fine_w = np.repeat(np.repeat(source, k, 0), k, 1), latlong_directions(24 * k), latlong_weights(24 * k)
    cosine = np.maximum(0, np.einsum('fijc,hwc->fijhw', cube_directions(4), fine_d))
    wanted = np.einsum('fijhw,hw,hwc->fijc', cosine, fine_w, fine.astype(np.float64)) / np.pi
    np.testing.assert_allclose(done.map.array, wanted, rtol=5e-4)
    assert done.error <= 1e-5 and done.method in ('exact', 'treecode', 'prefix-sums', 'multilevel')


def test_harmonics_are_integrals():
    source, k = noise(16), 8
    d, w = latlong_directions(16 * k), latlong_weights(16 * k)
    x, y, z = d[..., 0], d[..., 1], d[..., 2]
    c = np.sqrt([1 / (4 * np.pi), 3 / (4 * np.pi), 15 / (4 * np.pi), 5 / (16 * np.pi), 15 / (16 * np.pi)])
    basis = np.stack([c[0] + 0 * x, c[1] * x, c[1] * y, c[1] * z, c[2] * x * z, c[2] * x * y, c[3] * (3 * y * y - 1), c[2] * y * z,
                      c[4] * (z * z - x * x)])
    fine = np.repeat(np.repeat(source, k, 0), k, 1).astype(np.float64)
    wanted = np.einsum('nhw,hw,hwc->nc', basis, w, fine)
    np.testing.assert_allclose(envmap.sh(source), wanted, atol=2e-3)
    factors = np.array([np.pi] + 3 * [2 * np.pi / 3] + 5 * [np.pi / 4])[:, None]
    np.testing.assert_allclose(envmap.sh(source, irradiance=True), envmap.sh(source) * factors, rtol=1e-12)


def test_levels_keep_the_light():
    made = envmap.mipmap(noise(16))
    assert [level.shape for level in made.levels] == [(16, 32, 3), (8, 16, 3), (4, 8, 3), (2, 4, 3), (1, 2, 3), (1, 1, 3)]
    flux = [(latlong_weights(h)[..., None] * level).sum((0, 1)) for h, level in zip((16, 8, 4, 2, 1), made.levels)]
    np.testing.assert_allclose(flux, np.repeat(flux[:1], 5, 0), rtol=1e-6)


def test_compare_has_the_metrics_of_the_manual():
    a, b, w = noise(12, 1), noise(12, 2), latlong_weights(12)[..., None]
    found = envmap.compare(a, b)
    a, b = a.astype(np.float64), b.astype(np.float64)
    assert found.rms == pytest.approx(np.sqrt((w * (a - b) ** 2).sum() / (w * b ** 2).sum()), rel=1e-9)
    floor = 1e-3 * (w * b).sum() / (3 * 4 * np.pi)
    assert found.max == pytest.approx((np.abs(a - b) / np.maximum(np.abs(b), floor)).max(), rel=1e-9)
    np.testing.assert_allclose(found.flux, (w * a).sum((0, 1)) / (w * b).sum((0, 1)) - 1, rtol=1e-8)


def test_files_come_back(tmp_path):
    a = noise(8)
    for name in ('a.exr', 'a.pfm', 'a.ktx2', 'a.tif'):
        envmap.write(str(tmp_path / name), a, facts={'lobe': 'diffuse'})
        np.testing.assert_array_equal(envmap.read(str(tmp_path / name)).array, a)
    envmap.write(str(tmp_path / 'c_{face}.exr'), envmap.convert(a, 'cube'), depth='half')
    assert envmap.read(str(tmp_path / 'c_{face}.exr')).array.dtype == np.float32
    cube = envmap.convert(a, 'cube')
    envmap.write(str(tmp_path / 'q{face}.exr'), cube, faces='quake')
    assert (tmp_path / 'qrt.exr').exists()
    assert np.array_equal(envmap.read(str(tmp_path / 'q{face}.exr'), faces='quake').array, cube.array)


def test_interrupts_stay_python_s(tmp_path):
    """A file that is replaced has a temporary name, which a signal removes; Python's own handlers are not given up for that."""
    program = """if True:
        import envmap, os, signal
        for _ in range(2):
            envmap.write('a.exr', envmap.generate('sky', size=8))
        try:
            os.kill(os.getpid(), signal.SIGINT)
            while True: pass
        except KeyboardInterrupt:
            print('interrupted')"""
    done = subprocess.run([sys.executable, '-c', program], cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, 'interrupted\n'), done


def test_errors_are_one_line(tmp_path):
    with pytest.raises(envmap.InputError, match='none.hdr') as found:
        envmap.read(str(tmp_path / 'none.hdr'))
    assert isinstance(found.value, OSError) and isinstance(found.value, envmap.Error) and '\n' not in str(found.value)
    with pytest.raises(envmap.UsageError, match='cubes.* none of latlong, cube'):
        envmap.convert(noise(4), 'cubes')
    with pytest.raises(ValueError, match='projection='):
        envmap.Map(np.ones((4, 4, 3)))
    with pytest.raises(envmap.InputError, match='NaN'):
        envmap.Map(np.full((4, 8, 3), np.nan))
    with pytest.raises(envmap.OutputError, match='65504.*clamp=True'):
        envmap.write(str(tmp_path / 'a.exr'), np.full((4, 8, 3), 1e6), depth='half')
    with pytest.raises(envmap.UsageError, match='roughness='):
        envmap.prefilter(noise(4), 'ggx')
    with pytest.raises(envmap.UsageError, match='no parameter radius'):
        envmap.generate('sky', radius=3)
    for kind, given, words in (('checker', {'squares': 2.5}, 'squares must be a whole number'), ('sky', {'zenith': 'a'}, 'zenith must be'),
                               ('sun', {'direction': (1, 2)}, 'direction must be three numbers'),
                               ('checker', {'squares': 10**12}, 'squares must be')):
        with pytest.raises(envmap.UsageError, match=words):
            envmap.generate(kind, **given)
    for zenith in (np.float32(2), 2, [2, 2, 2], np.full(3, 2)):
        assert envmap.generate('sky', size=4, zenith=zenith).array.max() <= 2


def test_tables_are_lobes_of_files_and_of_arrays(tmp_path):
    cosines = np.linspace(0, 1, 60)
    (tmp_path / 'lobe.txt').write_text(''.join(f'{c} {c**4}\n' for c in cosines))
    of_array = envmap.prefilter(noise(16), table=np.stack([cosines, cosines**4], 1), size=4)
    of_file = envmap.prefilter(noise(16), table=tmp_path / 'lobe.txt', size=4)
    assert of_file.lobe == 'table' and of_file.method == 'treecode' and 0 < of_file.error <= 1e-3
    np.testing.assert_array_equal(of_file.map.array, of_array.map.array)
    np.testing.assert_allclose(of_file.map.array, envmap.prefilter(noise(16), 'phong', exponent=4, size=4).map.array, rtol=5e-3)
    with pytest.raises(envmap.UsageError, match="leave out lobe='ggx'"):
        envmap.prefilter(noise(16), 'ggx', table=[(1, 1), (0, 0)])
    with pytest.raises(envmap.UsageError, match='neither exponent nor roughness'):
        envmap.prefilter(noise(16), table=[(1, 1), (0, 0)], roughness=0.5)
    with pytest.raises(envmap.UsageError, match='two samples or more'):
        envmap.prefilter(noise(16), table=[(1, 1)])
    with pytest.raises(envmap.InputError, match='none.txt'):
        envmap.prefilter(noise(16), table=tmp_path / 'none.txt')


def test_faces_are_those_of_a_cube():
    colours = np.array([(1, 0, 0), (0, 1, 1), (0, 1, 0), (1, 0, 1), (0, 0, 1), (1, 1, 0)], np.float32)
    np.testing.assert_array_equal(envmap.generate('faces', 'cube', 4).array, np.broadcast_to(colours[:, None, None], (6, 4, 4, 3)))


def test_atmospheres_are_those_of_the_command(tmp_path):
    made = envmap.generate('atmosphere', size=32, direction=(0, 1, 1), turbidity=4, ground=0.1, scattering='single')
    command(tmp_path, 'generate', 'atmosphere', 'a.exr', '--size', '32', '--elevation', '45', '--turbidity', '4',
            '--ground', '0.1,0.1,0.1', '--scattering', 'single', '--depth', 'float')
    np.testing.assert_allclose(made.array, envmap.read(str(tmp_path / 'a.exr')).array, rtol=1e-6)
    with pytest.raises(envmap.UsageError, match='no parameter zenith'):
        envmap.generate('atmosphere', zenith=1)


def test_photos_of_a_mirror_ball_are_unwrapped():
    # Every texel holds the direction that a camera 4 radii away sees in it: the law of sines.
    n, distance = 400, 4.0
    s, t = np.meshgrid((2 * np.arange(n) + 1) / n - 1, 1 - (2 * np.arange(n) + 1) / n)
    r = np.minimum(np.hypot(s, t), 1)
    a = np.arctan(r * np.tan(np.arcsin(1 / distance)))
    angle = 2 * np.arcsin(distance * np.sin(a)) - a
    d = np.stack([np.sin(angle) * s / r, np.sin(angle) * t / r, np.cos(angle)], -1)
    photo = envmap.Map((d + 1) / 2, 'sphere')
    wanted = latlong_directions(32)
    seen = wanted[..., 2] > -0.9
    for how in ({'ball_distance': distance}, {'ball_fov': np.degrees(2 * np.arcsin(1 / distance))}):
        made = envmap.convert(photo, 'latlong', size=32, filter='bilinear', **how)
        np.testing.assert_allclose((2 * made.array - 1)[seen], wanted[seen], atol=0.01)
    with pytest.raises(envmap.UsageError, match='1.02'):
        envmap.convert(photo, 'latlong', ball_distance=0.5)
    with pytest.raises(envmap.UsageError, match='sphere'):
        envmap.convert(noise(4), 'cube', ball_distance=4)


@pytest.fixture
def scene(tmp_path):
    """Two glowing triangles round a ball's node, and a floor that a light shines on."""
    floor = np.array([(-9, -1, -9), (-9, -1, 9), (9, -1, -9), (9, -1, 9), (2, 0, -1), (2, 0, 1), (2, 2, 0)], np.float32)
    indices = np.array([0, 1, 2, 2, 1, 3, 4, 5, 6, 4, 6, 5], np.uint16)
    (tmp_path / 'data.bin').write_bytes(floor.tobytes() + indices.tobytes())
    views = [{'buffer': 0, 'byteOffset': 0, 'byteLength': floor.nbytes},
             {'buffer': 0, 'byteOffset': floor.nbytes, 'byteLength': indices.nbytes}]
    accessors = [{'bufferView': 0, 'componentType': 5126, 'count': 7, 'type': 'VEC3', 'min': [-9, -1, -9], 'max': [9, 2, 9]},
                 {'bufferView': 1, 'componentType': 5123, 'count': 6, 'type': 'SCALAR'},
                 {'bufferView': 1, 'byteOffset': 12, 'componentType': 5123, 'count': 6, 'type': 'SCALAR'}]
    meshes = [{'primitives': [{'attributes': {'POSITION': 0}, 'indices': k, 'material': k - 1}]} for k in (1, 2)]
    path = tmp_path / 'scene.gltf'
    path.write_text(json.dumps({
        'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': [0, 1]}],
        'nodes': [{'name': 'floor', 'mesh': 0}, {'name': 'flag', 'mesh': 1}], 'meshes': meshes,
        'materials': [{}, {'emissiveFactor': [1, 0.5, 0.25]}], 'accessors': accessors, 'bufferViews': views,
        'buffers': [{'uri': 'data.bin', 'byteLength': floor.nbytes + indices.nbytes}]}))
    return path


def command(folder, *words):
    subprocess.run([os.environ['ENVMAP_PROGRAM'], *words, '--quiet'], cwd=folder, check=True)


def test_render_is_what_the_command_draws(tmp_path, scene):
    sky = envmap.generate('sky', 'latlong', 16)
    envmap.write(tmp_path / 'sky.exr', sky, depth='float')
    cases = [({'to': 'cube', 'size': 16, 'environment': sky, 'method': 'raycast'},
              ['--size', '16', '--environment', 'sky.exr', '--method', 'raycast']),
             ({'to': 'latlong', 'size': 16, 'ambient': (1, 2, 3), 'at': (0, 1, 0.5), 'forward': '-z', 'samples': 4, 'method': 'raycast'},
              ['--to', 'latlong', '--size', '16', '--ambient', '1,2,3', '--at', '0,1,0.5', '--forward', '-z', '--samples', '4', '--method',
               'raycast']),
             ({'to': 'sphere', 'size': 16, 'at': 'flag', 'forward': 'floor', 'environment': sky, 'occlusion': 0, 'method': 'raycast'},
              ['--to', 'sphere', '--size', '16', '--at', 'flag', '--forward', 'floor', '--environment', 'sky.exr', '--occlusion', '0',
               '--method', 'raycast']),
             ({'to': 'paraboloid', 'size': 16, 'environment': sky, 'method': 'exact'},
              ['--to', 'paraboloid', '--size', '16', '--environment', 'sky.exr', '--method', 'exact'])]
    for options, words in cases:
        made = envmap.render(scene, **options)
        command(tmp_path, 'render', 'scene.gltf', 'command.exr', '--depth', 'float', *words)
        read = envmap.read(tmp_path / 'command.exr')
        assert made.projection == read.projection and made.forward == read.forward
        np.testing.assert_array_equal(made.array, read.array, err_msg=' '.join(words))
        assert made.array.max() > 0.1 and made.array.std() > 0.01


def test_render_says_what_is_wrong(tmp_path, scene):
    with pytest.raises(envmap.InputError, match='none.glb') as found:
        envmap.render(tmp_path / 'none.glb')
    assert '\n' not in str(found.value)
    for options, words in (({'at': 'nobody'}, "'nobody' is no node"), ({'method': 'fast'}, 'none of auto, exact'),
                           ({'forward': '+x'}, 'latlong and angular'), ({'forward': 'camera'}, 'no camera'),
                           ({'near': 2, 'far': 1}, 'near'), ({'to': 'latlong', 'method': 'distort'}, 'cannot draw'),
                           ({'size': 0}, 'size'), ({'at': (0, float('nan'), 0)}, 'at must be finite'),
                           ({'time': float('inf')}, 'time_seconds must be'), ({'at': (0, 0, 0), 'forward': (0, 0, 0)}, 'forward must be')):
        with pytest.raises(envmap.UsageError, match=words):
            envmap.render(scene, **{'size': 8, **options})
    text = json.loads(scene.read_text())
    text['materials'] = [{}, {}]
    scene.write_text(json.dumps(text))
    with pytest.warns(UserWarning, match='black'):
        assert envmap.render(scene, size=4, method='raycast').array.max() == 0


def test_view_is_what_the_command_draws(tmp_path, scene):
    sky = envmap.generate('sky', 'latlong', 16)
    envmap.write(tmp_path / 'sky.exr', sky, depth='float')
    sides = {'width': 24, 'height': 24}
    cases = [({'method': 'raycast'}, ['--method', 'raycast']),
             ({'method': 'raycast', 'camera': (1, 2, 3), 'fov': 50, 'mirrors': {'flag': None}, 'bounces': 2},
              ['--method', 'raycast', '--camera', '1,2,3', '--fov', '50', '--mirror', 'flag', '--bounces', '2']),
             ({'mirrors': {'flag': 'cube'}, 'look_at': (0, 0, 0)}, ['--mirror', 'flag:cube', '--look-at', '0,0,0']),
             ({'mirrors': {'flag': 'off'}, 'samples': 1}, ['--mirror', 'flag:off', '--samples', '1']),
             ({'reflection': 'sampled'}, ['--reflection', 'sampled']),
             ({'mirrors': {'flag': None}, 'max_error': 1e-5}, ['--mirror', 'flag', '--max-error', '1e-5'])]
    (tmp_path / 'maps').mkdir()
    for options, words in cases:
        seen = envmap.view(scene, environment=sky, **sides, **options)
        saved = [] if 'raycast' in words or '--max-error' in words else ['--save-maps', 'maps']
        command(tmp_path, 'view', 'scene.gltf', 'view.exr', '--environment', 'sky.exr', '--width', '24', '--height', '24', *saved, *words)
        picture = envmap.read(tmp_path / 'view.exr', projection='equal-area')  # Any square will do.
        np.testing.assert_array_equal(seen.array, picture.array, err_msg=' '.join(words))
        assert seen.array.std() > 0.01 and seen.array.shape == (24, 24, 3)
        assert (seen.error is not None) == ('max_error' in options)
        assert list(seen.mirrors) == (['flag'] if options.get('mirrors') == {'flag': 'cube'} else list(seen.mirrors))
        if saved and seen.mirrors:
            np.testing.assert_array_equal(seen.mirrors['flag'].array, envmap.read(tmp_path / 'maps' / 'flag.exr').array)


def test_view_tells_mirrors_of_one_name_apart(scene):
    text = json.loads(scene.read_text())
    text['materials'] = [{'doubleSided': True, 'pbrMetallicRoughness': {'metallicFactor': 1, 'roughnessFactor': 0}}] * 2
    for name, keys in (('flag', ['flag', 'flag (node 1)']), ('', ['node 0', 'node 1'])):
        for node in text['nodes']:
            node['name'] = name
        scene.write_text(json.dumps(text))
        assert list(envmap.view(scene, width=16, height=16, ambient=(1, 1, 1)).mirrors) == keys


def test_view_says_what_is_wrong(tmp_path, scene):
    for options, words in (({'camera': 'nobody'}, "camera 'nobody' is neither"), ({'mirrors': {'nobody': None}}, "'nobody' is no node"),
                           ({'mirrors': {'flag': 'latlong'}}, 'sphere, paraboloid or cube'), ({'mirrors': {3: 'off'}}, 'name of a node'),
                           ({'time': 2e6}, 'time_seconds'), ({'look_at': (0, 0, float('inf'))}, 'look_at must be finite'),
                           ({'width': 0}, 'width'), ({'fov': 180}, 'field'),
                           ({'method': 'fast'}, 'none of maps, raycast'), ({'method': 'raycast', 'max_error': .1}, 'max_error'),
                           ({'maps': 'angular'}, 'sphere, paraboloid or cube'), ({'max_error': float('nan')}, 'max_error')):
        with pytest.raises(envmap.UsageError, match=words):
            envmap.view(scene, **{'width': 8, 'height': 8, **options})
    with pytest.raises(envmap.InputError, match='none.glb'):
        envmap.view(tmp_path / 'none.glb')


def test_the_readme_runs(tmp_path, monkeypatch):
    top = pathlib.Path(__file__).parents[2]
    script = (top / 'README.md').read_text().split('```python\n')[1].split('```')[0]
    subprocess.run([sys.executable, top / 'samples/scenes/make.py', tmp_path], check=True, stdout=subprocess.DEVNULL)
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'samples').mkdir()
    shutil.copy(top / 'samples/sample.hdr', 'samples')
    found = {}
    exec(script.replace('"latlong", at', '"latlong", size=32, at'), found)  # A small picture of it.
    assert found['room'].array.shape == (32, 64, 3) and found['coefficients'].shape == (9, 3)
    assert (tmp_path / 'ggx.exr').exists()


def test_progress_is_told_and_ends_the_work():
    told = []
    envmap.prefilter(noise(16), 'phong', exponent=20, size=16, progress=told.append)
    assert told and 0 <= min(told) and max(told) <= 1

    def stop(_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        envmap.convert(noise(32), 'cube', size=64, filter='area', progress=stop)


def test_other_threads_run_meanwhile():
    steps, done = [0], threading.Event()

    def count():
        while not done.is_set():
            steps[0] += 1

    thread = threading.Thread(target=count)
    thread.start()
    before = steps[0]
    envmap.prefilter(noise(32), 'diffuse', size=6, method='exact')
    counted = steps[0] - before
    done.set()
    thread.join()
    assert counted > 100

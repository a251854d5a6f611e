"""What callers of the Python module rely on: errors, memory, chains, signatures, stubs, pickling."""
import copy
import errno
import json
import os
import pathlib
import pickle
import subprocess
import sys
import time

import envmap
import numpy as np
import pytest


def cube(size=8, seed=3):
    return np.random.default_rng(seed).uniform(0.1, 2, (6, size, size, 3)).astype(np.float32)


NAN = np.full((4, 8, 3), np.nan)


@pytest.mark.parametrize('bad, words', [
    (NAN, 'NaN'), (np.zeros((10, 17, 3)), 'twice as wide'), (np.zeros((4, 8, 4)), '(height, width, 3)'), (np.zeros(3), 'height'),
    (np.zeros((0, 0, 3)), 'height'), ('abc', "not 'abc'"), (b'abc' * 1000000, 'not bytes'), (None, 'not None'), ({}, 'not dict'),
    (-np.ones((4, 8, 3)), 'negative'), (np.zeros((5, 4, 4, 3)), 'shape'), (np.full((4, 8, 3), 'x'), 'no radiance'), (np.zeros((6, 4, 4, 4)), 'array[..., :3]'),
    (np.zeros((2, 4, 4, 3)), 'projection=')])
def test_bad_arrays_are_one_line_everywhere(bad, words):
    good = np.ones((4, 8, 3))
    for call in (lambda: envmap.convert(bad, 'cube'), lambda: envmap.mipmap(bad), lambda: envmap.prefilter(bad), lambda: envmap.sh(bad),
                 lambda: envmap.compare(bad, good), lambda: envmap.compare(good, bad), lambda: envmap.write('x.exr', bad),
                 lambda: envmap.encode(bad, 'exr'), lambda: envmap.pack(bad)):
        with pytest.raises(envmap.Error) as found:
            call()
        text = str(found.value)
        assert words in text and '\n' not in text and len(text) < 150


@pytest.mark.parametrize('call, field', [
    (lambda m: envmap.convert(m, size=0), 'size'), (lambda m: envmap.convert(m, gain=float('nan')), 'gain'),
    (lambda m: envmap.convert(m, samples=0), 'samples'), (lambda m: envmap.convert(m, max_error=-1), 'max_error'),
    (lambda m: envmap.prefilter(m, size=-1), 'size'), (lambda m: envmap.prefilter(m, max_error=0), 'max_error'),
    (lambda m: envmap.prefilter(m, 'ggx', roughness=2), 'roughness'), (lambda m: envmap.prefilter(m, 'phong', exponent=-1), 'exponent'),
    (lambda m: envmap.sh(m, -1), 'order'), (lambda m: envmap.mipmap(m, levels=-1), 'levels'),
    (lambda m: envmap.generate('sky', size=0), 'size'), (lambda m: envmap.solid_angles('cube', 0), 'size'),
    (lambda m: envmap.read('none.exr', level=-1), 'level'), (lambda m: envmap.generate('atmosphere', turbidity=11), 'turbidity'),
    (lambda m: envmap.limit_threads(-1), 'threads')])
def test_values_out_of_range_name_their_field(call, field):
    with pytest.raises(envmap.UsageError, match=f'{field} must be .* to ') as found:
        call(envmap.generate('sky', size=8))
    assert found.value.field == field and found.value.code == 'usage' and isinstance(found.value, ValueError)


def test_errors_have_fields(tmp_path):
    with pytest.raises(OSError) as found:
        envmap.read(tmp_path / 'none.exr')
    e = found.value
    assert (e.code, e.file, e.filename, e.errno, e.remedy) == ('input', str(tmp_path / 'none.exr'), str(tmp_path / 'none.exr'), errno.ENOENT, 'none')
    assert str(e) == f'{tmp_path / "none.exr"}: no such file'
    with pytest.raises(envmap.InputError) as found:
        envmap.read(tmp_path)
    assert found.value.errno == errno.EISDIR
    (tmp_path / 'junk.exr').write_bytes(b'junk')
    with pytest.raises(envmap.InputError) as found:
        envmap.read(tmp_path / 'junk.exr')
    assert found.value.errno is None and found.value.file.endswith('junk.exr')
    with pytest.raises(envmap.OutputError) as found:
        envmap.write(tmp_path / 'a.exr', np.full((4, 8, 3), 1e6), depth='half')
    assert found.value.remedy == 'clamp_or_deepen' and found.value.code == 'output'
    with pytest.raises(envmap.InputError) as found:
        envmap.read(b'')
    assert found.value.file is None
    again = pickle.loads(pickle.dumps(found.value))
    assert type(again) is envmap.InputError and str(again) == str(found.value)
    for call in (lambda: envmap.read(tmp_path / 'none.exr'), lambda: envmap.render(tmp_path / 'none.glb'),
                 lambda: envmap.view(tmp_path / 'none.obj'), lambda: envmap.write(tmp_path / 'none' / 'a.exr', np.ones((4, 8, 3)))):
        with pytest.raises(OSError) as found:
            call()
        again = pickle.loads(pickle.dumps(found.value))
        for field in ('code', 'file', 'filename', 'errno', 'remedy', 'field'):
            assert getattr(again, field) == getattr(found.value, field), field
        assert again.file and again.filename == again.file and str(again) == str(found.value)
    with pytest.raises(OSError) as found:
        envmap.render(tmp_path / 'none.glb')
    assert (found.value.file, found.value.errno) == (str(tmp_path / 'none.glb'), errno.ENOENT)


@pytest.mark.parametrize('kind', ['uint8', 'uint16', 'int64', 'bool', 'complex128', '<U3', '<M8[s]'])
def test_only_floats_are_radiance(kind):
    for given in (np.ones((4, 8, 3)).astype(kind), np.ones((4, 8, 3)).astype(kind).astype(object)):
        if kind == '<M8[s]' and given.dtype == object:
            continue
        for call in (envmap.Map, envmap.mipmap, lambda a: envmap.Map(levels=[a])):
            with pytest.raises(envmap.UsageError, match='no radiance'):
                call(given)
    with pytest.raises(envmap.UsageError, match=r"uint8 is no radiance: decode it to linear floats; .astype\('float32'\)"):
        envmap.Map(np.ones((4, 8, 3), np.uint8))


def test_floats_of_every_kind_are_radiance():
    a = np.random.default_rng(1).uniform(0.5, 1, (4, 8, 3)).astype(np.float16)
    for kind in ('f2', 'f4', 'f8', '>f4', 'longdouble', object):
        np.testing.assert_array_equal(envmap.Map(a.astype(kind)).array, a.astype(np.float32))
    np.testing.assert_array_equal(envmap.Map(np.ma.masked_less(a, 0)).array, a.astype(np.float32))
    with pytest.raises(envmap.UsageError, match=r'masked array .*\.filled'):
        envmap.Map(np.ma.masked_less(a, 0.75))


def test_two_square_images_are_a_map_only_by_name():
    pair = np.ones((2, 4, 4, 3))
    with pytest.raises(envmap.UsageError, match='a paraboloid map or two images: say which by projection='):
        envmap.Map(pair)
    assert envmap.Map(pair, 'paraboloid').array.shape == (2, 4, 4, 3)


def test_a_map_of_a_map_is_a_copy():
    chain = envmap.mipmap(envmap.Map(np.random.default_rng(1).uniform(0.5, 1, (8, 16, 3)), forward='+x'))
    again = envmap.Map(chain)
    assert again.forward == '+x' and len(again.levels) == len(chain.levels) == 5
    assert all(np.array_equal(a, b) for a, b in zip(again.levels, chain.levels))
    assert not np.shares_memory(again.array, chain.array)
    assert envmap.Map(chain, forward='-z').forward == '-z' and envmap.Map(chain, 'latlong').forward == '+x'
    with pytest.raises(envmap.UsageError, match=r'convert\(\)'):
        envmap.Map(chain, 'cube')
    with pytest.raises(envmap.UsageError, match=r'not Prefiltered: take its .map'):
        envmap.Map(envmap.prefilter(chain, size=4))


def test_chains_have_one_rule(tmp_path):
    level = lambda n: np.ones((6, n, n, 3))
    for sizes, words in ((30 * [8], '8x8 has at most 4 levels, not 30'), ((16, 15), 'level 1 is 15x15, not 8x8'), ((1, 1), '1x1 has at most')):
        with pytest.raises(envmap.UsageError, match=words):
            envmap.Map(levels=[level(n) for n in sizes])
    with pytest.raises(envmap.UsageError, match='8x8 has at most 4 levels, not 30'):
        envmap.prefilter(cube(), 'ggx', roughness=30 * [0.5], size=8)


def test_names_are_not_bytes(tmp_path):
    envmap.write(tmp_path / 'a.exr', np.ones((4, 8, 3)))
    with pytest.raises(envmap.UsageError, match=r'bytes are the contents of a file; these name one: os.fsdecode\(\)'):
        envmap.read(os.fsencode(tmp_path / 'a.exr'))
    with pytest.raises(envmap.InputError):
        envmap.read(os.fsencode(tmp_path / 'none.exr'))


def test_compare_looks_at_every_level():
    a = envmap.mipmap(cube())
    b = envmap.Map(a)
    b.levels[1][4, 3, 2] *= 0.5
    found = envmap.compare(a, b)
    assert found.max == pytest.approx(1, rel=1e-6) and found.worst_level == 1 and found.worst == (4, 3, 2)
    assert [level.max > 0 for level in found.levels] == [False, True, False, False] and found.levels[1].max == found.max
    assert found.rms == found.levels[1].rms > 0 and found.levels[1].worst_level == 1
    assert repr(found).startswith('<envmap.Difference flux ') and 'max 1 at face 4, row 3, column 2 of level 1>' in repr(found)
    assert envmap.compare(a, envmap.Map(a)).max == 0
    with pytest.raises(envmap.UsageError, match='the same number of levels, not 4 and 1'):
        envmap.compare(a, cube())


def test_files_in_memory(tmp_path):
    chain = envmap.mipmap(cube())
    for name, options in (('exr', {}), ('ktx2', {'depth': 'bc6h', 'zstd': True}), ('hdr', {})):
        made = chain if name != 'hdr' else envmap.Map(chain.array)
        data = envmap.encode(made, name, **options)
        envmap.write(tmp_path / f'a.{name}', made, **options)
        assert data == (tmp_path / f'a.{name}').read_bytes()
        for given in (data, bytearray(data), memoryview(data)):
            back = envmap.read(given, all_levels=name != 'hdr')
            wanted = envmap.read(tmp_path / f'a.{name}', all_levels=name != 'hdr')
            assert all(np.array_equal(a, b) for a, b in zip(back.levels, wanted.levels, strict=True))
    with pytest.raises(envmap.UsageError, match='a str, an os.PathLike, bytes or a file that is open for reading, not 3'):
        envmap.read(3)


def test_packed_texels_are_those_of_the_apis():
    chain = envmap.mipmap(cube())
    for level, packed in zip(chain.levels, envmap.pack(chain, 'rgba32f'), strict=True):
        assert packed.shape == level.shape[:-1] + (4,) and packed.dtype == np.float32 and packed.flags.c_contiguous
        for face in range(6):  # X and Z faces mirrored left to right, Y faces top to bottom.
            wanted = level[face, ::-1] if face in (2, 3) else level[face, :, ::-1]
            np.testing.assert_array_equal(packed[face, ..., :3], wanted)
        assert (packed[..., 3] == 1).all()
    np.testing.assert_array_equal(envmap.pack(chain, 'rgb32f', orientation='seen-from-inside')[0], chain.array)
    half = envmap.pack(chain)[0]
    assert half.dtype == np.float16
    np.testing.assert_array_equal(half[..., :3], envmap.pack(chain, 'rgb32f')[0].astype(np.float16))
    words = envmap.pack(chain, 'rgb9e5')[0]
    shared = np.stack([(words >> s & 511) * 2.0 ** ((words >> 27).astype(int) - 24) for s in (0, 9, 18)], -1)
    np.testing.assert_allclose(shared, envmap.pack(chain, 'rgb32f')[0], atol=2 / 512)
    assert envmap.pack(chain, 'bc6h')[0].shape == (6, 2, 2, 16)
    assert not half.flags.writeable


def test_chains_go_into_one_file(tmp_path):
    roughness = [0, 0.25, 0.5, 1]
    made = envmap.prefilter(cube(), 'ggx', roughness=roughness, size=8)
    assert [level.shape[1] for level in made.map.levels] == [8, 4, 2, 1] and made.error <= 1e-3
    for level, r in zip(made.map.levels, roughness):
        np.testing.assert_array_equal(level, envmap.prefilter(cube(), 'ggx', roughness=r, size=level.shape[1]).map.array)
    envmap.write(tmp_path / 'chain.ktx2', made.map, depth='float')
    back = envmap.read(tmp_path / 'chain.ktx2', all_levels=True)
    again = envmap.Map(levels=back.levels)
    for a, b in zip(again.levels, made.map.levels, strict=True):
        np.testing.assert_array_equal(a, b)
    with pytest.raises(envmap.UsageError, match='and not both'):
        envmap.Map(cube(), levels=[cube()])
    with pytest.raises(envmap.UsageError):
        envmap.Map(levels=[])


def test_levels_halve():
    for sizes in ((8, 7), (4, 8), (8, 3), (7, 4, 2), (7, 4, 2, 1, 1)):
        with pytest.raises(envmap.UsageError, match='level 1 is .*, not .*mipmap|has at most 3 levels'):
            envmap.Map(levels=[np.ones((n, n, 3)) for n in sizes], projection='octahedral')
    for sizes in ((7, 3, 1), (8, 4), (8, 4, 2, 1)):
        assert len(envmap.Map(levels=[np.ones((n, n, 3)) for n in sizes], projection='octahedral').levels) == len(sizes)


@pytest.mark.parametrize('engine', ['three', 'filament', 'unity'])
def test_bake_writes_what_the_command_writes(tmp_path, engine):
    probe = envmap.generate('sun', size=32, radius=20.0, radiance=(9, 8, 7))
    envmap.write(tmp_path / 'probe.exr', probe)
    program = [os.environ['ENVMAP_PROGRAM'], 'bake', tmp_path / 'probe.exr', tmp_path / 'program', '--for', engine, '--quality', 'draft', '-q']
    subprocess.run(program, check=True)
    files = envmap.bake(probe, engine, tmp_path / 'module', quality='draft')
    assert sorted(files) == sorted(p.name for p in (tmp_path / 'program').iterdir())
    for name in files:
        assert (tmp_path / 'module' / name).read_bytes() == (tmp_path / 'program' / name).read_bytes(), name


def test_bake_says_what_is_wrong(tmp_path):
    probe = envmap.generate('sun', size=16, radius=20.0)
    assert 'filament' in envmap.engines()
    with pytest.raises(envmap.UsageError, match="'maya' is none of the engines babylon, "):
        envmap.bake(probe, 'maya', tmp_path / 'a')
    with pytest.raises(envmap.AccuracyError) as caught:
        envmap.bake(probe, 'unreal', tmp_path / 'a', max_error=1e-4)
    assert caught.value.code == 'accuracy' and caught.value.file == str(tmp_path / 'a/background.hdr')
    with pytest.raises(envmap.UsageError) as caught:
        envmap.bake(probe, 'filament', tmp_path / 'a', chain_size=0)
    assert caught.value.field == 'chain_size'
    assert not (tmp_path / 'a').exists() and not list(tmp_path.iterdir())
    roughnesses = envmap.level_roughnesses('filament', 16)
    assert len(roughnesses) == 5 and roughnesses[0] == 0 and roughnesses == sorted(roughnesses)
    with pytest.raises(envmap.UsageError):
        envmap.level_roughnesses('unity')


def test_windows_and_tables_are_those_of_the_command(tmp_path):
    probe = envmap.generate('sun', size=32, radius=5.0, radiance=(500, 500, 500))
    envmap.write(tmp_path / 'probe.exr', probe)
    program = os.environ['ENVMAP_PROGRAM']
    for window in ('none', 'hann', 'auto'):
        said = subprocess.run([program, 'sh', tmp_path / 'probe.exr', '--irradiance', '--window', window, '--json'], check=True, capture_output=True)
        wanted = np.array(json.loads(said.stdout)['coefficients'])
        assert np.allclose(envmap.sh(probe, irradiance=True, window=window), wanted, rtol=1e-6, atol=1e-6), window
    for lobe in ('ggx', 'charlie'):
        subprocess.run([program, 'prefilter', '--lobe', lobe, '--brdf-table', tmp_path / 'table.exr', '--table-size', '16'], check=True)
        table = envmap.brdf_table(lobe, 16)
        assert table.shape == (16, 16, 3)
        assert np.allclose(table, envmap.read(tmp_path / 'table.exr', projection='octahedral').array, atol=1e-6), lobe
    with pytest.raises(envmap.UsageError):
        envmap.brdf_table('phong')


def test_threads_are_limited():
    probe = envmap.generate('sky', size=256)
    envmap.limit_threads(1)
    try:
        wall, used = time.perf_counter(), time.process_time()
        envmap.prefilter(probe, 'ggx', roughness=0.3, size=64)
        assert time.process_time() - used < 1.3 * (time.perf_counter() - wall) + 0.05
    finally:
        envmap.limit_threads(0)


def test_maps_pickle_and_copy():
    made = envmap.convert(envmap.mipmap(cube()), 'latlong', forward='-z')
    made = envmap.mipmap(made)
    for other in (pickle.loads(pickle.dumps(made)), copy.copy(made), copy.deepcopy(made)):
        assert (other.projection, other.forward) == (made.projection, made.forward)
        for a, b in zip(other.levels, made.levels, strict=True):
            np.testing.assert_array_equal(a, b)
        other.array[0, 0] = 7
        assert made.array[0, 0, 0] != 7


def test_progress_rises_to_one():
    parts = []
    envmap.prefilter(cube(16), 'ggx', roughness=[0.3, 0.6], size=16, progress=parts.append)
    assert parts == sorted(parts) and parts[-1] == 1


def test_version_and_names():
    assert envmap.__version__.count('.') == 2
    assert set(envmap.__all__) <= set(dir(envmap))
    assert not [name for name in dir(envmap) if not name.startswith('_') and name not in envmap.__all__]


USE = '''
import pathlib
import envmap
import numpy
import numpy.typing

m: envmap.Map = envmap.read(pathlib.Path("a.exr"), all_levels=True)
same: envmap.Map = envmap.read(envmap.encode(m, "exr"))
chain = envmap.prefilter(m.array, "ggx", roughness=[0, 0.5], method="prefix-sums")
envmap.write("b.ktx2", envmap.Map(levels=chain.map.levels), depth="rgbd", facts={"lobe": "ggx"}, progress=print)
total: float = float(envmap.pack(m, "bc6h")[0].sum())
turned = envmap.convert(m, "cube", size=numpy.int64(8), gain=numpy.float32(2), rotate=[0, 90, 0])
rough = envmap.prefilter(m, "ggx", roughness=numpy.linspace(0, 1, 3)).roughness
light: numpy.typing.NDArray[numpy.float32] = envmap.lookup(chain, numpy.ones((5, 3)), roughness=0.3)
lit = envmap.info(m).illuminance + (m.source.border if m.source else 0)
with open("a.exr", "rb") as file:
    envmap.read(file)
envmap.read(numpy.zeros(3, numpy.uint8))
to: envmap.Projection = "cube"


def name(path: envmap.Path, map: envmap.MapLike) -> envmap.Map:
    return envmap.convert(map, to)


try:
    envmap.sh(m)
except envmap.InputError as e:
    print(e.errno, e.filename, e.code, e.file, e.remedy, envmap.__version__)
'''
MISUSE = ('envmap.convert(m, "cubes")', 'envmap.write("a.exr")', 'envmap.pack(m, "rgb8")', 'envmap.read(3)', 'envmap.convert(m, sise=3)',
          'envmap.sh(m).nothing')


def test_types_check(tmp_path):
    """The package by itself, what works, and each line that does not. Skipped where there is no mypy (Debian: python3-mypy)."""
    if subprocess.run([sys.executable, '-m', 'mypy', '--version'], capture_output=True).returncode != 0:
        pytest.skip('no mypy')

    def check(*files):
        return subprocess.run([sys.executable, '-m', 'mypy', '--strict', '--cache-dir', tmp_path / 'cache', *files], cwd=tmp_path,
                              capture_output=True, text=True)
    (tmp_path / 'use.py').write_text(USE)
    done = check(pathlib.Path(envmap.__file__).parent, 'use.py')
    assert done.returncode == 0, done.stdout + done.stderr
    (tmp_path / 'misuse.py').write_text('import envmap\nm = envmap.Map()\n' + '\n'.join(MISUSE) + '\n')
    done = check('misuse.py')
    refused = {int(line.split(':')[1]) for line in done.stdout.splitlines() if ': error: ' in line}
    assert refused == set(range(3, 3 + len(MISUSE))), done.stdout


def test_lights_and_the_rest_make_the_map():
    sun = envmap.generate("sun", "latlong", 256, direction=(0, 1, 1), radius=1)
    found = envmap.lights(sun)
    assert len(found.lights) == 1 and not found.lights[0].radius_is_bound
    assert np.allclose(found.lights[0].towards, (0, 0.5 ** 0.5, 0.5 ** 0.5), atol=1e-3)
    flux = np.array(envmap.info(sun).flux)
    assert np.allclose(np.array(envmap.info(found.remainder).flux) + found.lights[0].flux, flux, rtol=1e-6)
    assert 0 < found.error < 0.02 < 1 and found.error < found.ggx_error
    assert envmap.lights(envmap.generate("sky", size=32)).lights == []

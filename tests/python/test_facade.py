"""The Python side: arguments, errors, docstrings, pickles, signals, arrays, and what only Python has."""
import concurrent.futures
import doctest
import inspect
import io
import json
import multiprocessing
import os
import pathlib
import pickle
import re
import signal
import subprocess
import sys
import threading
import time
import typing
import zlib

import envmap
import numpy as np
import pytest

PUBLIC = [name for name in envmap.__all__ if inspect.isfunction(getattr(envmap, name))]
CLASSES = [envmap.Map, envmap.Lookup]


def noise(height=8, seed=1):
    return np.random.default_rng(seed).uniform(0.1, 2, (height, 2 * height, 3)).astype(np.float32)


# ---- docstrings -----------------------------------------------------------------------------------------------------

def test_examples_run(tmp_path, monkeypatch):
    """Of the package: functions and classes say that they belong to it, so their own modules show none."""
    monkeypatch.chdir(tmp_path)
    failed, attempted = doctest.testmod(envmap)
    assert failed == 0
    finder = doctest.DocTestFinder()
    examples = {name: sum(len(test.examples) for test in finder.find(getattr(envmap, name), name)) for name in PUBLIC}
    assert all(examples.values()), examples
    assert attempted >= sum(examples.values())


@pytest.mark.parametrize('name', PUBLIC)
def test_docstrings_are_complete(name):
    function, document = getattr(envmap, name), getattr(envmap, name).__doc__
    parameters = [p for p in inspect.signature(function).parameters]
    assert '>>> ' in document and 'Examples' in document
    assert document.split('\n')[0].endswith('.')
    if parameters:
        section = document.split('    Parameters\n    ----------\n')[1].split('\n\n    ')[0]
        told = [word.strip(' *') for line in section.split('\n') if line.startswith('    ') and not line.startswith('     ')
                for word in line.split(' : ')[0].split(',')]
        assert told == parameters
    if inspect.get_annotations(inspect.unwrap(function))['return'] is not None:
        assert '    Returns\n    -------\n' in document


# ---- arguments ------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize('call, argument, words', [
    (lambda a: envmap.convert(a, size=True), 'size', 'a whole number below 2^31, not True'),
    (lambda a: envmap.convert(a, size=8.5), 'size', 'a whole number below 2^31, not 8.5'),
    (lambda a: envmap.convert(a, size='8'), 'size', "a whole number below 2^31, not '8'"),
    (lambda a: envmap.convert(a, size=1 << 40), 'size', 'a whole number below 2^31, not 1099511627776'),
    (lambda a: envmap.convert(a, size=a), 'size', r'not ndarray \(8, 16, 3\) of float32'),
    (lambda a: envmap.convert(a, to=3), 'to', "one of 'latlong', 'cube'"),
    (lambda a: envmap.convert(a, rotate=5), 'rotate', 'three numbers, not 5'),
    (lambda a: envmap.convert(a, rotate=(1, 2)), 'rotate', 'three numbers, not tuple of 2'),
    (lambda a: envmap.convert(a, rotate='abc'), 'rotate', 'three numbers'),
    (lambda a: envmap.convert(a, gain='1'), 'gain', "a number, not '1'"),
    (lambda a: envmap.convert(a, gain=1j), 'gain', 'a number'),
    (lambda a: envmap.convert(a, progress=5), 'progress', 'a function of one number, not 5'),
    (lambda a: envmap.convert('abc'), 'map', "a Map or an array of floats, not 'abc'"),
    (lambda a: envmap.prefilter(a, 'ggx', roughness='x'), 'roughness', 'a number or a list of numbers'),
    (lambda a: envmap.prefilter(a, 'ggx', roughness=[[1], [2, 3]]), 'roughness', 'a number or a list of numbers'),
    (lambda a: envmap.prefilter(a, table=3), 'table', r'a file or an array \(n, 2\) of cosines and values, not 3'),
    (lambda a: envmap.prefilter(a, table=[(1, 2, 3)]), 'table', r'an array \(n, 2\)'),
    (lambda a: envmap.write('x.exr', a, clamp=1), 'clamp', 'True or False, not 1'),
    (lambda a: envmap.write('x.exr', a, facts={'a': 1}), 'facts', 'a dict of str'),
    (lambda a: envmap.write(b'x.exr', a), 'file', r'os.fsdecode\(\)'),
    (lambda a: envmap.write('x\0.exr', a), 'file', 'without NUL'),
    (lambda a: envmap.read('x\0.exr'), 'file', 'without NUL'),
    (lambda a: envmap.read('x\ud800.exr'), 'file', 'surrogate'),
    (lambda a: envmap.read(3), 'file', 'open for reading, not 3'),
    (lambda a: envmap.read(io.StringIO('x')), 'file', 'binary mode'),
    (lambda a: envmap.read('x.exr', max_memory=-1), 'max_memory', '0 to 2'),
    (lambda a: envmap.read('x.exr', level=None), 'level', 'a whole number below 2^31, not None'),
    (lambda a: envmap.generate('checker', squares=2.5), 'squares', 'a whole number'),
    (lambda a: envmap.generate('sun', direction=(1, 2)), 'direction', 'three numbers'),
    (lambda a: envmap.generate('sky', zenith='a'), 'zenith', 'a number or three numbers'),
    (lambda a: envmap.lookup(a, [1, 2]), 'directions', r'directions, an array \(..., 3\)'),
    (lambda a: envmap.render('x.glb', at=5), 'at', 'a name or three numbers, not 5'),
    (lambda a: envmap.view('x.glb', mirrors=5), 'mirrors', 'a dict'),
    (lambda a: envmap.png(a), 'picture', 'uint8'),
    (lambda a: envmap.Map(a, forward=3), 'forward', "one of '\\+z'"),
    (lambda a: envmap.convert(a, sise=8), 'sise', "did you mean 'size'"),
    (lambda a: envmap.convert(a, width=8), 'width', 'it has map, to, size, filter'),
    (lambda a: envmap.Map(a, projektion='cube'), 'projektion', "did you mean 'projection'"),
    (lambda a: envmap.convert(), None, "missing a required argument: 'map'"),
    (lambda a: envmap.convert(a, 'cube', 8), None, 'too many positional arguments')])
def test_wrong_arguments_are_one_line(call, argument, words):
    with pytest.raises(TypeError, match=words.replace('^', r'\^')) as found:
        call(noise())
    text = str(found.value)
    assert isinstance(found.value, envmap.ArgumentError) and isinstance(found.value, envmap.UsageError)
    assert text.startswith('envmap.') and '\n' not in text and len(text) < 250 and found.value.field == argument
    assert argument is None or argument in text


def test_numbers_of_every_kind_are_numbers():
    a = noise()
    made = envmap.convert(a, 'cube', size=np.int64(4), gain=np.float32(2), rotate=np.array([90, 0, 0]))
    np.testing.assert_array_equal(made.array, envmap.convert(a, 'cube', size=4, gain=2, rotate=[90.0, 0, 0]).array)
    assert len(envmap.prefilter(a, 'ggx', roughness=np.linspace(0, 1, 3), size=8).map.levels) == 3
    assert envmap.prefilter(a, 'ggx', roughness=np.float32(0.5), size=4).roughness == [0.5]


def test_words_are_those_of_the_library():
    for name, words in envmap._envmap.words().items():
        assert set(typing.get_args(getattr(envmap, name))) - {'hierarchical', 'files'} == set(words) - {'files'}, name


def test_types_of_arguments_are_there():
    """What the signatures say is what type checkers and the check at run time read."""
    for name in PUBLIC:
        function = inspect.unwrap(getattr(envmap, name))
        hints = typing.get_type_hints(function, include_extras=True)
        assert set(hints) == set(inspect.signature(function).parameters) | {'return'}, name
        assert list(inspect.signature(getattr(envmap, name)).parameters) == list(inspect.signature(function).parameters)


# ---- errors ---------------------------------------------------------------------------------------------------------

def test_files_that_are_missing_are_missing(tmp_path):
    a = noise()
    for call in (lambda: envmap.read(tmp_path / 'none.exr'), lambda: envmap.write(tmp_path / 'none' / 'a.exr', a)):
        with pytest.raises(FileNotFoundError) as found:
            call()
        assert found.value.errno == 2 and 'none' in found.value.filename
        again = pickle.loads(pickle.dumps(found.value))
        assert type(again) is type(found.value) and again.errno == 2 and again.filename == found.value.filename
    with pytest.raises(IsADirectoryError):
        envmap.read(tmp_path)
    name = os.fsdecode(b'\xff.exr')  # Not UTF-8.
    with pytest.raises(envmap.InputError) as found:
        envmap.read(tmp_path / name)
    assert found.value.file == str(tmp_path / name)
    envmap.write(tmp_path / name, a)
    np.testing.assert_array_equal(envmap.read(tmp_path / name).array, a)


def test_flaws_are_counted_and_repaired():
    a = noise()
    a[3, 5, 1], a[4, 0, 0], a[7, 2] = np.nan, np.inf, -1
    with pytest.raises(envmap.InputError) as found:
        envmap.Map(a)
    assert str(found.value) == ('3 of 128 texels are no radiance (1 NaN, 1 infinite, 1 negative), the first at [3, 5]: '
                                'envmap.repair() replaces them')
    fixed = envmap.repair(a)
    assert np.isfinite(fixed.array).all() and (fixed.array >= 0).all()
    mean = np.mean([a[j, i] for j in (2, 3, 4) for i in (4, 5, 6) if (j, i) != (3, 5)], 0)
    np.testing.assert_allclose(fixed.array[3, 5], mean, rtol=1e-6)
    made = envmap.Map(noise())
    made.array[1, 2] = np.nan
    with pytest.raises(envmap.InputError, match=r'envmap.repair\(\)'):
        envmap.convert(made, 'cube')
    assert envmap.info(made).flaws == 1 and envmap.info(envmap.repair(made)).flaws == 0
    cube = np.ones((6, 4, 4, 3))
    cube[5, 1, 2, 0] = np.nan
    with pytest.raises(envmap.InputError, match=r'first at \[5, 1, 2\]'):
        envmap.Map(cube)
    zeros = -np.zeros((4, 8, 3))  # -0 is no flaw.
    assert envmap.Map(zeros).size == 4


# ---- arrays ---------------------------------------------------------------------------------------------------------

def test_strides_of_every_kind():
    wide = np.random.default_rng(2).uniform(0.1, 1, (16, 64, 4)).astype(np.float32)
    for a in (wide[:, :32, :3], wide[::-1, :32, :3], wide[:, 31::-1, 2::-1], wide[:, ::2, 1:], np.broadcast_to(wide[:1, :32, :3], (16, 32, 3)),
              wide[:, :32, :3].transpose(2, 0, 1).copy().transpose(1, 2, 0), wide[:, :32, :3].astype('>f4')):
        np.testing.assert_array_equal(envmap.Map(a).array, a)
    with pytest.raises(envmap.UsageError, match=r'array\[..., :3\]'):
        envmap.Map(wide[:, :32])
    packed = np.frombuffer(b'\0' + noise(4).tobytes(), np.uint8)[1:].view(np.float32).reshape(4, 8, 3)  # Not aligned.
    np.testing.assert_array_equal(envmap.Map(packed).array, packed)


def test_import_is_nearly_a_copy():
    """Less than twice the time of numpy's copy on an idle machine; here processor time, with room for a busy one."""
    a = np.random.default_rng(1).uniform(0, 1, (2048, 4096, 3)).astype(np.float32)

    def best(call):
        times = []
        for _ in range(7):
            begin = time.process_time()
            kept = call()
            times.append(time.process_time() - begin)
            del kept
        return min(times)
    assert best(lambda: envmap.Map(a)) < 3 * best(lambda: a.copy())


# ---- maps -----------------------------------------------------------------------------------------------------------

def test_reprs_say_what_is_there():
    sky = envmap.Map(noise(), forward='-x')
    assert repr(sky) == '<envmap.Map latlong 16x8, forward -x, 1 level>'
    assert repr(envmap.mipmap(envmap.convert(sky, 'cube', size=4))) == '<envmap.Map cube 4x4 x 6, forward +z, 3 levels>'
    assert 'Map cube' in repr(envmap.prefilter(sky, size=4))
    assert repr(envmap.Lookup(sky)) == '<envmap.Lookup of <envmap.Map latlong 16x8, forward -x, 1 level>>'


def decoded(data):
    """The pixels of a PNG of 8-bit RGB without filters."""
    assert data[:8] == b'\x89PNG\r\n\x1a\n'
    chunks, at = {}, 8
    while at < len(data):
        size, kind = int.from_bytes(data[at:at + 4], 'big'), data[at + 4:at + 8]
        assert int.from_bytes(data[at + 8 + size:at + 12 + size], 'big') == zlib.crc32(data[at + 4:at + 8 + size])
        chunks[kind] = data[at + 8:at + 8 + size]
        at += 12 + size
    width, height = (int.from_bytes(chunks[b'IHDR'][k:k + 4], 'big') for k in (0, 4))
    rows = np.frombuffer(zlib.decompress(chunks[b'IDAT']), np.uint8).reshape(height, 1 + 3 * width)
    assert (rows[:, 0] == 0).all()
    return rows[:, 1:].reshape(height, width, 3)


def test_previews_are_pictures():
    sky = envmap.Map(noise(64))
    picture = envmap.preview(sky, 16)
    assert picture.shape == (16, 32, 3) and picture.dtype == np.uint8
    np.testing.assert_array_equal(decoded(sky._repr_png_()), sky.preview())
    grey = envmap.preview(envmap.Map(np.full((8, 16, 3), 0.7)), tone='clip')  # The median of luminance becomes 0.18.
    assert set(grey.ravel()) <= {117, 118, 119}  # sRGB of 0.18 is 0.4613.
    clipped = envmap.preview(np.full((8, 16, 3), 0.25), exposure=1, tone='clip')
    assert set(clipped.ravel()) == {188}  # sRGB of 0.5 is 0.7354.
    cross = envmap.preview(envmap.generate('faces', 'cube', 4), exposure=0, tone='clip')
    assert cross.shape == (12, 16, 3)
    for row, column, colour in ((1, 2, (255, 0, 0)), (1, 0, (0, 255, 255)), (0, 1, (0, 255, 0)), (2, 1, (255, 0, 255)), (1, 1, (0, 0, 255)),
                                (1, 3, (255, 255, 0)), (0, 0, (0, 0, 0))):
        assert (cross[4 * row:4 * row + 4, 4 * column:4 * column + 4] == colour).all()
    flawed = envmap.Map(noise())
    flawed.array[0, 0] = np.nan
    assert envmap.preview(flawed).shape == (8, 16, 3)


def test_source_tells_what_the_file_says(tmp_path):
    envmap.write(tmp_path / 'a.exr', envmap.Map(noise(), forward='-x'), depth='half', facts={'lobe': 'ggx'})
    found = envmap.read(tmp_path / 'a.exr')
    source = found.source
    assert (source.file, source.format, source.depth, source.width, source.height) == (str(tmp_path / 'a.exr'), 'openexr', 'half', 16, 8)
    assert source.facts['lobe'] == 'ggx' and not source.forward_is_assumed and found.forward == '-x' and 'Rec.709' in source.space
    assert pickle.loads(pickle.dumps(found)).source == source and envmap.Map(found).source == source
    assert envmap.Map(noise()).source is None
    envmap.write(tmp_path / 'a.pfm', noise())
    assert envmap.read(tmp_path / 'a.pfm').source.forward_is_assumed
    said = json.loads(subprocess.run([os.environ['ENVMAP_PROGRAM'], 'info', 'a.exr', '--json'], cwd=tmp_path, check=True, capture_output=True).stdout)
    assert [c.name for c in source.claims] == [c['name'] for c in said.get('claims', [])] and source.space == said['space']


def test_read_takes_what_is_open_and_limits(tmp_path):
    a, told = noise(64), []
    envmap.write(tmp_path / 'a.exr', a)
    data = (tmp_path / 'a.exr').read_bytes()
    for given in (data, bytearray(data), memoryview(data), np.frombuffer(data, np.uint8), io.BytesIO(data), open(tmp_path / 'a.exr', 'rb')):
        np.testing.assert_array_equal(envmap.read(given).array, a)
    envmap.read(tmp_path / 'a.exr', progress=told.append)
    assert told == sorted(told) and told[-1] == 1
    with pytest.raises(envmap.InputError, match='max_pixels='):
        envmap.read(tmp_path / 'a.exr', max_pixels=100)
    np.testing.assert_array_equal(envmap.read(tmp_path / 'a.exr', max_memory=1 << 33).array, a)


# ---- pickles --------------------------------------------------------------------------------------------------------

def test_public_names_pickle():
    for name in envmap.__all__:
        value = getattr(envmap, name)
        if inspect.isfunction(value) or inspect.isclass(value):
            assert pickle.loads(pickle.dumps(value)) is value, name
    chain = envmap.prefilter(noise(), 'ggx', roughness=[0, 1], size=4)
    again = pickle.loads(pickle.dumps(chain))
    assert (again.method, again.error, again.roughness) == (chain.method, chain.error, [0, 1])
    np.testing.assert_array_equal(again.map.levels[1], chain.map.levels[1])
    found = envmap.compare(noise(), noise(seed=2))
    assert pickle.loads(pickle.dumps(found)) == found
    look = pickle.loads(pickle.dumps(envmap.Lookup(chain)))
    np.testing.assert_array_equal(look([(0, 1, 0)], roughness=0.5), envmap.lookup(chain, [(0, 1, 0)], roughness=0.5))
    info = envmap.info(noise())
    assert pickle.loads(pickle.dumps(info)) == info
    picture = envmap.Picture(noise(), {'ball': envmap.Map(noise())}, 'maps', None)
    assert repr(pickle.loads(pickle.dumps(picture))) == repr(picture)


@pytest.mark.parametrize('how', ['fork', 'spawn'])
def test_process_pools(tmp_path, how):
    envmap.write(tmp_path / 'a.exr', noise())
    with concurrent.futures.ProcessPoolExecutor(2, multiprocessing.get_context(how)) as pool:
        assert pool.submit(envmap.read, tmp_path / 'a.exr').result(60).source.depth == 'float'
        made = list(pool.map(envmap.convert, [noise(), noise(seed=2)], ['cube', 'cube'], timeout=60))
        np.testing.assert_array_equal(made[1].array, envmap.convert(noise(seed=2), 'cube').array)
        with pytest.raises(FileNotFoundError) as found:
            pool.submit(envmap.read, tmp_path / 'none.exr').result(60)
        assert found.value.errno == 2


# ---- signals --------------------------------------------------------------------------------------------------------

SLOW = {
    'prefilter': 'envmap.prefilter(sky, "ggx", roughness=0.1, size=512, method="exact")',
    'convert': 'envmap.convert(sky, "octahedral", size=3000, max_error=1e-7)',
    'sh': 'for _ in range(1000): envmap.sh(sky, 40)',
    'irradiance': 'envmap.irradiance(sky, numpy.ones((1000, 3)))',
    'read': 'for _ in range(1000): envmap.read(data)',
    'encode': 'for _ in range(1000): envmap.encode(sky, "exr")',
    'window': 'envmap.sh(sky, 20, window="auto"); time.sleep(60)'}


@pytest.mark.parametrize('name', SLOW)
def test_an_interrupt_ends_a_call(name):
    program = f"""if True:
        import envmap, numpy, signal, sys, threading, time, os
        sky = envmap.Map(numpy.random.default_rng(1).uniform(0.1, 1, (512, 1024, 3)))
        data = envmap.encode(sky, "exr")
        def press():
            time.sleep(0.7)
            print(time.monotonic(), flush=True)
            os.kill(os.getpid(), signal.SIGINT)
        threading.Thread(target=press, daemon=True).start()
        try:
            {SLOW[name]}
        except KeyboardInterrupt:
            print(time.monotonic(), flush=True)
        assert envmap.convert(sky, "cube", size=8).size == 8  # All goes on.
        os._exit(0)
        """
    done = subprocess.run([sys.executable, '-c', program], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    pressed, ended = map(float, done.stdout.split())
    assert ended - pressed < 0.5


def test_a_process_ends_without_what_was_left_behind():
    """The program ends by itself after Ctrl-C, with its own status and what it has printed."""
    program = """if True:
        import atexit, envmap, numpy, os, signal, sys, threading
        sky = envmap.Map(numpy.random.default_rng(1).uniform(0.1, 1, (1024, 2048, 3)))
        threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        atexit.register(print, 'at exit')
        try:
            envmap.convert(sky, 'octahedral', size=3000, max_error=1e-7)
        except KeyboardInterrupt:
            sys.stdout.write('stopped, ')
            sys.exit(7)
        """
    begin = time.monotonic()
    done = subprocess.run([sys.executable, '-c', program], capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stdout) == (7, 'stopped, at exit\n'), done.stderr
    assert time.monotonic() - begin < 20


def test_an_interrupted_write_leaves_no_file(tmp_path):
    program = """if True:
        import envmap, numpy, os, signal, threading, time
        sky = envmap.Map(numpy.random.default_rng(1).uniform(0.1, 1, (1024, 2048, 3)))
        threading.Timer(0.05, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        try:
            while True: envmap.write('a.exr', sky, compression='zip'); os.remove('a.exr')
        except KeyboardInterrupt:
            pass
        """
    done = subprocess.run([sys.executable, '-c', program], cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0 and not [p for p in tmp_path.iterdir() if p.name != 'a.exr'], done.stderr


def test_other_signals_are_handled_meanwhile():
    heard = []
    former = signal.signal(signal.SIGUSR1, lambda *_: heard.append(time.monotonic()))
    try:
        timer = threading.Timer(0.1, lambda: os.kill(os.getpid(), signal.SIGUSR1))
        timer.start()
        for _ in range(200):
            envmap.prefilter(noise(32), size=8, method='exact')
            if heard:
                break
        timer.join()
    finally:
        signal.signal(signal.SIGUSR1, former)
    assert len(heard) == 1


def test_progress_is_told_in_the_thread_of_the_call():
    threads = set()
    envmap.prefilter(noise(), 'ggx', roughness=[0.3, 0.6], size=16, progress=lambda _: threads.add(threading.get_ident()))
    assert threads == {threading.get_ident()}
    with concurrent.futures.ThreadPoolExecutor(1) as pool:
        other = pool.submit(threading.get_ident).result()
        threads.clear()
        pool.submit(envmap.convert, noise(), 'cube', progress=lambda _: threads.add(threading.get_ident())).result()
        assert threads == {other}


# ---- light ----------------------------------------------------------------------------------------------------------

def test_info_is_what_the_command_says(tmp_path):
    sun = envmap.generate('sun', size=64, direction=(1, 1, 1), radius=5, radiance=(100, 90, 80))
    envmap.write(tmp_path / 'sun.exr', sun)
    said = json.loads(subprocess.run([os.environ['ENVMAP_PROGRAM'], 'info', 'sun.exr', '--towards', '0,0,1', '--json'], cwd=tmp_path,
                                     check=True, capture_output=True).stdout)
    found = envmap.info(sun, towards=(0, 0, 1))
    for name in ('minimum', 'maximum', 'mean', 'flux', 'solid_angle'):
        np.testing.assert_allclose(getattr(found, name), said[name], rtol=1e-5, err_msg=name)
    assert found.illuminance == pytest.approx(said['illuminance']['lux'], rel=1e-5)
    np.testing.assert_allclose(found.brightest_direction, said['brightest']['direction'], atol=1e-5)
    column, row = said['brightest']['texel']
    assert found.brightest_index == (said['brightest']['face'], row, column)
    assert (found.projection, found.size, found.levels, found.flaws) == ('latlong', 64, 1, 0)


def test_irradiance_of_a_constant_and_of_a_cosine():
    np.testing.assert_allclose(envmap.irradiance(envmap.generate('constant', size=16), [[(0, 2, 0)], [(1, 1, 1)]]), np.pi, rtol=1e-5)
    d = envmap.directions('latlong', 128)
    linear = np.repeat(1 + 0.5 * d[..., 1:2], 3, -1)  # 1 + y / 2: its irradiance is pi + pi y / 3.
    for normal in ((0, 1, 0), (0, -1, 0), (0.6, 0, 0.8), (0.6, 0.8, 0)):
        np.testing.assert_allclose(envmap.irradiance(linear, normal), np.pi + np.pi / 3 * normal[1], rtol=1e-4)


def polynomial(n):
    """1, y, z, x, xy, yz, 3z^2 - 1, zx, x^2 - y^2."""
    x, y, z = n
    return np.array([1, y, z, x, x * y, y * z, 3 * z * z - 1, z * x, x * x - y * y])


def test_shader_harmonics_are_irradiance():
    """Of maps that are polynomials of degree 2 the nine colours are exact: each basis as its shader evaluates it."""
    d = envmap.directions('latlong', 256)
    x, y, z = d[..., 0], d[..., 1], d[..., 2]
    light = np.stack([2 + 0.5 * x - 0.3 * y + 0.2 * z, 2 + 0.4 * x * y - 0.6 * y * z + 0.5 * z * x, 2 + 0.3 * (x * x - y * y) + 0.2 * (3 * z * z - 1)], -1)

    def wanted(n):  # Degrees 0, 1 and 2 by pi, 2 pi / 3 and pi / 4 (Ramamoorthi and Hanrahan 2001).
        x, y, z = n
        return np.pi * np.array([2 + (0.5 * x - 0.3 * y + 0.2 * z) * 2 / 3, 2 + (0.4 * x * y - 0.6 * y * z + 0.5 * z * x) / 4,
                                 2 + (0.3 * (x * x - y * y) + 0.2 * (3 * z * z - 1)) / 4])

    def three(c, n):  # shGetIrradianceAt() of three.js, src/renderers/shaders/ShaderChunk/lights_pars_begin.glsl.js.
        x, y, z = n
        return (c[0] * 0.886227 + c[1] * 2 * 0.511664 * y + c[2] * 2 * 0.511664 * z + c[3] * 2 * 0.511664 * x + c[4] * 2 * 0.429043 * x * y
                + c[5] * 2 * 0.429043 * y * z + c[6] * (0.743125 * z * z - 0.247708) + c[7] * 2 * 0.429043 * x * z
                + c[8] * 0.429043 * (x * x - y * y))

    def ramamoorthi(c, n):  # Equation 13.
        x, y, z = n
        c1, c2, c3, c4, c5 = 0.429043, 0.511664, 0.743125, 0.886227, 0.247708
        l00, l1m1, l10, l11, l2m2, l2m1, l20, l21, l22 = c
        return (c1 * l22 * (x * x - y * y) + c3 * l20 * z * z + c4 * l00 - c5 * l20 + 2 * c1 * (l2m2 * x * y + l21 * x * z + l2m1 * y * z)
                + 2 * c2 * (l11 * x + l1m1 * y + l10 * z))

    def filament(c, n):  # Irradiance_SphericalHarmonics() of Filament, shaders/src/surface_light_indirect.fs.
        return np.pi * polynomial(n) @ c

    def godot(c, n):  # Light probes in scene_forward_clustered.glsl: irradiance / pi.
        x, y, z = n
        c0, c1, c2, c3, c4 = 0.886227, 1.023327, 0.858086, 0.247708, 0.429043
        return np.pi * (c0 * c[0] + c1 * (c[1] * y + c[2] * z + c[3] * x) + c2 * (c[4] * x * y + c[5] * y * z + c[7] * x * z)
                        + c3 * c[6] * (3 * z * z - 1) + c4 * c[8] * (x * x - y * y))
    normals = np.random.default_rng(3).normal(size=(20, 3))
    for basis, evaluate in (('three', three), ('ramamoorthi', ramamoorthi), ('filament', filament), ('godot', godot)):
        c = envmap.shader_sh(light, basis, window='none')
        assert c.shape == (9, 3)
        for n in normals / np.linalg.norm(normals, axis=1)[:, None]:
            np.testing.assert_allclose(evaluate(c, n), wanted(n), rtol=1e-3)


def test_shader_harmonics_are_those_that_bake_writes(tmp_path):
    sun = envmap.generate('sun', size=64, direction=(1, 2, 3), radius=10, radiance=(100, 90, 80))
    envmap.bake(sun, 'glsl', tmp_path / 'f', quality='draft')  # Its shader takes Filament's colours.
    text = (tmp_path / 'f' / 'irradiance.txt').read_text()
    written = np.array([float(x) for x in re.findall(r'-?\d+\.?\d*(?:e[-+]\d+)?', text)][:27]).reshape(9, 3)
    np.testing.assert_allclose(envmap.shader_sh(sun, 'filament'), written, rtol=1e-5, atol=1e-6)
    with pytest.raises(envmap.UsageError, match='three, ramamoorthi, filament'):
        envmap.shader_sh(sun, 'cmgen')


@pytest.mark.parametrize('projection', typing.get_args(envmap.Projection))
def test_directions_and_solid_angles_integrate(projection):
    d, w = envmap.directions(projection, 64), envmap.solid_angles(projection, 64)[..., None]
    assert d.shape == envmap.generate('constant', projection, 64).array.shape
    second = (w * d * d).sum(tuple(range(d.ndim - 1)))
    np.testing.assert_allclose(second, 4 * np.pi / 3, rtol=2e-2)  # Of x^2 over the sphere; rims are rough.
    inside = np.broadcast_to(w[..., 0] > 0, d.shape[:-1])
    np.testing.assert_allclose(np.linalg.norm(d[inside], axis=-1), 1, rtol=1e-12)
    made = envmap.generate('directions', projection, 64)
    whole = inside & np.broadcast_to(w[..., 0] > 0.9 * np.median(w[w > 0]), inside.shape) if projection in ('sphere', 'paraboloid', 'angular') else inside
    np.testing.assert_allclose(made.array[whole], (d[whole] + 1) / 2, atol=2e-2)


def test_directions_turn_with_forward():
    middle = envmap.directions('latlong', 64, '+x')[32, 64]
    np.testing.assert_allclose(middle, (1, 0, 0), atol=0.06)


@pytest.mark.parametrize('kind', [np.float32, np.float64])
def test_lookup_is_bilinear_and_between_levels(kind):
    chain = envmap.mipmap(envmap.generate('directions', 'cube', 64))
    d = np.random.default_rng(5).normal(size=(40, 50, 3)).astype(kind)
    unit = d / np.linalg.norm(d, axis=-1, keepdims=True)
    found = envmap.lookup(chain, d)
    assert found.shape == d.shape and found.dtype == np.float32
    np.testing.assert_allclose(found, (unit + 1) / 2, atol=2e-3)
    zero, one = envmap.lookup(chain, d, 0), envmap.lookup(chain, d, 1)
    np.testing.assert_allclose(envmap.lookup(chain, d, 0.25), 0.75 * zero + 0.25 * one, atol=1e-6)
    each = envmap.lookup(chain, d, np.where(np.arange(50) % 2, 1.0, 0.0))
    np.testing.assert_array_equal(each[:, 1::2], one[:, 1::2])
    np.testing.assert_array_equal(each[:, ::2], zero[:, ::2])
    np.testing.assert_array_equal(envmap.lookup(chain, d[::2, ::-1]), zero[::2, ::-1])
    assert envmap.lookup(chain, (0, 0, 0)).tolist() == [0, 0, 0] and envmap.lookup(chain, np.zeros((0, 3))).shape == (0, 3)
    with pytest.raises(envmap.UsageError, match='do not fit'):
        envmap.lookup(chain, d, np.zeros(7))


def test_lookup_knows_roughness():
    chain = envmap.prefilter(envmap.generate('sky', size=32), 'ggx', roughness=[0, 0.5, 1], size=16)
    look, d = envmap.Lookup(chain), [(0, 1, 0), (1, 0, 0)]
    np.testing.assert_array_equal(look(d, roughness=0.25), look(d, 0.5))
    np.testing.assert_array_equal(look(d, roughness=[0.5, 1.0]), look(d, [1.0, 2.0]))
    with pytest.raises(envmap.UsageError, match='roughness= needs'):
        envmap.lookup(chain.map, d, roughness=0.3)


def test_lookups_share_their_work():
    """A million directions: faster than a hundred a call, and from many threads alike."""
    look = envmap.Lookup(envmap.generate('sky', 'cube', 32))
    d = np.random.default_rng(1).normal(size=(200000, 3)).astype(np.float32)
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        parts = list(pool.map(look, np.split(d, 4)))
    np.testing.assert_array_equal(np.concatenate(parts), look(d))


def test_photographs_are_those_of_the_command(tmp_path):
    sky = envmap.Map(noise(64))
    envmap.write(tmp_path / 'sky.exr', sky)
    subprocess.run([os.environ['ENVMAP_PROGRAM'], 'convert', 'sky.exr', 'picture.exr', '--to', 'perspective', '--fov', '50', '--size', '48', '--width', '48',
                    '--filter', 'bilinear', '--quiet'], cwd=tmp_path, check=True)
    picture = envmap.photograph(sky, fov=50, width=48, height=48)
    assert picture.shape == (48, 48, 3) and picture.dtype == np.float32
    np.testing.assert_array_equal(picture, envmap.read(tmp_path / 'picture.exr', projection='equal-area').array)  # Any square will do.
    middle = envmap.photograph(envmap.generate('directions', size=128), towards=(1, 0, 0), fov=20, width=9, height=9)[4, 4]
    np.testing.assert_allclose(middle, (1, 0.5, 0.5), atol=1e-2)
    with pytest.raises(envmap.UsageError, match='field'):
        envmap.photograph(sky, fov=200)


# ---- pages ----------------------------------------------------------------------------------------------------------

def test_the_page_runs(tmp_path, monkeypatch):
    page = (pathlib.Path(__file__).parents[2] / 'docs/python.md').read_text()
    monkeypatch.chdir(tmp_path)
    found = {}
    exec('\n'.join(re.findall(r'```python\n(.*?)```', page, re.S)), found)
    np.testing.assert_allclose(found['upward'], (0, np.pi, 0), atol=1e-2)
    assert found['seen'].shape == (100000, 3) and found['nine'].shape == (9, 3) and (tmp_path / 'preview.png').exists()

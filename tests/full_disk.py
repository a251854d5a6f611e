"""Commands that write onto a disk that is full, or becomes full just before the end: a tmpfs, mounted where nothing else sees it;
and under a limit on the size of files, which is like a full disk and no signal, with files without a name and without (O_TMPFILE).
Each ends with 4 and one line that names the file; what was there is as it was, and nothing else is.

  full_disk.py ENVMAP [NO_TMPFILE]    a library to preload (no_tmpfile.cpp); ends with 77 where no tmpfs can be mounted
"""
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile

PAGE = os.sysconf('SC_PAGE_SIZE')
SIZE = 8 << 20

# What a command writes, into the folder {to}; the names that its message may say.
COMMANDS = [
    ('convert map.exr {to}/a.exr --to cube', ['a.exr']),
    ('convert map.exr {to}/a.hdr --fsync', ['a.hdr']),
    ('convert map.exr {to}/a.ktx2 --to cube --depth half', ['a.ktx2']),
    ('convert map.exr {to}/a.dds --to cube --depth half --if-changed', ['a.dds']),
    ('convert map.exr {to}/a.png', ['a.png']),
    ('convert map.exr {to}/a.jpg --clamp', ['a.jpg']),
    ('convert map.exr {to}/a.tif', ['a.tif']),
    ('convert map.exr {to}/a.pfm', ['a.pfm']),
    ('prefilter map.exr {to}/a.env --for babylon-env --size 16 --max-error 0.1', ['a.env']),
    ('convert map.exr {to}/a_{{face}}.exr --to cube', ['a_px.exr', 'a_nx.exr', 'a_py.exr', 'a_ny.exr', 'a_pz.exr', 'a_nz.exr']),
    ('convert map.exr {to}/a.exr --depfile {to}/a.d', ['a.exr', 'a.d']),
    ('mipmap map.exr {to}/a.exr', ['a.exr']),
    ('mipmap map.exr {to}/a.ktx2 --zstd', ['a.ktx2']),
    ('mipmap map.exr {to}/a_{{level}}.exr --levels 3', ['a_0.exr', 'a_1.exr', 'a_2.exr']),
    ('prefilter map.exr {to}/a.exr --size 8 --max-error 0.1', ['a.exr']),
    ('prefilter --brdf-table {to}/b.exr --table-size 4', ['b.exr']),
    ('bake map.exr {to}/folder --for blender', ['folder']),
    ('bake map.exr {to}/folder --for gltf --chain-size 16 --max-error 0.1 --depfile {to}/a.d', ['folder', 'a.d']),
    ('generate sky {to}/a.exr --size 16', ['a.exr']),
    ('merge part1.exr part2.exr {to}/a.exr', ['a.exr']),
    ('compare map.exr map.exr --difference {to}/a.exr', ['a.exr']),
    ('sh map.exr --evaluate {to}/a.exr', ['a.exr']),
    ('lights map.exr --count 128 --gltf {to}/a.gltf', ['a.gltf']),
    ('preview map.exr {to}/a.png', ['a.png']),
    ('preview map.exr --html {to}/a.html', ['a.html']),
    ('tradeoff map.exr --task mipmap:1 --budget 0 --plot {to}/a.svg', ['a.svg']),
    ('render scene.obj {to}/a.exr --method raycast --ambient 1 --size 32 --depfile {to}/a.d', ['a.exr', 'a.d']),
    ('batch jobs.txt --make {to}/Makefile', ['Makefile']),
]


# What is a file of TMPDIR until it is whole: that which goes to a pipe, in any format.
STREAMS = ['convert map.exr -', 'convert map.exr - --format hdr', 'convert map.exr - --format png --clamp', 'convert map.exr - --to cube --format ktx2']


def no_bytes():
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))


def run(command, limit=None, **surroundings):
    return subprocess.run([sys.argv[1], *command.split(), '--quiet'], capture_output=True, text=True, errors='replace', env=dict(os.environ, **surroundings), preexec_fn=limit)


def contents(folder):
    """Names, bytes and the time of the last change of all that lies there."""
    return {str(p): (p.read_bytes() if p.is_file() else None, p.stat().st_mtime_ns if p.is_file() else 0) for p in pathlib.Path(folder).rglob('*')}


def pages(folder):
    """What the files of a folder take."""
    return sum(-(-p.stat().st_size // PAGE) for p in pathlib.Path(folder).rglob('*') if p.is_file())


def fill(disk, free):
    """A file takes all that is left of the disk but some pages."""
    ballast = pathlib.Path(disk, 'ballast')
    ballast.unlink(missing_ok=True)
    there = os.statvfs(disk)
    with ballast.open('wb') as file:
        os.posix_fallocate(file.fileno(), 0, (there.f_bavail - free) * there.f_frsize)


def check(command, disk, names, free=None, **how):
    """@param free pages; None: the disk is not filled."""
    if free is not None:
        fill(disk, free)
    before = contents(disk)
    done = run(command, **how)
    where = f'envmap {command}, with {free} pages free, {how}'
    assert done.returncode == 4, (where, done.returncode, done.stderr)
    assert done.stderr.count('\n') == 1 and done.stderr.startswith(f'envmap {command.split()[0]}: '), (where, done.stderr)
    assert any(name in done.stderr for name in names) and '.folder.' not in done.stderr, (where, done.stderr)
    assert contents(disk) == before, (where, sorted(contents(disk)), sorted(before))


def fails_whole(command, names):
    """On a disk without a free page, and on one that lacks a page; with and without files of these names there."""
    pathlib.Path('roomy').mkdir()
    done = run(command.format(to='roomy'))
    assert done.returncode == 0, (command, done.stderr)
    needed = pages('roomy')
    subprocess.run(['rm', '-r', 'roomy'], check=True)
    there = command.format(to='disk')
    check(there, 'disk', names, 0)
    pathlib.Path('disk/ballast').unlink()
    old = [pathlib.Path('disk', name) for name in names if name != 'folder']
    for path in old:
        path.write_text('old')
    check(there, 'disk', names, needed - 1)
    for path in old:
        path.unlink()


def keeps_to_a_limit():
    """No file may have a byte: with and without files of these names there, with and without O_TMPFILE."""
    for preload in ('', *sys.argv[2:]):
        how = {'limit': no_bytes, 'LD_PRELOAD': preload}
        for command, names in COMMANDS:
            os.mkdir('limited')
            check(command.format(to='limited'), 'limited', names, **how)
            for name in names:
                if name != 'folder':
                    pathlib.Path('limited', name).write_text('old')
            check(command.format(to='limited'), 'limited', names, **how)
            shutil.rmtree('limited')
        for command in STREAMS:
            check(command, '.', ['standard output: cannot be held in '], **how)


def keeps_whole_maps():
    """The table that goes with a map is a file of its own, written after it: the map stays where that fails."""
    command = 'prefilter map.exr {to}/a.exr --size 8 --max-error 0.1 --brdf-table {to}/b.exr --table-size 4'
    check(command.format(to='disk'), 'disk', ['a.exr'], 0)
    fill('disk', 1)
    done = run(command.format(to='disk'))
    assert done.returncode == 4 and done.stderr.count('\n') == 1 and 'disk/b.exr' in done.stderr, done.stderr
    assert sorted(os.listdir('disk')) == ['a.exr', 'ballast'] and run('info disk/a.exr').returncode == 0
    os.remove('disk/a.exr')


def keeps_whole_frames():
    """Of frames, those that were whole before the disk was full stay, and nothing else."""
    frames = 'render scene.obj {to}/{{frame}}.exr --method raycast --ambient 1 --size 32 --frames 0:3 --depfile {to}/a.d'
    pathlib.Path('roomy').mkdir()
    assert run(frames.format(to='roomy')).returncode == 0
    one = -(-pathlib.Path('roomy/0000.exr').stat().st_size // PAGE)
    fill('disk', 2 * one + 1)
    done = run(frames.format(to='disk'))
    assert done.returncode == 4 and done.stderr.count('\n') == 1 and 'disk/0002.exr' in done.stderr, done.stderr
    assert sorted(os.listdir('disk')) == ['0000.exr', '0001.exr', 'ballast'], os.listdir('disk')
    for name in ('0000.exr', '0001.exr'):
        assert pathlib.Path('disk', name).read_bytes() == pathlib.Path('roomy', name).read_bytes()
        os.remove(f'disk/{name}')


def tells_at_once():
    """A file that surely does not fit is refused before the work, which would take hours; one that may fit when packed is tried."""
    for name in ('a.dds', 'a.ktx2', 'a.pfm', 'a.hdr', '{{face}}.pfm', 'a.exr --compression none', 'a.exr'):
        command = f'convert map.exr disk/{name} --size 65536 --to cube'.format()
        fill('disk', 100)
        before = contents('disk')
        done = subprocess.run([sys.argv[1], *command.split()], capture_output=True, text=True, timeout=20)
        assert done.returncode == 4 and done.stderr.count('\n') == 1 and 'GiB' in done.stderr, done.stderr
        assert contents('disk') == before
    done = subprocess.run([sys.argv[1], *'convert large.exr out.exr --max-memory 64M'.split()], capture_output=True, text=True, timeout=20,
                          env=dict(os.environ, TMPDIR=os.path.abspath('disk')))
    assert done.returncode == 4 and 'GiB of scratch' in done.stderr, done.stderr
    # Black packs to nearly nothing.
    for name, size in (('a.exr', 2048), ('a.hdr', 512)):
        assert run(f'generate constant disk/{name} --value 0 --size {size} --to cube').returncode == 0, name
        os.remove(f'disk/{name}')


def names_tmpdir():
    """What goes to a pipe is a file of TMPDIR until it is whole; maps beyond --max-memory are one, too."""
    temporary = {'TMPDIR': os.path.abspath('disk')}
    run('generate constant large.exr --to latlong --size 1300 --depth half')
    for command in (*STREAMS, 'convert large.exr out.exr --to cube --max-memory 64M', 'tradeoff map.exr --task depth --budget 0'):
        check(command, 'disk', ['TMPDIR', 'disk'], 0, **temporary)
    assert not os.path.exists('out.exr')


def prepare():
    run('generate sky map.exr --size 32 --to latlong')
    for part in (1, 2):
        run(f'convert map.exr part{part}.exr --shard {part}/2 --to cube')
    pathlib.Path('scene.obj').write_text('v 0 0 -1\nv 1 0 -1\nv 0 1 -1\nf 1 2 3\n')
    pathlib.Path('jobs.txt').write_text('convert map.exr out.exr\n')


def main(mounted):
    prepare()
    keeps_to_a_limit()
    if not mounted:
        sys.exit(77)
    os.mkdir('disk')
    if subprocess.run(['mount', '-t', 'tmpfs', '-o', f'size={SIZE}', 'envmap', 'disk'], stderr=subprocess.DEVNULL).returncode != 0:
        sys.exit(77)
    for command, names in COMMANDS:
        fails_whole(command, names)
    keeps_whole_maps()
    keeps_whole_frames()
    names_tmpdir()
    tells_at_once()


if 'INSIDE' not in os.environ:
    # In a name space of its own, as root there: nothing outside sees the mount, and it is gone with the last process.
    with tempfile.TemporaryDirectory() as folder:
        arguments = [os.path.abspath(p) for p in sys.argv[1:]]
        inside = ['unshare', '--user', '--map-root-user', '--mount']
        mounted = subprocess.run([*inside, 'true'], stderr=subprocess.DEVNULL).returncode == 0
        sys.exit(subprocess.run([*(inside if mounted else []), sys.executable, os.path.abspath(__file__), *arguments], cwd=folder,
                                env=dict(os.environ, INSIDE=str(int(mounted)))).returncode)
main(os.environ['INSIDE'] == '1')

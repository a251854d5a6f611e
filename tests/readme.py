"""Runs every command of README.md that begins with `envmap`, in its order, on files of the names that it takes.

  readme.py SOURCE_DIR ENVMAP
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

source, program = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()


def commands():
    """Indented lines of README.md, comments left out: the shell takes them as they are."""
    for line in (source / 'README.md').read_text().splitlines():
        if line.startswith('    envmap '):
            yield line.strip()


def run(command, folder):
    """@return what is wrong, or nothing."""
    path = f'{program.parent}{os.pathsep}{os.environ["PATH"]}'
    done = subprocess.run(['sh', '-c', command], cwd=folder, env={**os.environ, 'PATH': path}, capture_output=True, text=True)
    if done.returncode == 0:
        return ''
    return f'{command}\n  exit status {done.returncode}: {done.stderr.strip()}\n'


def prepare(folder):
    """The reader's own files."""
    wrong = ''
    for command in ('envmap generate sky probe.hdr --size 64', 'envmap convert probe.hdr ball.hdr --to sphere',
                    'envmap convert probe.hdr golden.exr --to cube', 'envmap convert probe.hdr new.exr --to cube'):
        wrong += run(command, folder)
    (folder / 'maps.txt').write_text('mipmap probes/*.hdr {stem}.ktx2 --depth half\n')
    (folder / 'probes').mkdir()
    for name in 'ab':
        shutil.copy(folder / 'probe.hdr', folder / f'probes/{name}.hdr')
    scenes = folder / 'scenes'
    subprocess.run([sys.executable, source / 'samples/scenes/make.py', scenes], check=True, stdout=subprocess.DEVNULL)
    shutil.copy(scenes / 'cellar.glb', folder)
    shutil.copy(scenes / 'ball.glb', folder / 'model.glb')
    return wrong


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        wrong = prepare(folder)
        every = list(commands())
        for command in every:
            wrong += run(command, folder)
    print(wrong or f'{len(every)} commands', end='\n')
    return 1 if wrong or len(every) < 10 else 0


sys.exit(main())

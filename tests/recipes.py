"""Runs the commands of the documents word for word, on files with the names that they use: every indented line of README.md and of
docs/ that begins with `envmap` or `$ envmap`, in its order, and every recipe of man/envmap.7. Where output follows a command, it is compared.

  recipes.py SOURCE_DIR ENVMAP
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

source, program = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()


def commands(page):
    """Indented lines, as the shell takes them. @return pairs of a command and the lines of output right below it."""
    found, following = [], False
    for line in page.read_text().splitlines():
        command = re.match(r'    (?:\$ )?(envmap .*)', line)
        if command:
            found.append((command[1].strip(), []))
        elif line.startswith('    ') and following:
            found[-1][1].append(line[4:].rstrip())
        following = bool(command) or (following and line.startswith('    '))
    return found


def without_times(text):
    return re.sub(r'[\d.]+ (us|s)\b', r'TIME \1', text)


def run(command, folder, wanted=()):
    """@return what is wrong, or nothing. @param wanted lines that the output must have, apart from times."""
    path = f'{program.parent}{os.pathsep}{os.environ["PATH"]}'
    done = subprocess.run(['sh', '-c', command], cwd=folder, env={**os.environ, 'PATH': path}, capture_output=True, text=True)
    if done.returncode == 0:
        lines = without_times(done.stdout + done.stderr).splitlines()
        lacking = [line for line in wanted if without_times(line) not in [x.rstrip() for x in lines]]
        return ''.join(f'{command}\n  does not print: {line}\n' for line in lacking)
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
    for scene in scenes.glob('*.glb'):
        shutil.copy(scene, folder)
    return wrong


def recipes(page):
    """Shell scripts: what stands between .nf and .fi, read as man shows it."""
    for block in re.findall(r'^\.nf\n\.RS 4\n(.*?)^\.RE\n\.fi$', page.read_text(), re.M | re.S):
        yield re.sub(r'\\(.)', lambda m: {'e': '\\'}.get(m[1], m[1]), block)


def prepare_recipes(folder):
    (folder / 'probes').mkdir()
    wrong = ''
    for command in ('envmap generate sun probe.hdr --size 32 --radius 4 --value 100 --direction 1,2,1', 'envmap generate sky sky.hdr --size 256', 'envmap convert sky.hdr ball.hdr --to sphere --size 512',
                    'oiiotool ball.hdr --create 1024x720 3 --paste +256+104 -o frame.hdr && rm ball.hdr',
                    'for k in a b; do envmap convert probe.hdr probes/$k.hdr --size 16; done'):
        wrong += run(command, folder)
    return wrong


def check_page(page, files):
    """@param files of the reader, which each page has anew."""
    def check(folder):
        shutil.copytree(files, folder, dirs_exist_ok=True)
        wrong = ''
        every = commands(page)
        return wrong + ''.join(run(command, folder, wanted) for command, wanted in every), len(every)
    return check


def check_recipes(folder):
    wrong = prepare_recipes(folder)
    every = list(recipes(source / 'man/envmap.7'))
    for recipe in every:
        alone = re.sub(r'^sh farm.sh .*\n', '', recipe, flags=re.M)  # tests/slurm.py runs that on a cluster.
        wrong += run('set -e\n' + alone, folder)
    return wrong, len(every)


def main():
    with tempfile.TemporaryDirectory() as name:
        files = pathlib.Path(name)
        unprepared = prepare(files)
        return check_all(files) if not unprepared else print(unprepared) or 1


def check_all(files):
    failed = 0
    checks = [('recipes of envmap(7)', check_recipes, 7),
              ('commands of README.md', check_page(source / 'README.md', files), 25)]
    for page in sorted((source / 'docs').rglob('*.md')):
        if commands(page):
            checks.append((f'commands of {page.relative_to(source)}', check_page(page, files), 1))
    for what, check, least in checks:
        with tempfile.TemporaryDirectory() as name:
            wrong, count = check(pathlib.Path(name))
        print(wrong or f'{count} {what}')
        failed |= bool(wrong) or count < least
    return failed


sys.exit(main())

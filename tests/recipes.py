"""Runs the commands of the documents word for word: every indented line of README.md and of docs/ that begins with `envmap` or `$ envmap`,
in its order, every recipe of man/envmap.7, and every example of the pages of commands, which are those of --help. Where output follows a
command, it is compared. The files that they read are made by inputs.sh of the samples that ENVMAP has: of the sources, if it was built
there, or of its own place, if it is installed or in the portable archive.

  recipes.py SOURCE_DIR ENVMAP [WORD]    WORD: only what has this word in its name, such as README or envmap-convert
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

source, program = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
# What other tests run (completions, Slurm, schemas), or what shows a page.
ELSEWHERE = ('envmap-completion.1', 'sbatch', '--slurm', 'jsonschema', 'man /tmp')


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
    """The files that the documents name."""
    wrong = run('sh "$(envmap manual --samples)/inputs.sh" .', folder)
    (folder / 'samples').mkdir()
    return wrong + run('cp "$(envmap manual --samples)/sample.hdr" samples', folder)


def recipes(page):
    """Shell scripts: what stands between .nf and .fi, read as man shows it."""
    for block in re.findall(r'^\.nf\n\.RS 4\n(.*?)^\.RE\n\.fi$', page.read_text(), re.M | re.S):
        yield re.sub(r'\\(.)', lambda m: {'e': '\\'}.get(m[1], m[1]), block)


def examples(page):
    """Of a page of a command."""
    text = page.read_text()
    for line in re.findall(r'^\.TP\n\\fB(.*)\\fR$', text[text.index('.SH EXAMPLES'):], re.M):
        yield re.sub(r'\\(.)', lambda m: {'e': '\\'}.get(m[1], m[1]), line)


def check_page(page, files):
    """@param files of the reader, which each page has anew."""
    def check(folder):
        shutil.copytree(files, folder, dirs_exist_ok=True)
        wrong = ''
        every = commands(page)
        return wrong + ''.join(run(command, folder, wanted) for command, wanted in every), len(every)
    return check


def check_recipes(files):
    def check(folder):
        shutil.copytree(files, folder, dirs_exist_ok=True)
        wrong = ''
        every = list(recipes(source / 'man/envmap.7'))
        for recipe in every:
            alone = re.sub(r'^sh farm.sh .*\n', '', recipe, flags=re.M)  # tests/slurm.py runs that on a cluster.
            wrong += run('set -e\n' + alone, folder)
        return wrong, len(every)
    return check


def check_examples(page, files):
    def check(folder):
        shutil.copytree(files, folder, dirs_exist_ok=True)
        every = [example for example in examples(page) if not any(word in page.name + example for word in ELSEWHERE)]
        # A minute for each measurement would be long.
        every = [example + ' --budget 2' * example.startswith('envmap tradeoff') for example in every]
        return ''.join(run(example, folder) for example in every), len(every)
    return check


def main():
    with tempfile.TemporaryDirectory() as name:
        files = pathlib.Path(name)
        unprepared = prepare(files)
        return check_all(files) if not unprepared else print(unprepared) or 1


def check_all(files):
    failed = 0
    only = sys.argv[3] if len(sys.argv) > 3 else ''
    checks = [('recipes of envmap(7)', check_recipes(files), 7),
              ('commands of README.md', check_page(source / 'README.md', files), 4)]
    for page in sorted((source / 'docs').rglob('*.md')):
        if commands(page):
            checks.append((f'commands of {page.relative_to(source)}', check_page(page, files), 1))
    for page in sorted((source / 'man').glob('envmap-*.1')):
        if page.name not in ELSEWHERE:
            checks.append((f'examples of {page.name}', check_examples(page, files), 1))
    for what, check, least in (c for c in checks if only in c[0]):
        with tempfile.TemporaryDirectory() as name:
            wrong, count = check(pathlib.Path(name))
        print(wrong or f'{count} {what}')
        failed |= bool(wrong) or count < least
    return failed


sys.exit(main())

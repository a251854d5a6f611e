"""Links between pages, and the width of --help: fails on a relative link or a named file of the sources that is not there, and on
--help that is wider or longer than a terminal shows well.

  prose.py SOURCE_DIR ENVMAP
"""
import pathlib
import re
import subprocess
import sys

COLUMNS, LINES = 100, 80


def broken_links(source, page):
    """Relative links, and names of files of the sources."""
    text = re.sub(r'```.*?```', '', page.read_text(), flags=re.S)  # Code has brackets of its own.
    links = [(page.parent, link) for link in re.findall(r'\]\(([^)#:\s]+)[^):]*\)', text)]
    links += [(source, name) for name in re.findall(r'(?:docs|tests|samples|man)/[\w/-]+\.(?:md|py|sh|svg)', text.replace('\\-', '-'))]
    return [f'{page.relative_to(source)}: no {name}' for folder, name in links if not (folder / name).exists()]


def long_help(program, command):
    lines = subprocess.run([program, command, '--help'], check=True, capture_output=True, text=True).stdout.splitlines()
    wrong = [f'{command} --help: a line of {len(line)} columns, at most {COLUMNS}: {line}' for line in lines if len(line) > COLUMNS]
    return wrong + [f'{command} --help: {len(lines)} lines, at most {LINES}'] * (len(lines) > LINES)


def main():
    source, program = pathlib.Path(sys.argv[1]), sys.argv[2]
    pages = [*source.glob('*.md'), *(source / 'docs').rglob('*.md'), *(source / 'man').glob('*.[137]')]
    commands = sorted(p.stem.removeprefix('envmap-') for p in (source / 'man').glob('envmap-*.1'))
    wrong = [link for page in pages for link in broken_links(source, page)]
    wrong += [line for command in commands for line in long_help(program, command)]
    print('\n'.join(wrong) or f'{len(pages)} pages and {len(commands)} commands')
    return 1 if wrong else 0


sys.exit(main())

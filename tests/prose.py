"""Measures the prose of README, docs, man pages and --help, and fails above the limits below, and on broken links.

  prose.py SOURCE_DIR ENVMAP       check everything
  prose.py --long N FILE...        print the N longest sentences of files (.md, .1, .3, .7; others are --help)

Counted is running text. Code, examples, tables, headings, tags of lists and the option column of --help are left out.
It is an alarm: short sentences may still be hard to understand.
"""
import pathlib
import re
import subprocess
import sys

WORDS, LONG, MARKS, VAGUE = 18, 8, 1.5, 2.5  # Words a sentence; % over 30 words; ; and : and vague words, of 100 words.
COLUMNS, LINES = 100, 80                     # Of --help.
UNCHECKED = ('architecture', 'library', 'prefilter-')   # Pages for people who change the code.

VAGUE_WORDS = re.compile(r'\b(what|whatever|those|such|thereof|therein|else|besides?|so|one|ones|them|theirs|it|its|that of|'
                         r'as (?:it|they) (?:is|are|was|were)|of (?:it|them|these|those|which)|by itself|where)\b', re.I)
SKIPPED_SECTIONS = {'NAME', 'SYNOPSIS', 'SEE ALSO', 'EXAMPLES', 'JSON'}


def markdown(text):
    text = re.sub(r'```.*?```', '', text, flags=re.S)
    text = re.sub(r'!\[[^\]]*\]\([^)]*\)', '', text)
    text = re.sub(r'\[([^\]]*)\]\([^)]*\)', r'\1', text)
    paragraphs = [[]]
    for line in text.split('\n'):
        if not line.strip() or re.match(r'\s*[|#]|    ', line):
            paragraphs.append([])
        else:
            item = re.match(r'\s*([-*+]|\d+\.)\s+(.*)', line)
            if item:
                paragraphs.append([])
            paragraphs[-1].append(item[2] if item else line.strip())
    return [re.sub('[`*]', '', ' '.join(p)) for p in paragraphs if p]


def roff(text):
    paragraphs, skipping, literal, tag = [[]], False, False, False
    for line in text.split('\n'):
        macro = re.match(r"[.']\s*([A-Za-z]+)\s*(.*)", line)
        if macro:
            name, rest = macro.groups()
            paragraphs.append([])
            tag = name == 'TP'
            if name == 'SH':
                skipping = rest.strip('"') in SKIPPED_SECTIONS
            literal = name in ('nf', 'EX', 'TS') or (literal and name not in ('fi', 'EE', 'TE'))
            if name in ('B', 'I', 'BR') and not (skipping or literal):
                paragraphs[-1].append(rest)
        elif tag:
            tag = False
        elif not (skipping or literal or line.startswith(('.\\"', "'\\\""))):
            paragraphs[-1].append(re.sub(r'\\f.|\\&|\\\(..', '', line).replace('\\-', '-').replace('\\e', '\\'))
    return [' '.join(p) for p in paragraphs if p]


def help_text(text):
    paragraphs = []
    for line in text.split('Examples:')[0].split('\n')[2:]:
        option = re.match(r'  (?:\S.*?)(?:\s{2,}|(?<=camera) |(?<=attribute) |(?<=nits=L) )(.*)', line)
        if option:
            paragraphs.append(option[1])
        elif line.startswith(' ' * 24) and paragraphs:
            paragraphs[-1] += ' ' + line.strip()
    return paragraphs


def words(text):
    return re.findall(r"[A-Za-z0-9][A-Za-z0-9'_./^*+-]*|-{1,2}[A-Za-z][\w-]*", text)


def sentences(paragraph):
    paragraph = re.sub(r'\b(e\.g|i\.e|et al|cf|vs)\.|\.\.\.', r'\1', paragraph)
    return [s for s in re.split(r'(?<=[.!?])[\])"\']*\s+', paragraph) if words(s)]


def figures(paragraphs):
    """Defaults in brackets and labels at the start ("EXR: ...") count as tags."""
    paragraphs = [re.sub(r'^[\w, -]{1,20}: ', '', re.sub(r'\(default: [^)]*\)', '', p)) for p in paragraphs]
    lengths = [len(words(s)) for p in paragraphs for s in sentences(p)]
    total = sum(lengths)
    return {'words': total, 'words a sentence': total / max(1, len(lengths)), '% over 30': 100 * sum(n > 30 for n in lengths) / max(1, len(lengths)),
            ';: of 100': 100 * sum(len(re.findall(r'[;:](?=\s)', p)) for p in paragraphs) / max(1, total),
            'vague of 100': 100 * sum(len(VAGUE_WORDS.findall(p)) for p in paragraphs) / max(1, total)}


def paragraphs_of(path):
    text = pathlib.Path(path).read_text()
    kind = markdown if path.suffix == '.md' else roff if path.suffix in ('.1', '.3', '.7') else help_text
    return kind(text)


def check(name, paragraphs, limits=(WORDS, LONG, MARKS, VAGUE)):
    found = figures(paragraphs)
    values = list(found.values())
    print(f'{name:28} {values[0]:6} ' + ' '.join(f'{v:10.1f}' for v in values[1:]))
    return [f'{name}: {key} {value:.1f}, at most {limit}' for (key, value), limit in zip(list(found.items())[1:], limits) if value > limit]


def broken_links(source, page):
    """Relative links, and names of files of the sources in man pages."""
    text = page.read_text()
    links = [(page.parent, link) for link in re.findall(r'\]\(([^)#:\s]+)[^):]*\)', text)]
    links += [(source, name) for name in re.findall(r'(?:docs|tests|samples|man)/[\w/-]+\.(?:md|py|sh|svg)', text.replace('\\-', '-'))]
    return [f'{page.name}: no {name}' for folder, name in links if not (folder / name).exists()]


def main():
    if sys.argv[1] == '--long':
        found = [(len(words(s)), name, s) for name in sys.argv[3:] for p in paragraphs_of(pathlib.Path(name)) for s in sentences(p)]
        for count, name, sentence in sorted(found, reverse=True)[:int(sys.argv[2])]:
            print(f'{count:4} {name}: {sentence}')
        return 0
    source, program = pathlib.Path(sys.argv[1]), sys.argv[2]
    wrong = []
    print(f'{"":28} {"words":>6} {"a sentence":>10} {"% over 30":>10} {";: in 100":>10} {"vague":>10}')
    groups = {'README.md': [source / 'README.md'],
              'docs': [p for p in sorted((source / 'docs').rglob('*.md')) if not p.name.startswith(UNCHECKED)],
              'man, sections 3 and 7': sorted((source / 'man').glob('*.[37]')),
              'man, section 1': sorted((source / 'man').glob('*.1'))}
    for name, pages in groups.items():
        wrong += [link for page in pages for link in broken_links(source, page)]
        for page in pages if len(pages) > 1 else []:
            check(f'  {page.name}', paragraphs_of(page))
        wrong += check(name, [p for page in pages for p in paragraphs_of(page)])
    helps = []
    for command in sorted(p.stem.removeprefix('envmap-') for p in (source / 'man').glob('envmap-*.1')):
        text = subprocess.run([program, command, '--help'], check=True, capture_output=True, text=True).stdout
        helps += help_text(text)
        lines = text.splitlines()
        wrong += [f'{command} --help: a line of {len(line)} columns, at most {COLUMNS}: {line}' for line in lines if len(line) > COLUMNS]
        if len(lines) > LINES:
            wrong.append(f'{command} --help: {len(lines)} lines, at most {LINES}')
    wrong += check('all --help', helps)
    print('\n'.join(wrong))
    return 1 if wrong else 0


sys.exit(main())

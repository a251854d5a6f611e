"""Reads docs/promises.md: every page has the words that are quoted of it, and every test is there.

  promises.py ROOT
"""
import pathlib
import re
import sys

KINDS = ('proved', 'measured', 'estimated')
ROOT = pathlib.Path(sys.argv[1])


def words(text):
    return re.sub(r'\s+', ' ', text).strip()


def page_text(path):
    """A page as one reads it, in one line."""
    text = path.read_text()
    if path.suffix in ('.1', '.3', '.7'):
        text = re.sub(r'^\.(?:B|I|BR|IR) ', '', text, flags=re.M)
        text = re.sub(r"^[.'].*$|T[{}]", '', text, flags=re.M)
        text = re.sub(r'\\f.|\\&', '', text).replace('\\-', '-').replace('\\e', '\\')
    return words(re.sub(r'\*\*', '', text))


def tests():
    """Names of GoogleTest, out of the sources."""
    return {f'{suite}.{name}' for path in (ROOT / 'tests').rglob('*.cpp')
            for suite, name in re.findall(r'^TEST(?:_[FP])?\((\w+),\s*(\w+)\)', path.read_text(), re.M)}


def rows(text):
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip('|').split(' | ')]
        if line.startswith('| "') and len(cells) == 4:
            yield cells
        elif line.startswith('| "'):
            yield [line, '', '', '']


def flaws(known, pages, promise, page, held, kind):
    if kind not in KINDS:
        return [f'{kind or "no kind"}: a row is | "words" | page | tests | {" or ".join(KINDS)} |']
    if page not in pages:
        if not (ROOT / page).is_file():
            return [f'no page {page}']
        pages[page] = page_text(ROOT / page)
    wrong = [] if words(promise.strip('"')) in pages[page] else [f'{page} does not say {promise}']
    for name in held.split(', '):
        if not ((ROOT / name).is_file() if '/' in name else name in known):
            wrong.append(f'no test {name}')
    return wrong


def main():
    text = (ROOT / 'docs/promises.md').read_text()
    known, pages, all_rows = tests(), {}, list(rows(text))
    wrong = [flaw for row in all_rows for flaw in flaws(known, pages, *row)]
    # The test is able to fail.
    for row in (['"Nobody says so"', 'README.md', 'Work.JobsTakeTheirSteps', 'proved'], ['"envmap"', 'README.md', 'Work.Nothing', 'proved'],
                ['"envmap"', 'README.md', 'tests/none.py', 'proved'], ['"envmap"', 'NONE.md', 'tests/run.sh', 'proved'],
                ['"envmap"', 'README.md', 'tests/run.sh', 'hoped']):
        if not flaws(known, pages, *row):
            wrong.append(f'not seen to be wrong: {row}')
    print('\n'.join(f'promises.md: {flaw}' for flaw in wrong) or f'{len(all_rows)} promises of {len(pages)} pages')
    return 1 if wrong or len(all_rows) < 40 else 0


sys.exit(main())

"""interface.py SOURCE BUILD COMPILER [--write]: what programs of others are linked to and compiled against.

The exported functions of the shared libraries, and the sizes of public structs, are those of tests/interface/*.txt. A difference breaks
programs that are not compiled again: raise the version, or keep what is there. `--write` takes the interface as it is.
"""
import pathlib
import platform
import re
import subprocess
import sys
import tempfile

source, build, compiler = (pathlib.Path(argument) for argument in sys.argv[1:4])
here = source / 'tests/interface'
if platform.machine() != 'x86_64':
    sys.exit(77)


def functions(library):
    """Mangled names would be exact; these can be read. Inline functions and templates are the compiler's, and left out."""
    listed = subprocess.run(['nm', '-DC', '--defined-only', library], check=True, capture_output=True, text=True).stdout
    names = {line.split(maxsplit=2)[2].split('@@')[0] for line in listed.splitlines() if line.split()[1] in 'TDBR'}
    return sorted('function ' + name.replace('std::__cxx11::', 'std::') for name in names if 'envmap::' in name)


def public_headers(root):
    found, left = set(), [root]
    while left:
        name = left.pop()
        if name not in found:
            found.add(name)
            left += re.findall(r'#include "(envmap/[^"]+)"', (source / 'src' / name).read_text())
    return found


def structs(root, without=()):
    """Structs and classes of the namespace itself."""
    names = set()
    for header in public_headers(root) - set(without):
        text = (source / 'src' / header).read_text()
        names |= set(re.findall(r'^(?:struct|class) (\w+)(?: final)?(?: : [\w:<>, ]+)? \{', text, re.M))
        names -= set(re.findall(r'^template <[^\n]*>\n(?:struct|class) (\w+)', text, re.M))
    return names


def sizes(root, names):
    body = ''.join(f'  std::printf("struct %s %zu\\n", "{name}", sizeof(envmap::{name}));\n' for name in sorted(names))
    with tempfile.TemporaryDirectory() as folder:
        program = pathlib.Path(folder) / 'sizes'
        program.with_suffix('.cpp').write_text(f'#include "{root}"\n#include <cstdio>\nint main() {{\n{body}}}\n')
        subprocess.run([compiler, '-std=c++20', '-O0', f'-I{source / "src"}', program.with_suffix('.cpp'), '-o', program,
                        f'-L{build}', f'-Wl,-rpath,{build}', '-lenvmap', '-lenvmap-scenes'], check=True)
        return subprocess.run([program], check=True, capture_output=True, text=True).stdout.splitlines()


def declared(root):
    """Functions of the headers, without members."""
    names = set()
    for header in public_headers(root):
        text = re.sub(r'//[^\n]*', '', (source / 'src' / header).read_text())
        names |= set(re.findall(r'^(?!template|using|namespace|struct|class|enum|return|#|  )(?:\[\[[^\]]*\]\] )?[\w:<>,&\* ]+[ &\*](\w+)\(', text, re.M))
    return names - {'operator'}


core = structs('envmap/envmap.h')
found = {'envmap': functions(build / 'libenvmap.so') + sizes('envmap/envmap.h', core),
         'envmap-scenes': functions(build / 'libenvmap-scenes.so') + sizes('envmap/scenes.h', structs('envmap/scenes.h') - core)}
failed = False
for name, lines in found.items():
    file = here / f'{name}.txt'
    if '--write' in sys.argv:
        file.write_text('\n'.join(lines) + '\n')
        continue
    wanted = file.read_text().splitlines()
    for line in sorted(set(wanted) - set(lines)):
        print(f'lib{name}: gone: {line}')
    for line in sorted(set(lines) - set(wanted)):
        print(f'lib{name}: new, not in {file.name}: {line}')
    failed = failed or set(wanted) != set(lines)
page = (source / 'man/envmap.3').read_text()
section = re.search(r'^\.SH FUNCTIONS\n(.*?)^\.SH', page, re.S | re.M).group(1)
named = set(re.findall(r'\w+', '\n'.join(line for line in section.splitlines() if not line.startswith('.'))))
for name in sorted(declared('envmap/scenes.h') - named):
    print(f'man/envmap.3: FUNCTIONS lacks {name}')
    failed = True
if failed:
    sys.exit(f'what is gone breaks programs that use it; what is new goes into the list: {sys.argv[0]} SOURCE BUILD COMPILER --write')

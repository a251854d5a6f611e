#!/usr/bin/env python3
"""Makes a wheel of a build with ENVMAP_PYTHON that holds all it needs but Python, numpy and libc:

  packaging/wheel.py [BUILD [OUTPUT]]     (default: build/release, build)

  envmap-VERSION-cp311-cp311-manylinux_2_36_x86_64.whl     for the build's Python, and its libc or a newer one

It lacks the module of OpenImageIO's formats, and OSMesa, which 'pip install .' in a system with both finds. Rays draw without.
Packing the same build twice gives the same bytes. Needs patchelf.
"""
import base64
import hashlib
import pathlib
import re
import sys
import tempfile
import time
import zipfile

import bundle

SOURCE = pathlib.Path(__file__).resolve().parents[1]


def metadata(version):
    project = (SOURCE / 'pyproject.toml').read_text()
    value = lambda key: re.search(rf'^{key} = "(.*)"$', project, re.M)[1]
    return ('Metadata-Version: 2.1\nName: envmap\n'
            f'Version: {version}\nSummary: {value("description")}\nLicense: MIT\n'
            f'Requires-Python: {value("requires-python")}\nRequires-Dist: numpy\n'
            'Description-Content-Type: text/markdown\n\n' + (SOURCE / 'docs/python.md').read_text())


def make_tree(build, tree, version):
    """The package with its libraries. @return the wheel's tag."""
    bundle.run('cmake', '--install', build, '--prefix', tree / 'installed', '--strip', '--component', 'python')
    package = next((tree / 'installed').rglob('dist-packages/envmap'))
    package = package.rename(tree / 'envmap')
    for left in sorted((tree / 'installed').rglob('*'), reverse=True):
        left.rmdir()
    (tree / 'installed').rmdir()
    module = next(package.glob('_envmap.*.so'))
    found = {name: file for name, file in bundle.libraries(module).items() if not bundle.GLIBC.match(name)}
    bundle.copy_libraries(found, package / 'lib')
    bundle.set_run_path(module, '$ORIGIN/lib')
    python = 'cp' + re.search(r'cpython-(\d+)-x86_64-linux-gnu', module.name)[1]
    major, minor = bundle.least_glibc(module, *(package / 'lib').iterdir())
    tag = f'{python}-{python}-manylinux_{major}_{minor}_x86_64'
    info = tree / f'envmap-{version}.dist-info'
    packages = bundle.packages_of(found.values(), (*bundle.COMPILED_IN, 'pybind11-dev'))
    bundle.copy_licences(packages, info / 'licenses')
    (info / 'licenses/LICENSE').write_bytes((SOURCE / 'LICENSE').read_bytes())
    (info / 'sboms').mkdir()
    bundle.write_bill(version, packages, info / f'sboms/envmap-{version}-{tag}.spdx.json')
    (info / 'METADATA').write_text(metadata(version))
    (info / 'WHEEL').write_text(f'Wheel-Version: 1.0\nGenerator: envmap packaging/wheel.py\nRoot-Is-Purelib: false\nTag: {tag}\n')
    return tag


def pack(tree, wheel):
    """Sorted, of one time, with a digest of each file in RECORD, which comes last."""
    when = time.gmtime(max(bundle.date(), 315532800))[:6]  # The format's years begin with 1980.
    record = next(tree.glob('*.dist-info')) / 'RECORD'
    lines = ''
    partial = wheel.with_name(wheel.name + '.part')
    with zipfile.ZipFile(partial, 'w', zipfile.ZIP_DEFLATED, compresslevel=9) as out:
        def add(name, data, mode):
            entry = zipfile.ZipInfo(name, when)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, (0o100000 | mode) << 16
            out.writestr(entry, data)

        for path in sorted(p for p in tree.rglob('*') if p.is_file()):
            name, data = str(path.relative_to(tree)), path.read_bytes()
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip('=')
            lines += f'{name},sha256={digest},{len(data)}\n'
            add(name, data, 0o755 if path.suffix == '.so' or path.parent.name == 'lib' else 0o644)
        name = str(record.relative_to(tree))
        add(name, lines + f'{name},,\n', 0o644)
    partial.rename(wheel)
    print(f'{wheel}  {wheel.stat().st_size / 1e6:.1f} MB')


def main():
    words = [pathlib.Path(word) for word in sys.argv[1:]]
    if len(words) > 2 or any(str(word).startswith('-') for word in words):
        sys.exit(__doc__.strip())
    build, output = (words + [pathlib.Path('build/release'), pathlib.Path('build')][len(words):])[:2]
    bundle.need('cmake', 'patchelf', 'readelf', 'ldd', 'dpkg')
    version = bundle.version_of(build)
    if not list((build / 'python/envmap').glob('_envmap.*.so')):
        bundle.fail(f'{build}: has no Python module: configure it with -DENVMAP_PYTHON=ON')
    output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as work:
        tree = pathlib.Path(work) / 'wheel'
        tree.mkdir()
        tag = make_tree(build, tree, version)
        pack(tree, output / f'envmap-{version}-{tag}.whl')


if __name__ == '__main__':
    main()

#!/usr/bin/env python3
"""Makes an archive of the program that runs on any Linux of x86-64, from a build on Debian 12 or 13:

  packaging/portable.py [BUILD [OUTPUT]] [--formats] [--folder]     (default: build/release, build)

  envmap-VERSION-linux-x86_64.tar.xz            program, libraries, loader, drawing on the processor, pages, sample, licences
  envmap-VERSION-linux-x86_64-formats.tar.xz    --formats: what reads OpenImageIO's formats, to unpack over the other one
  --folder                                      leaves the folder OUTPUT/envmap-VERSION-linux-x86_64, and packs nothing

Packing the same build twice gives the same bytes. Needs patchelf, xz, libosmesa6 and fonts-dejavu-core.
"""
import pathlib
import shutil
import subprocess
import sys
import tarfile
import tempfile

import bundle

LAUNCHER = '''#!/bin/sh
# Starts the program of this name with the loader and the libraries of this folder, wherever it lies. Libraries that
# LD_LIBRARY_PATH names belong to another loader, so it does not count.
program=$(readlink -f "$0")
here=${program%/bin/*}
exec "$here/lib/ld-linux-x86-64.so.2" --library-path '' --argv0 "$program" "$here/lib/${program##*/}-program" "$@"
'''

README = '''envmap {version} for Linux on x86-64. Nothing has to be installed.

    bin/envmap --version
    bin/envmap preview share/envmap/samples/sample.hdr sample.png --sheet

The folder may lie anywhere. Put its bin on the PATH, or link to bin/envmap. 'man -l share/man/man1/envmap.1' shows the
manual, and 'eval "$(bin/envmap completion)"' completes commands in bash.

'render' and 'view' draw with the graphics card if its driver is of this system and can be loaded, else on the processor.
'--context osmesa' leaves the driver alone.
EXR, HDR, PNG, PFM, KTX, KTX2, DDS and .env files are read and written, JPEG and TIFF read. For the rest, unpack
envmap-{version}-linux-x86_64-formats.tar.xz over this folder.

envmap is under the MIT licence: share/doc/envmap/LICENSE. The libraries in lib are Debian's, unchanged but for the path
on which they look for each other. share/doc/envmap/licenses has their licences, and share/doc/envmap/*.spdx.json their
versions and where Debian keeps their sources. By the terms of libjbig (GPL 2 or later), the whole may be passed on under
the GPL, version 3.
'''


def installed(build, into):
    """The program of a build with its pages, completions and samples. @return the module of formats, where it is installed."""
    bundle.run('cmake', '--install', build, '--prefix', into, '--strip', '--component', 'envmap')
    shutil.rmtree(into / 'include')
    module = next(into.glob('lib/**/envmap-formats.so')).relative_to(into)
    for path in sorted((into / 'lib').rglob('*'), reverse=True):
        if path.is_symlink() or path.is_file():
            if path != into / module:
                path.unlink()
        elif not any(path.iterdir()):
            path.rmdir()
    return module


def document(found, version, name, doc, more=()):
    packages = bundle.packages_of(found.values(), more)
    bundle.copy_licences(packages, doc / 'licenses')
    bundle.write_bill(version, packages, doc / f'{name}.spdx.json')


def osmesa():
    for folder in pathlib.Path('/usr/lib/x86_64-linux-gnu'), pathlib.Path('/usr/lib64'):
        if (file := folder / 'libOSMesa.so.8').exists():
            return file
    bundle.fail('no libOSMesa.so.8: install libosmesa6 (Debian 12 and 13 have it)')


def make_program(tree, version, name):
    """Libraries, loader, font and documents, around what is installed."""
    programs = [start.rename(tree / f'lib/{start.name}-program') for start in sorted((tree / 'bin').iterdir())]
    found = bundle.libraries(*programs, osmesa()) | {'libOSMesa.so.8': osmesa()}
    bundle.copy_libraries(found, tree / 'lib')
    for program in programs:
        bundle.set_run_path(program, '$ORIGIN')
        start = tree / 'bin' / program.name.removesuffix('-program')
        start.write_text(LAUNCHER)
        start.chmod(0o755)
    (tree / 'share/fonts').mkdir(parents=True)
    shutil.copyfile('/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf', tree / 'share/fonts/DejaVuSans.ttf')
    (tree / 'README.txt').write_text(README.format(version=version))
    document(found, version, name, tree / 'share/doc/envmap', (*bundle.COMPILED_IN, 'fonts-dejavu-core'))


def make_formats(tree, module, version, name, program):
    """The module and the libraries that the program does not bring."""
    found = {soname: file for soname, file in bundle.libraries(tree / module).items() if soname not in program}
    bundle.copy_libraries(found, tree / 'lib')
    bundle.set_run_path(tree / module, '$ORIGIN/' + '../' * (len(module.parts) - 2))
    document(found, version, name, tree / 'share/doc/envmap')


def pack(tree, archive):
    """Sorted, of nobody, of one time."""
    def plain(entry):
        entry.uid = entry.gid = 0
        entry.uname = entry.gname = ''
        entry.mtime = bundle.date()
        entry.mode = 0o755 if entry.isdir() or entry.mode & 0o100 else 0o644
        return entry

    partial = archive.with_name(archive.name + '.part')
    with open(partial, 'wb') as out, subprocess.Popen(['xz', '--x86', '--lzma2=preset=9', '-T1', '-c'], stdin=subprocess.PIPE, stdout=out) as xz:
        with tarfile.open(fileobj=xz.stdin, mode='w|', format=tarfile.GNU_FORMAT) as tar:
            for path in [tree, *sorted(tree.rglob('*'))]:
                tar.add(path, path.relative_to(tree.parent), recursive=False, filter=plain)
        xz.stdin.close()
    if xz.returncode:
        bundle.fail(f'{archive}: xz failed')
    partial.rename(archive)
    print(f'{archive}  {archive.stat().st_size / 1e6:.1f} MB')


def finish(tree, output, folder):
    if not folder:
        return pack(tree, output / f'{tree.name}.tar.xz')
    shutil.copytree(tree, output / tree.name, dirs_exist_ok=True)
    print(output / tree.name)


def main():
    options = [word for word in sys.argv[1:] if word.startswith('-')]
    words = [pathlib.Path(word) for word in sys.argv[1:] if not word.startswith('-')]
    if len(words) > 2 or set(options) - {'--formats', '--folder'}:
        sys.exit(__doc__.strip())
    build, output = (words + [pathlib.Path('build/release'), pathlib.Path('build')][len(words):])[:2]
    bundle.need('cmake', 'patchelf', 'xz', 'ldd', 'dpkg')
    version = bundle.version_of(build)
    name = f'envmap-{version}-linux-x86_64'
    output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as work:
        tree, other = pathlib.Path(work) / name, pathlib.Path(work) / 'formats' / name
        module = installed(build, tree)
        (other / module).parent.mkdir(parents=True)
        (tree / module).rename(other / module)
        if not any((tree / module).parent.iterdir()):
            (tree / module).parent.rmdir()
        make_program(tree, version, name)
        program = {file.name for file in (tree / 'lib').iterdir()}
        finish(tree, output, '--folder' in options)
        if '--formats' in options:
            make_formats(other, module, version, name + '-formats', program)
            if '--folder' in options:
                finish(other, output, True)
            else:
                pack(other, output / f'{name}-formats.tar.xz')


if __name__ == '__main__':
    main()

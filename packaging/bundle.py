"""What portable.py and wheel.py share: the shared libraries of a binary, copied beside it with a run path of their own, the licences of
the Debian packages that they come from, and a bill of materials (SPDX 2.3)."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

# Of one build with the loader, which finds them without a run path.
GLIBC = re.compile(r'(ld-linux.*|lib(c|m|mvec|dl|rt|pthread|resolv|util)\.so\.\d+)$')
# Compiled in: their headers leave no library to copy, and their licences ask to be told all the same.
COMPILED_IN = ('libglm-dev', 'libcli11-dev', 'nlohmann-json3-dev', 'python3-glad')


def fail(message):
    sys.exit(f'{pathlib.Path(sys.argv[0]).name}: {message}')


def run(*command, **more):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **more)
    if done.returncode:
        fail(f'{command[0]}: {done.stderr.strip() or done.stdout.strip()}')
    return done.stdout


def need(*programs):
    lacking = [p for p in programs if shutil.which(p) is None]
    if lacking:
        fail(f'install {" ".join(lacking)}')


def date():
    """SOURCE_DATE_EPOCH, else the date of the commit. All that is packed has it, so that packing twice gives the same bytes."""
    given = os.environ.get('SOURCE_DATE_EPOCH')
    source = pathlib.Path(__file__).resolve().parents[1]
    return int(given or run('git', '-C', source, 'log', '-1', '--format=%ct'))


def libraries(*binaries):
    """@return soname -> file, of all that these load, the loader included."""
    found = {}
    for binary in binaries:
        for line in run('ldd', binary).splitlines():
            if 'not found' in line:
                fail(f'{binary}: {line.strip()}')
            if (line := re.match(r'\s*(?:(\S+) => )?(/\S+) \(', line)):
                file = pathlib.Path(line[2])
                found[line[1] or file.name] = file
    return found


def copy_libraries(found, folder):
    """Under their sonames. Each finds the others beside itself, and nobody else's."""
    folder.mkdir(parents=True, exist_ok=True)
    for soname, file in sorted(found.items()):
        copy = folder / soname
        shutil.copyfile(file, copy)
        copy.chmod(0o755)
        if not GLIBC.match(soname):
            set_run_path(copy, '$ORIGIN')


def set_run_path(binary, path):
    run('patchelf', '--set-rpath', path, binary)


def least_glibc(*binaries):
    """The oldest glibc that these run on, such as (2, 36)."""
    versions = [tuple(map(int, v.split('.'))) for b in binaries
                for v in re.findall(r'\bGLIBC_(\d+\.\d+)', run('readelf', '--version-info', '--wide', b))]
    return max(versions)


def owners(files):
    """The Debian packages of files. Lists of packages name files by the folder in which they were before /lib was a link."""
    real = [str(pathlib.Path(f).resolve()) for f in files]
    done = subprocess.run(['dpkg', '-S', *real, *(f.removeprefix('/usr') for f in real)], capture_output=True, text=True)
    owner = {file.removeprefix('/usr'): names.split(':')[0] for names, file in (line.split(': ', 1) for line in done.stdout.splitlines())}
    for file in real:
        if file.removeprefix('/usr') not in owner:
            fail(f'{file}: no Debian package has it')
    return set(owner.values())


def packages_of(files, more=()):
    """@return rows (name, version, source package, its version, homepage), sorted."""
    names = owners(files) | set(more)
    form = '${Package}\t${Version}\t${source:Package}\t${source:Version}\t${Homepage}\n'
    rows = {tuple(line.split('\t')) for line in run('dpkg-query', '-W', '-f', form, *sorted(names)).splitlines()}
    return sorted(rows)


def copy_licences(packages, folder):
    """What each package says of its copyright, and the texts that it names."""
    folder.mkdir(parents=True, exist_ok=True)
    common = set()
    for name, *_ in packages:
        text = pathlib.Path(f'/usr/share/doc/{name}/copyright').read_bytes()
        (folder / f'{name}.txt').write_bytes(text)
        common |= {word.rstrip(b'.') for word in re.findall(rb'/usr/share/common-licenses/([\w.+-]+)', text)}
    for licence in sorted(common):
        file = pathlib.Path('/usr/share/common-licenses') / os.fsdecode(licence)
        if file.exists():
            shutil.copyfile(file, folder / file.name)


def write_bill(version, packages, file):
    """Names and versions of what is bundled, as SPDX 2.3."""
    def entry(name, of_version, more):
        return {'SPDXID': f'SPDXRef-{re.sub("[^A-Za-z0-9.-]", "-", name)}', 'name': name, 'versionInfo': of_version,
                'downloadLocation': 'NOASSERTION', 'licenseConcluded': 'NOASSERTION', 'licenseDeclared': 'NOASSERTION',
                'copyrightText': 'NOASSERTION', 'filesAnalyzed': False, **more}

    entries = [entry('envmap', version, {'licenseDeclared': 'MIT'})]
    for name, of_version, source, source_version, home in packages:
        entries.append(entry(name, of_version, {
            **({'homepage': home} if home else {}),
            'sourceInfo': f'Debian source package {source} {source_version}, in https://snapshot.debian.org/package/{source}/',
            'externalRefs': [{'referenceCategory': 'PACKAGE-MANAGER', 'referenceType': 'purl',
                              'referenceLocator': f'pkg:deb/debian/{name}@{of_version.replace("+", "%2B").replace(":", "%3A")}'}]}))
    bill = {
        'spdxVersion': 'SPDX-2.3', 'dataLicense': 'CC0-1.0', 'SPDXID': 'SPDXRef-DOCUMENT', 'name': file.name,
        'documentNamespace': f'https://spdx.org/spdxdocs/{file.stem}-{date()}',
        'creationInfo': {'created': time.strftime('%Y-%m-%dT%H:%M:%SZ', time.gmtime(date())), 'creators': ['Tool: envmap packaging/bundle.py']},
        'packages': entries,
        'relationships': [{'spdxElementId': 'SPDXRef-DOCUMENT', 'relationshipType': 'DESCRIBES', 'relatedSpdxElement': 'SPDXRef-envmap'}] +
                         [{'spdxElementId': 'SPDXRef-envmap', 'relationshipType': 'DEPENDS_ON', 'relatedSpdxElement': e['SPDXID']}
                          for e in entries[1:]]}
    file.write_text(json.dumps(bill, indent=1) + '\n')


def version_of(build):
    cache = (build / 'CMakeCache.txt').read_text() if (build / 'CMakeCache.txt').exists() else fail(f'{build}: nothing is built there')
    return re.search(r'^CMAKE_PROJECT_VERSION:\w+=(.+)$', cache, re.M)[1]

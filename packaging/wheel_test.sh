#!/bin/sh
# Tries the wheel in a Debian that has Python with numpy and nothing else, in a venv: maps, files, rays, the examples of all functions, and that
# it does not look for libraries outside of it.
#
#   sh packaging/wheel_test.sh WHEEL [SUITE]     (default: bookworm, whose Python is 3.11)
#
# Needs mmdebstrap, root or user namespaces, and a mirror. numpy is Debian's.
set -eu
cd "$(dirname "$0")/.."
[ $# -ge 1 ] || { echo 'wheel_test: name a wheel' >&2; exit 2; }
wheel=$(readlink -f "$1")
suite=${2:-bookworm}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/wheels"
cp "$wheel" samples/sample.hdr "$work/wheels"

cat >"$work/own.py" <<'PYTHON'
import doctest
import pathlib

import envmap

sample = envmap.read("/wheels/sample.hdr")
cube = envmap.convert(sample, "cube", size=32)
for name in "cube.exr", "cube.png", "cube.hdr", "cube.ktx2", "cube.dds":
    envmap.write(name, cube, clamp=True)
    assert envmap.read(name).projection == "cube", name
ggx = envmap.prefilter(cube, "ggx", roughness=0.5, size=16)
assert ggx.map.array.shape == (6, 16, 16, 3)
open("floor.obj", "w").write("v -1 0 -1\nv 1 0 -1\nv 0 0 1\nf 1 2 3\n")
drawn = envmap.render("floor.obj", "cube", size=8, environment=sample, method="raycast")
# Its own libraries, and no others of these names. Those of GCC may be there already, for numpy.
own = pathlib.Path(envmap.__file__).parent / "lib"
loaded = {pathlib.Path(line.split()[-1]) for line in open("/proc/self/maps") if ".so" in line}
foreign = [f for f in loaded if (own / f.name).exists() and f.parent != own and not f.name.startswith(("libstdc++", "libgcc_s"))]
assert not foreign and any(f.parent == own for f in loaded), foreign
# What help() shows of each function.
failed, examples = doctest.testmod(envmap)
assert examples and not failed
print("wheel_test: envmap", envmap.__version__, "read, converted, prefiltered, wrote and drew, and ran", examples, "lines of examples")
PYTHON
tar -C "$work" -cf "$work/tree.tar" wheels own.py

mmdebstrap --quiet --variant=apt --include=python3-venv,python3-numpy \
  --customize-hook="tar-in $work/tree.tar /" \
  --customize-hook='chroot "$1" python3 -m venv --system-site-packages /venv' \
  --customize-hook='chroot "$1" /venv/bin/pip -q install --no-index --find-links /wheels envmap' \
  --customize-hook='mount -t proc proc "$1/proc"; chroot "$1" env -i PATH=/usr/bin:/bin sh -c "cd /tmp && /venv/bin/python /own.py"; status=$?; umount "$1/proc"; exit $status' \
  "$suite" /dev/null

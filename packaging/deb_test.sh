#!/bin/sh
# Makes the two packages, has lintian look at them, installs them in a bare Debian of this release and works with them there: the program, its formats
# and completions, the Python module, and a program of others built on the library. Needs 'sh packages.sh deb', root or user namespaces, and a mirror.
#
#   sh packaging/deb_test.sh
set -eu
cd "$(dirname "$0")/.."

cmake --preset deb >/dev/null
cmake --build --preset deb
rm -f build/deb/*.deb
cpack --preset deb >/dev/null
deb=$(echo build/deb/envmap_*.deb)
python=$(echo build/deb/python3-envmap_*.deb)

found=$(lintian --fail-on none "$deb" "$python" 2>/dev/null)
printf '%s\n' "$found"
if printf '%s\n' "$found" | grep -q '^E:'; then
  echo "deb_test: lintian finds errors" >&2
  exit 1
fi

# What runs in the new system. Maps come from 'generate'; that a latlong map of 1 is 1 as a cube, everyone knows.
cat >build/deb/inside.sh <<'INSIDE'
set -eu
cd /tmp
envmap --version
envmap generate constant white.exr --size 16 --value 1
envmap convert white.exr cube.png --to cube
envmap convert cube.png back.exr --to latlong --size 16
envmap compare back.exr white.exr --max-error 1e-6
test -f /usr/share/man/man1/envmap-convert.1.gz
test -f /usr/share/bash-completion/completions/envmap
ldconfig -p | grep -q libenvmap.so.1.0
ldconfig -p | grep -q libenvmap-scenes.so.1.0
cat >own.py <<'PYTHON'
import envmap
white = envmap.read("white.exr")
cube = envmap.convert(white.array, "cube", size=8)
assert abs(cube.array - 1).max() < 1e-6
envmap.write("cube.tif", cube)  # By the module of the other package.
assert envmap.read("cube.tif").projection == "cube"
PYTHON
python3 own.py
test -d /usr/lib/python3/dist-packages/envmap/__pycache__
cat >own.cpp <<'CPP'
#include <envmap/envmap.h>
int main() { return envmap::read("white.exr").map.base().height() == 16 ? 0 : 1; }
CPP
g++ -std=c++20 own.cpp -o own $(pkg-config --cflags --libs envmap)
./own
printf 'v -1 0 -1\nv 1 0 -1\nv 0 0 1\nf 1 2 3\n' >floor.obj
cat >scene.cpp <<'CPP'
#include <envmap/scenes.h>
int main() {
  const envmap::Source sky = envmap::read("white.exr");
  return envmap::render("floor.obj", {.size = 8, .method = envmap::DrawMethod::raycast}, &sky.map).map.levels.size() == 1 ? 0 : 1;
}
CPP
g++ -std=c++20 scene.cpp -o scene $(pkg-config --cflags --libs envmap-scenes)
./scene
mkdir project
cp own.cpp project
printf '%s\n' 'cmake_minimum_required(VERSION 3.25)' 'project(own CXX)' 'find_package(envmap 1 CONFIG REQUIRED)' \
  'add_executable(own own.cpp)' 'target_link_libraries(own PRIVATE envmap::envmap)' >project/CMakeLists.txt
cmake -S project -B project/build >/dev/null
cmake --build project/build >/dev/null
project/build/own
mkdir maps
printf '%s\n' 'cmake_minimum_required(VERSION 3.25)' 'project(maps LANGUAGES NONE)' 'find_package(envmap 1 CONFIG REQUIRED)' \
  'envmap_add_map(maps SOURCE /tmp/white.exr OUTPUT cube.exr OPTIONS --to cube)' >maps/CMakeLists.txt
cmake -S maps -B maps/build >/dev/null
cmake --build maps/build >/dev/null
test -f maps/build/cube.exr
apt-get -qq -y remove envmap python3-envmap >/dev/null
test ! -e /usr/bin/envmap
test ! -e /usr/lib/python3/dist-packages/envmap
echo "deb_test: installed, used and removed"
INSIDE

mmdebstrap --quiet --variant=apt \
  --customize-hook="copy-in $deb $python build/deb/inside.sh /tmp" \
  --customize-hook='chroot "$1" sh -c "apt-get -qq -y --no-install-recommends install /tmp/*.deb >/dev/null && envmap --version"' \
  --customize-hook='chroot "$1" sh -c "apt-get -qq -y --no-install-recommends install g++ cmake make pkg-config libglm-dev >/dev/null"' \
  --customize-hook='chroot "$1" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin sh /tmp/inside.sh' \
  "$(. /etc/os-release && echo "$VERSION_CODENAME")" /dev/null

#!/bin/sh
# Makes the .deb, has lintian look at it, installs it in a bare Debian 12 and works with it there: the program, its formats and
# completions, and a program of others built on its library. Needs 'sh packages.sh deb', root or user namespaces, and a mirror.
#
#   sh packaging/deb_test.sh
set -eu
cd "$(dirname "$0")/.."

cmake --preset deb >/dev/null
cmake --build --preset deb
rm -f build/deb/envmap_*.deb
cpack --preset deb >/dev/null
deb=$(echo build/deb/envmap_*.deb)

found=$(lintian --fail-on none "$deb" 2>/dev/null)
printf '%s\n' "$found"
if printf '%s\n' "$found" | grep -q '^E:'; then
  echo "deb_test: lintian finds errors in $deb" >&2
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
ldconfig -p | grep -q libenvmap.so.1
cat >own.cpp <<'CPP'
#include <envmap/envmap.h>
int main() { return envmap::read("white.exr").map.base().height() == 16 ? 0 : 1; }
CPP
g++ own.cpp -o own $(pkg-config --cflags --libs envmap)
./own
mkdir project
cp own.cpp project
printf '%s\n' 'cmake_minimum_required(VERSION 3.25)' 'project(own CXX)' 'find_package(envmap 1 CONFIG REQUIRED)' \
  'add_executable(own own.cpp)' 'target_link_libraries(own PRIVATE envmap::envmap)' >project/CMakeLists.txt
cmake -S project -B project/build >/dev/null
cmake --build project/build >/dev/null
project/build/own
apt-get -qq -y remove envmap >/dev/null
test ! -e /usr/bin/envmap
echo "deb_test: installed, used and removed"
INSIDE

mmdebstrap --quiet --variant=apt \
  --customize-hook="copy-in $deb build/deb/inside.sh /tmp" \
  --customize-hook='chroot "$1" sh -c "apt-get -qq -y --no-install-recommends install /tmp/envmap_*.deb >/dev/null 2>&1 && envmap --version"' \
  --customize-hook='chroot "$1" sh -c "apt-get -qq -y --no-install-recommends install g++ cmake make pkg-config libglm-dev >/dev/null 2>&1"' \
  --customize-hook='chroot "$1" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin sh /tmp/inside.sh' \
  bookworm /dev/null

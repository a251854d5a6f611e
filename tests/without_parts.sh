#!/bin/sh
# The library without its parts: no scenes, no program, no OpenImageIO. It takes the objects of a build that is there, so that it costs some
# configurations, and leaves the build as it was. The last line is 'N passed, N failed'.
#
#   sh tests/without_parts.sh [PRESET]     (default: release)
set -eu
cd "$(dirname "$0")/.."
preset=${1:-release}
build=$PWD/build/$preset

configure() {
  cmake --preset "$preset" "$@" >/dev/null
}

restore() {
  [ ! -f "$build/aside.so" ] || mv "$build/aside.so" "$build/envmap-formats.so"
  configure -DENVMAP_SCENES=ON -DENVMAP_OPENIMAGEIO=ON
}
trap restore EXIT
trap 'exit 1' INT TERM HUP

# The program without OpenImageIO has to go through the configuration; to build it would take minutes.
configure -DENVMAP_SCENES=ON -DENVMAP_OPENIMAGEIO=OFF
configure -DENVMAP_SCENES=OFF -DENVMAP_OPENIMAGEIO=OFF -DENVMAP_PYTHON=OFF -DENVMAP_BENCH=OFF
cmake --build "$build" --target envmap envmap_shared library_tests
mv "$build/envmap-formats.so" "$build/aside.so"
# TIFF files are written by the module.
ctest --test-dir "$build" -L library -E 'HasTheBytesOfAFile/tif' -j "$(nproc)" --output-on-failure --no-tests=error --output-junit "$build/without_parts.xml"
rm -rf "$build/without_parts"
cmake --install "$build" --prefix "$build/without_parts" >/dev/null
for path in bin lib/envmap include/envmap/scenes.h share/bash-completion; do
  [ ! -e "$build/without_parts/$path" ] || { echo "without_parts: $path is installed" >&2; exit 1; }
done
echo "$(grep -c '<testcase .*status="run"' "$build/without_parts.xml") passed, 0 failed"

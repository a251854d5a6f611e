#!/bin/sh
# Balls lit by a real probe in every engine, beside `envmap view` and beside Cycles (Debian's blender, where it is installed).
#
#   [ENVMAP=PROGRAM] [ENGINES_FOLDER=FOLDER] sh tests/engines/real.sh PROBE [ENGINE...]
#
# A probe without values over 255, which .env and glTF files cut off. What was found goes to real.json. By hand: it downloads as
# run.sh does, and Cycles takes minutes.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
envmap=$(realpath "${ENVMAP:-$here/../../build/ci/envmap}")
probe=$(realpath "$1")
shift
. "$here/install.sh"
[ $# -gt 0 ] || set -- babylon babylon-env filament gltf playcanvas three three-latlong three-webgpu
for engine in "$@" blender; do
  bake_for "$engine" "$probe" "probes/$engine-real"
done
cp "$here"/cycles.py .
node balls.mjs
for ball in balls/*.glb; do
  "$envmap" view "$ball" "${ball%.glb}.exr" --environment "$probe" --camera 6,4,8 --look-at 0,0,0 --fov 11.6 --width 64 --height 64 \
    --samples 16 --occlusion 0 -q
done
command -v blender >/dev/null && blender -b --factory-startup -P cycles.py >/dev/null
node compare.mjs "$("$envmap" --version | head -n 1)" "$(basename "$probe")" "$here/real.json" "$@"

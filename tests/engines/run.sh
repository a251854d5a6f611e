#!/bin/sh
# What engines really show of the folders that `envmap bake` writes for them, in headless Chromium on Mesa (libgl1-mesa-dri, libegl1).
#
#   [ENVMAP=PROGRAM] sh tests/engines/run.sh [ENGINE...]
#
# Installs the engines of package.json with npm in a temporary folder (ENGINES_FOLDER keeps one), bakes probes whose answer is
# known, loads them by each engine's own loader into its own shader, and reads pixels back. What was seen goes to results.json.
# Needs node, npm and chromium (Debian's); without them it says so and ends with 0. Not part of the test suite: it downloads.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
envmap=$(realpath "${ENVMAP:-$here/../../build/ci/envmap}")
. "$here/install.sh"

# The probes: what stands in each direction, white, and one small sun towards (1, 2, 3) / sqrt(14).
"$envmap" generate directions "probes/directions.exr" --to cube --size 256
"$envmap" generate constant "probes/white.exr" --to cube --size 256 --value 1
"$envmap" generate sun "probes/sun.exr" --to cube --size 256 --direction 1,2,3 --radius 1 --value 200 --zenith 0 --ground 0
[ $# -gt 0 ] || set -- babylon babylon-env cesium filament gltf playcanvas three three-jpeg three-latlong three-webgpu
for engine; do
  for probe in directions white sun; do
    bake_for "$engine" "probes/$probe.exr" "probes/$engine-$probe"
  done
done
node run.mjs "$("$envmap" --version | head -n 1)" "$here/results.json" "$@"

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
for tool in node npm chromium; do
  command -v $tool >/dev/null || { echo "tests/engines: skipped, no $tool here"; exit 0; }
done
if [ -n "${ENGINES_FOLDER:-}" ]; then
  folder=$ENGINES_FOLDER
  mkdir -p "$folder"
else
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
fi
cp "$here/package.json" "$folder"
if [ ! -d "$folder/node_modules" ] && ! npm --prefix "$folder" install --silent --no-audit --no-fund; then
  echo "tests/engines: skipped, npm cannot install the engines"
  exit 0
fi

# The probes: what stands in each direction, white, and one small sun towards (1, 2, 3) / sqrt(14).
rm -rf "$folder/probes"
mkdir "$folder/probes"
"$envmap" generate directions "$folder/probes/directions.exr" --to cube --size 256
"$envmap" generate constant "$folder/probes/white.exr" --to cube --size 64 --value 1
"$envmap" generate sun "$folder/probes/sun.exr" --to cube --size 256 --direction 1,2,3 --radius 1 --value 1000 --zenith 0 --ground 0
[ $# -gt 0 ] || set -- babylon filament playcanvas three
for engine; do
  for probe in directions white sun; do
    "$envmap" bake "$folder/probes/$probe.exr" "$folder/probes/$engine-$probe" --for "$engine" -q
  done
done
cp "$here"/*.mjs "$here"/*.html "$folder"
cd "$folder"
node run.mjs "$("$envmap" --version | head -n 1)" "$here/results.json" "$@"

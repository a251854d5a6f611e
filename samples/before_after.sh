#!/bin/sh
# Draws samples/before-after.jpg: a panorama with a small sun as cubes of 32, by exrenvmap and by envmap, and the balls that each
# map lights. Prints what the cubes differ from the means over their texels.
#
#   sh samples/before_after.sh [ENVMAP [OUTPUT]]      (default: build/release/envmap, samples/before-after.jpg)
#
# Needs exrenvmap (openexr-tools).
set -eu
cd "$(dirname "$0")/.."
envmap=$(realpath "${1:-build/release/envmap}")
output=$(realpath "${2:-samples/before-after.jpg}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# Seven stops down, the sun fits into half floats.
"$envmap" generate atmosphere sky.exr --size 1024 --elevation 30 --azimuth 13 -q
"$envmap" convert sky.exr source.exr --exposure=-7 --depth half -q
exrenvmap -c -w 32 source.exr exrenvmap.exr
"$envmap" convert source.exr envmap.exr --to cube --size 32 -q
"$envmap" convert source.exr mean.exr --to cube --size 32 --filter bilinear --samples 64 -q
for map in exrenvmap envmap; do
  echo "$map:"
  "$envmap" compare "$map.exr" mean.exr -q | head -n 2
done
"$envmap" preview source.exr exrenvmap.exr envmap.exr "$output" --balls --height 112

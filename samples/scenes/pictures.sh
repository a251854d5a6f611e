#!/bin/sh
# Makes lookup.jpg: a mirror ball on a table, its map looked up by direction alone, by distance, and the truth by rays.
#
#   sh samples/scenes/pictures.sh [ENVMAP]        (default: build/release/envmap)
#
# Needs oiiotool (openimageio-tools), to lay pictures side by side.
set -eu
cd "$(dirname "$0")/../.."
envmap=${1:-build/release/envmap}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

python3 samples/scenes/make.py "$work"
"$envmap" generate sky "$work/sky.exr" --size 256 -q
look() {
  name=$1
  shift
  "$envmap" view "$work/ball.glb" "$work/$name.png" --environment "$work/sky.exr" --width 480 --height 360 --samples 4 -q "$@"
}
look direction --lookup direction
look distance --lookup distance
look rays --method raycast
oiiotool "$work/direction.png" "$work/distance.png" "$work/rays.png" --mosaic 3x1 \
  --compression jpeg:88 -o samples/scenes/lookup.jpg
echo samples/scenes/lookup.jpg

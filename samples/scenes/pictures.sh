#!/bin/sh
# Makes cellar.jpg: two views of the cellar through dynamic maps; lookup.jpg: a mirror ball on a table, its map looked up by direction alone, by distance, and the truth by rays;
# and balls.jpg: mirror, glass, metals and plastics under a sunny sky, by rays (two minutes on two cores).
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
for camera in entrance table; do
  "$envmap" view "$work/cellar.glb" "$work/$camera.png" --camera $camera --width 500 --height 375 --samples 8 --ambient 0.12 \
    --display neutral --exposure 0.3 -q
done
oiiotool "$work/entrance.png" "$work/table.png" --mosaic 2x1 --compression jpeg:88 -o samples/scenes/cellar.jpg
echo samples/scenes/cellar.jpg
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

"$envmap" generate sun "$work/sun.exr" --direction=-0.75,0.8,-0.25 --radius 1 --value 7000,6200,5000 --zenith 1.2 \
  --ground 0.35 --size 512 -q
"$envmap" view "$work/balls.glb" "$work/balls.png" --environment "$work/sun.exr" --method raycast --width 1600 --height 900 \
  --samples 9 --occlusion 96 --display neutral --exposure -0.7 -q
oiiotool "$work/balls.png" --compression jpeg:85 -o samples/scenes/balls.jpg
echo samples/scenes/balls.jpg

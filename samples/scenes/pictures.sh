#!/bin/sh
# Makes the pictures of docs/how-to/scenes.md, all of generated scenes, skies and rooms:
#   cellar.jpg    two views of the cellar through dynamic maps
#   lookup.jpg    a mirror ball on a table, its map looked up by vertex, by direction and by distance, and the truth by rays
#   facing.jpg    two mirrors that face each other: 1, 2 and 4 rounds of pictures in pictures and maps, and by rays
#   metals.jpg    metals of roughness 0.1, 0.3, 0.5 and 0.8 under a low sun: by split sum, sampled, and the integral (minutes)
#   vertices.jpg  a sphere map of a room whose walls have 2, 4, 21 and 21 vertices an edge, the last with two-sided materials,
#                 drawn by distort, tessellate and exact
#   balls.jpg     mirror, glass, metals and plastics under a sunny sky, or in a probe of yours, by rays (minutes)
#   texture-filters.jpg  a receding plane with five filters of its texture and by 1024 rays a pixel: docs/tutorial/pictures
#   turn.webp     the balls, seen from all sides (or turn.mp4; where there is ffmpeg)
#
#   sh samples/scenes/pictures.sh [-o FOLDER] [ENVMAP [PROBE]]      (default: samples/scenes, build/release/envmap, a blue sky)
#
# Needs oiiotool (openimageio-tools), to lay pictures side by side.
set -eu
cd "$(dirname "$0")/../.."
out=samples/scenes
if [ "${1:-}" = -o ]; then
  out=$2
  shift 2
fi
envmap=${1:-build/release/envmap}
probe=${2:-}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

python3 samples/scenes/make.py "$work"

# side_by_side COLUMNSxROWS NAME QUALITY PICTURE...
side_by_side() {
  shape=$1 name=$2 quality=$3
  shift 3
  oiiotool "$@" --mosaic:pad=4 "$shape" --compression "jpeg:$quality" -o "$out/$name"
  echo "$out/$name"
}

"$envmap" generate sky "$work/sky.exr" --size 256 -q
for camera in entrance tabletop; do
  "$envmap" view "$work/cellar.glb" "$work/$camera.png" --camera $camera --width 500 --height 375 --samples 8 --ambient 0.12 \
    --display neutral --exposure 0.3 -q
done
side_by_side 2x1 cellar.jpg 88 "$work/entrance.png" "$work/tabletop.png"

look() {
  name=$1
  shift
  "$envmap" view "$work/ball.glb" "$work/$name.png" --environment "$work/sky.exr" --width 400 --height 300 --samples 4 -q "$@"
}
look vertex --lookup vertex
look direction --lookup direction
look distance --lookup distance
look rays --method raycast
side_by_side 4x1 lookup.jpg 88 "$work/vertex.png" "$work/direction.png" "$work/distance.png" "$work/rays.png"

face() {
  name=$1
  shift
  "$envmap" view "$work/facing.glb" "$work/$name.png" --width 400 --height 300 --samples 4 --ambient 0.1 -q "$@"
}
for rounds in 1 2 4; do
  face facing-$rounds --bounces $rounds
done
face facing-rays --method raycast
side_by_side 4x1 facing.jpg 88 "$work/facing-1.png" "$work/facing-2.png" "$work/facing-4.png" "$work/facing-rays.png"

"$envmap" generate sun "$work/low.exr" --size 512 --radius 2.5 --value 120 --direction=-0.9,0.5,-0.75 --zenith 0.25,0.4,0.7 \
  --ground 0.12 -q
shine() {
  name=$1
  shift
  "$envmap" view "$work/metals.glb" "$work/$name.png" --environment "$work/low.exr" --occlusion 0 --width 560 --height 146 -q "$@"
}
shine split-sum
shine sampled --reflection sampled
shine integral --method raycast --lobe-samples 256
side_by_side 1x3 metals.jpg 88 "$work/split-sum.png" "$work/sampled.png" "$work/integral.png"

set --
for method in distort tessellate exact; do
  for vertices in 2 4 21 21-two-sided; do
    map=$work/$method-$vertices
    "$envmap" render "$work/room-$vertices.glb" "$map.exr" --to sphere --method $method --size 300 --ambient 0.25 --samples 4 -q
    oiiotool "$map.exr" --ch R,G,B --mulc 0.5 --colorconvert linear sRGB -d uint8 -o "$map.png"
    set -- "$@" "$map.png"
  done
done
side_by_side 4x3 vertices.jpg 85 "$@"

set --
for filter in nearest bilinear nearest-level trilinear ewa rays; do
  how="--samples 1 --texture-filter $filter"
  [ $filter = rays ] && how="--samples 1024"
  # shellcheck disable=SC2086
  "$envmap" view "$work/plane.glb" "$work/$filter.png" --method raycast --ambient 1 --width 320 --height 200 -q $how
  oiiotool "$work/$filter.png" --crop 320x136+0+64 -o "$work/$filter.png"
  set -- "$@" "$work/$filter.png"
done
side_by_side 3x2 texture-filters.jpg 85 "$@"

if [ -z "$probe" ]; then
  probe=$work/day.exr
  "$envmap" generate sun "$probe" --direction=-0.75,0.8,0.35 --radius 1 --value 7000,6200,5000 --zenith 0.12,0.32,0.85 \
    --horizon 0.75,0.85,0.95 --ground 0.4,0.38,0.36 --size 512 -q
fi
"$envmap" view "$work/balls.glb" "$work/balls.png" --environment "$probe" --method raycast --width 1600 --height 900 \
  --samples 9 --occlusion 96 --display neutral --exposure -0.3 -q
side_by_side 1x1 balls.jpg 82 "$work/balls.png"

if command -v ffmpeg >/dev/null; then
  mkdir "$work/turn"
  "$envmap" view "$work/balls.glb" "$work/turn/{frame}.png" --environment "$probe" --frames 0:47 --orbit 360 --width 384 --height 216 \
    --samples 4 --display neutral --exposure -0.3 -q
  clip=$out/turn.webp
  ffmpeg -loglevel error -y -framerate 16 -i "$work/turn/%04d.png" -loop 0 -quality 50 "$clip" 2>/dev/null || {
    clip=$out/turn.mp4
    ffmpeg -loglevel error -y -framerate 16 -i "$work/turn/%04d.png" -pix_fmt yuv420p "$clip"
  }
  echo "$clip"
fi

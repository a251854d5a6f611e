#!/bin/sh
# Runs every command of the program on small inputs and 8 threads, for builds that look into themselves (sanitizers): what
# makes maps of maps, and beside it what makes light and scenes. Says what it runs. The exit status is 0 only if each
# command's was.
#
#   sh tests/every_command.sh PROGRAM [RUNNER...]
#
# RUNNER is a command that runs others, such as 'setarch -R'.
set -eu

envmap=$1
shift
[ $# -gt 0 ] || set -- env
root=$(cd "$(dirname "$0")/.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

status=0
runner=$*
run() {
  echo "envmap $*"
  # shellcheck disable=SC2086  # Words.
  $runner "$envmap" "$@" --threads 8 || { echo "tests/every_command.sh: exit status $?" >&2; status=1; }
}

projections='latlong cube sphere paraboloid angular octahedral equal-area'

maps() {
  for kind in constant gradient checker directions sun sky sh; do
    run generate $kind $kind.exr --to latlong --size 64
  done
  run generate checker big.exr --to latlong --size 256
  run generate sky sky.hdr --to latlong --size 64
  for projection in $projections; do
    for filter in nearest bilinear bicubic trilinear sat ewa area; do
      run convert sky.exr $projection.exr --to $projection --size 32 --filter $filter
    done
    run convert $projection.exr back.exr --to latlong --size 32 --max-error 0.1
    run mipmap $projection.exr levels.exr
  done
  for format in ktx2 ktx dds hdr pfm tif; do
    run convert sky.exr sky.$format --to cube --size 32 --clamp
    run convert sky.$format again.exr --to latlong --size 32
  done
  run generate directions 'face_{face}.exr' --to cube --size 32
  run convert 'face_{face}.exr' 'turned_{face}.hdr' --to cube --rotate 5,0,0
  run convert 'face_{face}.exr' 'gl_{face}.png' --faces gl --clamp
  run generate atmosphere air.exr --to latlong --size 16 --scattering single
  run convert sky.exr border.exr --to octahedral --size 34 --border 1
  run generate constant large.exr --to latlong --size 1300 --depth half
  run convert large.exr held.exr --to cube --size 64 --max-memory 64M
  run mipmap large.exr held-levels.exr --max-memory 64M
  run convert sky.exr graded.exr --white 0,0,1 --saturation 0.5 --scale-to lux=1000 --output-space ACEScg
  run convert sphere.exr photo.exr --to latlong --size 32 --ball-distance 12
  run convert big.exr big-cube.exr --to cube --size 256 --openexr-envmap --compression zip
  run convert big-cube.exr turned.exr --rotate 10,20,30
  run mipmap big-cube.exr big.ktx2 --zstd --depth half --clamp
  run mipmap big-cube.exr blocks.dds --depth bc6h --clamp
  run convert blocks.dds blocks.exr --to latlong --size 64
  run compare sky.exr cube.exr --difference difference.exr --max-rms 100
  run info big.ktx2 --json
  run preview big.ktx2 sky.png --levels
  run preview sky.exr sheet.png --sheet
  run preview sky.exr --html sky.html
}

light() {
  run generate sky sky.exr --to latlong --size 64
  run generate sun sun.exr --to latlong --size 64
  python3 "$root/samples/scenes/make.py" scenes >/dev/null
  run generate sky small.exr --to cube --size 4
  run prefilter small.exr exact.exr --lobe diffuse --size 4 --method exact
  printf '1 1\n0.5 0.2\n0 0\n' > lobe.txt
  run prefilter small.exr table.exr --lobe-table lobe.txt --size 4
  run prefilter small.exr exact.exr --lobe phong --exponent 50 --size 4 --method exact
  run prefilter small.exr exact.exr --lobe ggx --roughness 0.5 --size 4 --method exact
  for method in auto treecode; do
    run prefilter sky.exr diffuse.exr --lobe diffuse --size 16 --method $method --max-error 0.05
    run prefilter sky.exr phong.exr --lobe phong --exponent 50 --size 16 --method $method --max-error 0.05
  done
  for lobe in ggx charlie; do
    run prefilter sky.exr $lobe.exr --lobe $lobe --roughness 0.5 --size 16 --method treecode --max-error 0.05
  done
  run prefilter sky.exr blinn.exr --lobe blinn-phong --exponent 50 --size 16 --max-error 0.05
  for part in 1 2 3; do
    run prefilter sky.exr part-$part.exr --lobe phong --exponent 50 --size 16 --max-error 0.05 --shard $part/3
  done
  run merge part-1.exr part-2.exr part-3.exr whole.exr
  run prefilter sky.exr chain.ktx2 --lobe ggx --levels 4 --size 32 --max-error 0.05 --brdf-table table.exr --table-size 16 --clamp
  run prefilter sun.exr sun-phong.exr --lobe phong --exponent 1000 --size 32 --max-error 0.05
  run sh sky.exr --order 8 --evaluate sh-back.exr --size 16
  run sh sky.exr --irradiance --window auto
  run lights sun.exr --remainder rest.exr --gltf suns.gltf
  run bake sun.exr sunny --for usd --suns
  run convert sun.exr brighter.exr --restore-sun lux=100000 --depth float
  run lights sky.exr --count 8
  for engine in filament unity babylon gltf; do
    run bake sky.exr $engine --for $engine --chain-size 16 --max-error 0.1 --clamp
  done
  run bake sky.exr glsl --for glsl --chain-size 32 --max-error 0.1 --clamp
  for task in convert:cube:16 mipmap:2 ggx:0.5:cube:4 depth; do
    run tradeoff sky.exr --task $task --budget 0.2
  done
  for scene in scenes/room-2.glb scenes/cellar.glb; do
    for projection in $projections; do
      run render "$scene" scene.exr --at 0.3,1.1,0.2 --to $projection --size 32 --samples 2 --method raycast
    done
    run render "$scene" lit.exr --at 0.3,1.1,0.2 --size 8 --method raycast --environment sky.exr
    run render "$scene" far.exr --at 0.3,1.1,0.2 --size 16 --method raycast --ambient 1 --distance
    run view "$scene" view.png --method raycast --width 16 --height 12 --environment sky.exr
  done
}

# In a folder of its own.
apart() {
  mkdir "$folder/$1"
  cd "$folder/$1"
  "$1"
  exit "$status"
}

(apart maps) &
maps=$!
(apart light) &
wait $maps || status=1
wait $! || status=1
exit "$status"

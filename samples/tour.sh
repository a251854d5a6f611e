#!/bin/sh
# A tour of envmap: makes or takes an HDR environment, converts it to every projection, measures what that cost and
# draws it all as one picture, whose path is the last line printed.
#
#   sh samples/tour.sh                          with a generated environment
#   sh samples/tour.sh probe.hdr [OPTIONS]      with a map of yours; OPTIONS say how to read it, such as --from angular
#
# Installs the Debian packages that are missing and builds first. Writes to out/tour/ only.
set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
map=
if [ $# -gt 0 ]; then
  case $1 in
    /*) map=$1 ;;
    *) map=$PWD/$1 ;;
  esac
  shift
fi

sh "$root/packages.sh"
cd "$root"
# As tests/run.sh does, so that one build serves both.
preset=release
[ "${CI:-}" != true ] || preset=ci
log=build/$preset.log
mkdir -p build
if ! { cmake --preset "$preset" && cmake --build --preset "$preset"; } >"$log" 2>&1; then
  cat "$log" >&2
  exit 1
fi
PATH=$root/build/$preset:$PATH

show() {
  printf '$ %s\n' "$*"
  "$@"
}

say() {
  printf '\n# %s\n' "$*"
}

out=out/tour
rm -rf "$out"
mkdir -p "$out"

if [ -n "$map" ]; then
  say 'Your map as latlong, 1024x512.'
  show envmap convert "$map" $out/latlong.exr --to latlong --size 512 "$@"
else
  say 'A sun, 8 degrees wide, in an overcast sky.'
  show envmap generate sun $out/latlong.exr --size 512 --direction 2,2,3 --radius 4 --value 100,80,50
fi
show envmap info $out/latlong.exr

say 'The other four projections; the size follows from the degrees per texel.'
for projection in cube sphere paraboloid angular; do
  show envmap convert $out/latlong.exr $out/$projection.exr --to $projection
done

say 'What each of them lost, read back in the texels of the latlong map.'
for projection in cube sphere paraboloid angular; do
  show envmap compare -q $out/$projection.exr $out/latlong.exr --filter bilinear
done

say 'A cube as the tools around it like it: one cross, or six files.'
show envmap convert $out/cube.exr $out/cross.hdr --layout cross
show envmap convert $out/cube.exr "$out/face_{face}.exr" --depth half

say 'Colours that tell the direction (RGB = (direction + 1) / 2): nothing may be mirrored or turned.'
set --
for projection in latlong cube sphere paraboloid angular; do
  show envmap generate directions $out/directions-$projection.exr --to $projection --size 128
  set -- "$@" $out/directions-$projection.exr
done

say 'All of it as one picture.'
show envmap preview $out/latlong.exr $out/cube.exr $out/sphere.exr $out/paraboloid.exr $out/angular.exr "$@" \
  $out/tour.png --columns 5 --height 192
echo "$root/$out/tour.png"

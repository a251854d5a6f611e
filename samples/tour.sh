#!/bin/sh
# A tour of envmap: draws or takes an HDR environment, converts it to every projection, prefilters it, measures what a
# conversion is off and shows it all as one picture, whose path is the last line printed.
#
#   sh samples/tour.sh                          with the panorama of a scene of our own
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
# As tests/run.sh does, so that one build serves both; of the program alone.
preset=release
[ "${CI:-}" != true ] || preset=ci
log=build/$preset.log
mkdir -p build
# Says how far the build is: in place on a terminal, every tenth of it elsewhere. All of it goes to the log.
follow() {
  said=0
  while IFS= read -r line; do
    printf '%s\n' "$line" >&3
    case $line in
      \[[0-9]*/[0-9]*\]*) ;;
      *) continue ;;
    esac
    step=${line%%]*} step=${step#[}
    tenth=$((10 * ${step%/*} / ${step#*/}))
    if [ -t 1 ]; then
      printf '\rBuilding the program: %s ' "$step"
    elif [ "$tenth" -gt "$said" ]; then
      echo "Building the program: ${tenth}0%"
    fi
    said=$tenth
  done 3>"$log"
  [ ! -t 1 ] || echo
}
{ cmake --preset "$preset" && cmake --build --preset "$preset" --target envmap_program || echo 'tour.sh: not built'; } 2>&1 | follow
if [ "$(tail -n 1 "$log")" = 'tour.sh: not built' ]; then
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
  say 'A scene of our own, the cellar, drawn as a panorama without a display.'
  show python3 samples/scenes/make.py $out/scenes
  show envmap render $out/scenes/cellar.glb $out/latlong.exr --to latlong --size 512 --at 0,1.5,0.5 --ambient 0.05
fi
show envmap info $out/latlong.exr

say 'The other projections; the size follows from the degrees per texel.'
for projection in cube sphere paraboloid angular octahedral equal-area; do
  show envmap convert $out/latlong.exr $out/$projection.exr --to $projection
done

say 'What lights rough things: a cube of GGX maps, right to a thousandth in every texel, as an engine loads it.'
show envmap prefilter $out/latlong.exr $out/ggx.ktx2 --lobe ggx --levels 6 --size 128 -v

say 'Colours that tell the direction, RGB = (direction + 1) / 2: nothing may be mirrored or turned.'
set --
show envmap generate directions $out/directions-latlong.exr --to latlong --size 512
for projection in latlong cube sphere paraboloid angular octahedral equal-area; do
  [ $projection = latlong ] ||
    show envmap convert $out/directions-latlong.exr $out/directions-$projection.exr --to $projection
  set -- "$@" $out/directions-$projection.exr
done

say 'How far the converted cube is from one that is worked out from the formula: rms is the error of the whole.'
show envmap generate directions $out/formula.exr --to cube --size 256
show envmap compare $out/directions-cube.exr $out/formula.exr

say 'A cube as the tools around it like it: one cross, or six files.'
show envmap convert $out/cube.exr $out/cross.hdr --layout cross
show envmap convert $out/cube.exr "$out/face_{face}.exr" --depth half

say 'What the map lights and how bright it is, and a page to look around in it, for any browser.'
show envmap preview $out/latlong.exr $out/sheet.png --sheet
show envmap preview $out/latlong.exr --html $out/look-around.html

say 'All of it as one picture.'
show envmap preview $out/latlong.exr $out/cube.exr $out/sphere.exr $out/paraboloid.exr $out/angular.exr \
  $out/octahedral.exr $out/equal-area.exr "$@" $out/tour.png --columns 7 --height 192
echo "$root/$out/tour.png"

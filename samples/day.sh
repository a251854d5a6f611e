#!/bin/sh
# A day's jobs with one probe, in twenty commands: inspect, fix, turn, combine, convert, prefilter, bake, check, batch.
# 'envmap' must be on the PATH.
#
#   sh samples/day.sh                       with a generated sky, into the folder 'day'
#   sh samples/day.sh PROBE [FOLDER]        with a panorama of yours
set -eu

folder=${2:-day}
mkdir -p "$folder/probes"
if [ $# -gt 0 ]; then
  envmap convert "$1" "$folder/probe.exr" --to latlong --size 256 --depth float
else
  envmap generate sun "$folder/probe.exr" --size 128 --direction 1,1,-1 --radius 3 --value 300,280,250
fi
cd "$folder"

show() {
  printf '\n$'
  printf ' %s' "$@"
  printf '\n'
  "$@"
}

# Lighting artist: what is in the probe, and how does it look?
show envmap info probe.exr
show envmap preview probe.exr sheet.png --sheet
show envmap preview probe.exr --html look-around.html

# The light: a neutral white, 200 lux on the floor, the sun in front, a second light.
show envmap convert probe.exr graded.exr --white 0,0,1 --scale-to lux=200
show envmap convert graded.exr front.exr --rotate sun:+z
show envmap generate sun lamp.exr --size 64 --direction 0,1,0 --radius 10 --value 100 --zenith 0 --horizon 0 --ground 0
show envmap convert front.exr lit.exr --add lamp.exr

# Another tool: a left-handed world, faces of a cube, a panorama with +X at its centre, a picture for the web.
show envmap convert lit.exr left-handed.exr --mirror x
show envmap convert lit.exr 'face_{face}.exr' --to cube --size 128
show envmap convert lit.exr plus-x.exr --to latlong --forward +x
show envmap convert lit.exr panel.png --to cube --layout cross --size 128 --exposure -5 --display neutral

# Engine programmer: what shaders need.
show envmap mipmap lit.exr lit.ktx2 --depth half --clamp --zstd
show envmap prefilter lit.exr ggx.ktx2 --lobe ggx --size 64 --levels 5 --depth float --brdf-table brdf.exr
show envmap sh lit.exr --irradiance --window auto
show envmap bake lit.exr three --for three --clamp

# Build engineer: limits that fail the build, and many maps at once.
show envmap convert lit.exr small.exr --to cube --size 32 --max-error 1e-2
show envmap compare small.exr lit.exr --fit-exposure
show envmap compare probe.exr probe.exr --golden
cp probe.exr probes/a.exr
cp lit.exr probes/b.exr
printf '%s\n' 'mipmap probes/*.exr {stem}.ktx2' 'prefilter probes/*.exr {stem}-diffuse.exr --size 16' >maps.txt
show envmap batch maps.txt
show envmap info probes/a.ktx2 probes/b-diffuse.exr
echo "All is in $PWD; look at sheet.png and panel.png."

#!/bin/sh
# Makes samples/sample.hdr, the map of the examples: a paved square under a clear sky, drawn by rays.
#
#   sh samples/sample.sh [ENVMAP [OUTPUT]]      (default: build/release/envmap, samples/sample.hdr)
#
# 512x256, so that it stays below 300 kB. Five stops down, the sun fits into half floats.
set -eu
cd "$(dirname "$0")/.."
envmap=${1:-build/release/envmap}
output=${2:-samples/sample.hdr}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

python3 samples/scenes/make.py "$work"
"$envmap" generate atmosphere "$work/sky.exr" --size 256 --elevation 40 --azimuth=-40 --ground 0.12,0.16,0.07 -q
"$envmap" render "$work/terrace.glb" "$work/terrace.exr" --to latlong --size 256 --at 0,1.6,0 --environment "$work/sky.exr" \
  --method raycast --samples 16 --occlusion 128 -q
"$envmap" convert "$work/terrace.exr" "$output" --exposure=-5 -q
ls -l "$output"

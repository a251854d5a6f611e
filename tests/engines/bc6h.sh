#!/bin/sh
# BC6H of latlong probes by envmap and by Basis Universal (UASTC HDR, transcoded): processor time, and the error against the image.
#
#   [ENVMAP=PROGRAM] [ENGINES_FOLDER=FOLDER] [QUALITIES="0 2"] sh tests/engines/bc6h.sh PROBE...
#
# The table of envmap-files(7). By hand: it downloads as run.sh does. Quality 4 of the other takes minutes a probe.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
envmap=$(realpath "${ENVMAP:-$here/../../build/ci/envmap}")
images=$(mktemp -d)
for probe in "$@"; do # Half, to which both are held; a size of whole blocks.
  "$envmap" convert "$probe" "$images/$(basename "${probe%.*}").exr" --to latlong --depth half --clamp -q
done
. "$here/install.sh"

# measured IMAGE DDS: the lines of compare that count.
measured() {
  "$envmap" compare "$2" "$1" | awk '/^rms/ {rms = $2} /^max/ {max = $2} END {print "rms", rms, "max", max}'
}
for image in "$images"/*.exr; do
  name=$(basename "$image" .exr)
  seconds=$("$envmap" convert "$image" envmap.dds --depth bc6h --threads 1 --json -q | sed -nE 's/.*"seconds": *([0-9.e+-]+).*/\1/p' | head -n 1)
  echo "$name envmap $seconds s $(measured "$image" envmap.dds)"
  for quality in ${QUALITIES:-0 2}; do
    seconds=$(node bc6h.mjs "$image" basis.dds $quality | tail -n 1)
    echo "$name basis $quality $seconds s $(measured "$image" basis.dds)"
  done
done
rm -rf "$images"

#!/bin/sh
# Builds the fuzz targets with clang and libFuzzer, makes seeds with the program itself, and runs each target.
#
#   [ENVMAP=PROGRAM] sh tests/fuzz/run.sh [SECONDS [TARGET...]]
#
# SECONDS for each target (default: 60, of all targets). FUZZ_OPTIONS go to libFuzzer. Targets (targets.h):
#   hdr exr ktx2 ktx dds env glb png jpg tif pfm   a reader of images each, in memory     bc6h      blocks, decoded and encoded again
#   obj mtl gltf                   a reader of scenes each, in memory     words     what metadata and shapes say
#   icc gain                       profiles and gain maps, their metadata alone
#   read scene                     files and pipes of any format          colours   OpenColorIO configs and names of spaces
#   command                        commands of the program, whole         part, manifest   what merge and batch read
# They begin with the corpus of the repository, tests/fuzz/corpus, and with seeds made by ENVMAP (built where it is not
# given); what is new goes to build/fuzz/corpus, which grows from run to run. What a target finds, it leaves in
# build/fuzz/found; to look into a find: build/fuzz/fuzz_read FILE. A crash inside malloc can block libFuzzer's report; then
# the input is in build/fuzz/fuzz_read.tga.
# A find goes into the repository's corpus, smaller if it can be (-minimize_crash=1), which every test run reads (corpus_test.cpp).
# Needs clang and libclang-rt-dev beside what packages.sh lists.
set -eu

seconds=${1:-60}
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- hdr exr ktx2 ktx dds env glb png jpg tif pfm bc6h obj mtl gltf words icc gain colours part manifest read scene command
cd "$(dirname "$0")/../.."
kept=$PWD/tests/fuzz/corpus
cmake --preset fuzz
envmap=$(realpath "${ENVMAP:-build/fuzz/envmap}")
targets=
[ -n "${ENVMAP:-}" ] || targets=envmap_program
for target; do targets="$targets fuzz_$target"; done
# shellcheck disable=SC2086  # Words.
cmake --build --preset fuzz --target $targets
cd build/fuzz
for target; do mkdir -p "corpus/$target"; done
mkdir -p corpus/read corpus/scene found

# Small maps in the formats that are written, and of kinds that are only read. The last byte chooses options (read.cpp):
# 0 for a file, 1 for standard input.
seed() {
  [ -s corpus/map ] || return 0
  for choice in 0 1; do
    { cat corpus/map; printf "\\00$choice"; } >"corpus/read/$1-$choice"
  done
}
for format in exr hdr pfm tif png ppm jpg tga bmp webp; do
  for projection in latlong cube sphere; do
    "$envmap" generate directions corpus/map.$format --to $projection --size 6
    mv corpus/map.$format corpus/map
    seed $projection-$format
  done
done
for projection in latlong cube; do
  "$envmap" generate directions corpus/in.exr --to $projection --size 5
  for kind in 'ktx2 --depth half' 'ktx2 --depth float --zstd' 'ktx2 --depth rgb9e5' 'ktx --depth half' 'ktx --depth rgb9e5' 'dds --depth half' 'dds --depth rgb9e5' 'exr --depth half'; do
    "$envmap" mipmap corpus/in.exr corpus/map.${kind%% *} ${kind#* }
    mv corpus/map.${kind%% *} corpus/map
    seed "$projection-levels-$(echo "$kind" | tr ' ' -)"
  done
done
"$envmap" generate directions corpus/in.exr --to latlong --size 6
for kind in 'exr --tile 4 4' 'exr -d half --compression dwaa' 'exr -d half --compression b44' 'exr --compression piz' \
  'exr --compression rle' 'exr --compression pxr24' 'tif --tile 16 16' 'tif -d uint8 --compression lzw' \
  'tif -d uint16 --compression packbits' 'tif -d half' 'tif --planarconfig separate' 'png -d uint16'; do
  format=${kind%% *}
  rm -f corpus/map.$format
  oiiotool corpus/in.exr ${kind#"$format"} -o corpus/map.$format >/dev/null 2>&1 || continue
  mv corpus/map.$format corpus/map
  seed "$(echo "$kind" | tr ' ' -)"
done

# A format's own target takes the seeds of its kind.
for format in hdr exr ktx2 ktx dds jpg tif; do
  [ ! -d corpus/$format ] || cp corpus/read/*"$format"-*0 corpus/$format
done

# Warnings of libraries are not shown. Address sanitizer is left out: OpenImageIO takes 16 MB for each read, which makes
# it 100 times slower. What has grown goes through it afterwards: ENVMAP_CORPUS=build/fuzz/corpus build/asan/corpus_tests
status=0
for target; do
  dictionary=
  folders="corpus/$target $kept/$target"
  case $target in
    words) dictionary=-dict=../../tests/fuzz/words.dict ;;
    read | command) folders="$folders $kept/hdr $kept/exr $kept/ktx2 $kept/ktx $kept/dds $kept/env $kept/glb" ;;
    scene) folders="$folders $kept/obj $kept/mtl $kept/gltf" ;;
  esac
  # shellcheck disable=SC2086  # Words.
  timeout -s KILL $((seconds + 60)) "./fuzz_$target" -close_fd_mask=3 -timeout=20 -print_final_stats=1 -artifact_prefix=found/ \
    -max_len=4096 -len_control=0 -max_total_time="$seconds" $dictionary ${FUZZ_OPTIONS:-} $folders || status=1
done
exit $status

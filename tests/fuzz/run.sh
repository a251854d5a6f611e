#!/bin/sh
# Builds the fuzz targets with clang and libFuzzer, makes seeds with the program itself, and runs each target.
#
#   sh tests/fuzz/run.sh [SECONDS [OPTIONS...]]
#
# SECONDS for the readers (default: 60), a tenth of that for the words; OPTIONS go to libFuzzer. The corpus stays in
# build/fuzz/corpus and grows from run to run. What a target finds, it leaves in build/fuzz/found; to look into a find:
# build/fuzz/fuzz_read FILE. A crash inside malloc can block libFuzzer's report; then the input is in
# build/fuzz/fuzz_read.tga. Needs clang and libclang-rt-dev
# beside what packages.sh lists.
set -eu

seconds=${1:-60}
[ $# -eq 0 ] || shift
cd "$(dirname "$0")/../.."
cmake --preset fuzz
cmake --build --preset fuzz
cd build/fuzz
mkdir -p corpus/read corpus/words found

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
    ./envmap generate directions corpus/map.$format --to $projection --size 6
    mv corpus/map.$format corpus/map
    seed $projection-$format
  done
done
for projection in latlong cube; do
  ./envmap generate directions corpus/in.exr --to $projection --size 5
  for kind in 'ktx2 --depth half' 'ktx2 --depth float --zstd' 'ktx2 --depth rgb9e5' 'dds --depth half' 'dds --depth rgb9e5' 'exr --depth half'; do
    ./envmap mipmap corpus/in.exr corpus/map.${kind%% *} ${kind#* }
    mv corpus/map.${kind%% *} corpus/map
    seed "$projection-levels-$(echo "$kind" | tr ' ' -)"
  done
done
./envmap generate directions corpus/in.exr --to latlong --size 6
for kind in 'exr --tile 4 4' 'exr -d half --compression dwaa' 'exr -d half --compression b44' 'exr --compression piz' \
  'exr --compression rle' 'exr --compression pxr24' 'tif --tile 16 16' 'tif -d uint8 --compression lzw' \
  'tif -d uint16 --compression packbits' 'tif -d half' 'tif --planarconfig separate' 'png -d uint16'; do
  format=${kind%% *}
  rm -f corpus/map.$format
  oiiotool corpus/in.exr ${kind#"$format"} -o corpus/map.$format >/dev/null 2>&1 || continue
  mv corpus/map.$format corpus/map
  seed "$(echo "$kind" | tr ' ' -)"
done

# Warnings of libraries are not shown. Address sanitizer is left out: OpenImageIO takes 16 MB for each read, which makes
# it 100 times slower; the tests run under it (preset asan).
common="-close_fd_mask=3 -timeout=20 -print_final_stats=1 -artifact_prefix=found/"
./fuzz_words $common -dict=../../tests/fuzz/words.dict -max_total_time=$(((seconds + 9) / 10)) "$@" \
  corpus/words
timeout -s KILL $((seconds + 60)) ./fuzz_read $common -max_len=4096 -len_control=0 \
  -max_total_time="$seconds" "$@" corpus/read

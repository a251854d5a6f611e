#!/bin/sh
# Builds the fuzz targets with clang and libFuzzer, makes seeds with the program itself, and runs each target.
#
#   sh tests/fuzz/run.sh [SECONDS [OPTIONS...]]
#
# SECONDS for the readers of maps and for those of scenes (default: 60), a tenth of that for the words; OPTIONS go to
# libFuzzer. The corpus stays in build/fuzz/corpus and grows from run to run. What a target finds, it leaves in
# build/fuzz/found; to look into a find: build/fuzz/fuzz_read FILE. A crash inside malloc can block libFuzzer's report; then
# the input is in build/fuzz/fuzz_read.tga. Needs clang and libclang-rt-dev beside what packages.sh lists.
set -eu

seconds=${1:-60}
[ $# -eq 0 ] || shift
cd "$(dirname "$0")/../.."
cmake --preset fuzz
cmake --build --preset fuzz
cd build/fuzz
mkdir -p corpus/read corpus/scene corpus/words found

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

# Radiance pictures that only others write: old run lengths, columns first, exposures, XYZE.
printf '#?RADIANCE\nEXPOSURE=2\nCOLORCORR=1 1 2\nFORMAT=32-bit_rle_rgbe\n\n+X 4 -Y 2\n\100\100\040\200\001\001\001\001\100\100\040\200\001\001\001\001\100\100\040\200\001\001\001\001\100\100\040\200\001\001\001\001' >corpus/map
seed old-hdr
printf '#?RGBE\nFORMAT=32-bit_rle_xyze\nPRIMARIES=0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329\n\n-Y 1 +X 2\n\100\100\040\200\100\101\040\200' >corpus/map
seed xyz-hdr

# Scenes small enough to be changed all through: a triangle in each of the three formats, and materials.
printf 'mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl m\nf 1/1/1 2/1/1 3/1/1\n' >corpus/scene/triangle.obj
printf 'v 0 0 0\nv 4 0 0\nv 4 4 0\nv 3 1 0\nvt 0 0\nvt 1 0\ns 1\no a\nusemtl b\nf 1/1 -3/2 \\\n3/1 4\ng c\nl 1 2\n' >corpus/scene/polygon.obj
printf 'newmtl a\nKd 0.5 1 1\nKs 0\nNs 3\nillum 2\nPr 0.5\nKe 1\nmap_Kd -clamp on -s 1 2 3 -mm 0 1 x y.png\nd -halo 0.5\n' >corpus/scene/a.mtl
cat >corpus/scene/triangle.gltf <<'JSON'
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
 "nodes": [{"mesh": 0, "translation": [0, 1, 0], "children": [1]}, {"camera": 0, "rotation": [0, 0, 0, 1]}],
 "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
 "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1], "roughnessFactor": 0.5}, "emissiveFactor": [1, 1, 1]}],
 "animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
                 "samplers": [{"input": 1, "output": 0, "interpolation": "LINEAR"}]}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
               {"bufferView": 1, "componentType": 5126, "count": 3, "type": "SCALAR"}],
 "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 12}],
 "buffers": [{"byteLength": 48, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAABA"}]}
JSON
python3 - corpus/scene/triangle.gltf corpus/scene/triangle.glb <<'PYTHON'
import base64, json, struct, sys
document = json.load(open(sys.argv[1]))
data = base64.b64decode(document["buffers"][0].pop("uri").split(",")[1])
text = json.dumps(document).encode()
text += b" " * (-len(text) % 4)
open(sys.argv[2], "wb").write(struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(data), len(text), 0x4E4F534A) + text
                              + struct.pack("<II", len(data), 0x004E4942) + data)
PYTHON

# Warnings of libraries are not shown. Address sanitizer is left out: OpenImageIO takes 16 MB for each read, which makes
# it 100 times slower; the tests run under it (preset asan).
common="-close_fd_mask=3 -timeout=20 -print_final_stats=1 -artifact_prefix=found/"
./fuzz_words $common -dict=../../tests/fuzz/words.dict -max_total_time=$(((seconds + 9) / 10)) "$@" \
  corpus/words
timeout -s KILL $((seconds + 60)) ./fuzz_read $common -max_len=4096 -len_control=0 \
  -max_total_time="$seconds" "$@" corpus/read
timeout -s KILL $((seconds + 60)) ./fuzz_scene $common -max_len=4096 -len_control=0 \
  -max_total_time="$seconds" "$@" corpus/scene

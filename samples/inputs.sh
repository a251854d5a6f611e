#!/bin/sh
# Makes the files that the examples of 'envmap COMMAND --help' and of the man pages read, out of sample.hdr.
#
#   sh inputs.sh FOLDER       'envmap' and python3 must be on the PATH
set -eu
samples=$(cd "$(dirname "$0")" && pwd)
mkdir -p "${1:?the folder to write}"
cd "$1"
mkdir -p probes out frames turn man
cp "$samples/sample.hdr" .
python3 "$samples/scenes/make.py" .
cp balls.glb model.glb

envmap convert -q sample.hdr latlong.exr
envmap convert -q sample.hdr cube.exr --to cube
envmap convert -q sample.hdr cross.hdr --to cube --layout cross
envmap convert -q sample.hdr sphere.exr --to sphere
envmap mipmap -q cube.exr chain.ktx2 --depth half
for name in a b; do
  envmap convert -q sample.hdr probes/$name.hdr --size 32
done

# Photos: of a mirror ball, cropped and not, and by a fisheye lens.
envmap convert -q sample.hdr ball.hdr --to sphere --size 256
envmap convert -q sample.hdr fisheye.exr --to fisheye --fov 180 --size 256
envmap view -q chrome-ball.glb photo.exr --environment sample.hdr --method raycast --width 640 --height 480

# Maps to compare, and maps to add.
envmap prefilter -q sample.hdr golden.exr --size 32
envmap prefilter -q sample.hdr new.exr --size 32
envmap convert -q sample.hdr mine.exr --exposure 1
envmap convert -q sample.hdr theirs.exr
envmap generate -q atmosphere sky.exr --size 128 --no-sun
envmap generate -q sun sunny.hdr --size 128 --radius 1 --value 40
envmap generate -q sun sun.exr --size 128 --radius 5 --value 1000 --zenith 0 --horizon 0 --ground 0

# A lobe by cosines and values.
printf '1 2.5\n0.9 1\n0.5 0.2\n0 0\n' > satin.txt

# Lists for batch.
echo 'mipmap probes/*.hdr out/{name}.ktx2 --depth half' > maps.txt
echo '[["convert", "sample.hdr", "small.exr", "--size", 64], "mipmap cube.exr cube.ktx2 --depth half"]' > maps.json

#!/bin/sh
# Builds the container of packaging/Dockerfile and works in it: with docker or podman, where one of them runs, else by the same
# steps in a bare Debian of mmdebstrap.
#
#   sh packaging/container_test.sh DEB [DEBIAN]     (default: 13, for which the package must have been made)
set -eu
cd "$(dirname "$0")/.."
[ $# -ge 1 ] || { echo 'container_test: name a .deb' >&2; exit 2; }
deb=$(readlink -f "$1")
debian=${2:-13}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$deb" "$work"

# What is done in it: a map is converted and drawn, with the sample that came along.
try='envmap convert "$(envmap manual --samples)/sample.hdr" cube.png --to cube --size 8 --clamp -q && envmap info cube.png >/dev/null &&
printf "v -1 0 -1\nv 1 0 -1\nv 0 0 1\nf 3 2 1\n" >floor.obj && envmap render floor.obj drawn.exr --at 0,1,0 --size 8 --ambient 1 --context osmesa 2>said &&
test -s drawn.exr && ! grep black said'

for tool in docker podman; do
  if command -v $tool >/dev/null && $tool info >/dev/null 2>&1; then
    $tool build -q -f packaging/Dockerfile --build-arg "DEBIAN=$debian" -t envmap-test "$work"
    $tool run --rm --entrypoint sh envmap-test -c "$try"
    $tool run --rm envmap-test --version
    $tool rmi envmap-test >/dev/null
    echo "container_test: built and used with $tool"
    exit
  fi
done

# The line of the Dockerfile, word for word.
step=$(sed -n 's/^RUN //p' packaging/Dockerfile)
folder=$(sed -n 's/^WORKDIR //p' packaging/Dockerfile)
mmdebstrap --quiet --variant=apt \
  --customize-hook="copy-in $work/$(basename "$deb") /tmp" \
  --customize-hook="chroot \"\$1\" sh -c '$step' >/dev/null" \
  --customize-hook="mkdir -p \"\$1$folder\"" \
  --customize-hook="chroot \"\$1\" env -i PATH=/usr/bin:/bin sh -c 'cd $folder && envmap --version && $try'" \
  "$(case $debian in 11) echo bullseye ;; 12) echo bookworm ;; 13) echo trixie ;; *) echo "$debian" ;; esac)" /dev/null
echo 'container_test: the steps of packaging/Dockerfile were run and the program used, without a container tool'

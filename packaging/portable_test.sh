#!/bin/sh
# Tries the portable archive in systems where nothing is installed: Debian 11, 12, 13 and sid without even apt, and a folder
# with busybox alone, which has no libc. Each runs the tour's commands, draws a scene and looks at files; the bytes must be
# those that REFERENCE (default: build/release/envmap) writes here. The archive of formats is tried, too, if it lies beside
# ARCHIVE. The commands of README.md run here, on the archive's own samples.
#
#   sh packaging/portable_test.sh ARCHIVE_OR_FOLDER [REFERENCE [SYSTEM...]]    (default: bullseye bookworm trixie sid busybox)
#
# Needs mmdebstrap, busybox-static, python3, root or user namespaces, and a mirror. Systems are kept in build/roots.
set -eu
cd "$(dirname "$0")/.."
[ $# -ge 1 ] || { sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0" >&2; exit 2; }
archive=$(readlink -f "$1")
reference=$(readlink -f "${2:-build/release/envmap}")
[ $# -lt 2 ] || shift
shift
[ $# -gt 0 ] || set -- bullseye bookworm trixie sid busybox
mkdir -p build/roots
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The folder, with a blank in its name.
mkdir "$work/a folder"
if [ -d "$archive" ]; then
  cp -a "$archive" "$work/a folder"
else
  tar -C "$work/a folder" -xf "$archive"
fi
folder=$(cd "$work/a folder" && echo envmap-*)
formats=${archive%.tar.xz}-formats.tar.xz
python3 samples/scenes/make.py "$work/scenes"

# What runs there and here. $1 is the folder of the sample, $2 that of the scenes.
cat >"$work/jobs.sh" <<'JOBS'
set -eu
cp "$1/sample.hdr" latlong.hdr
envmap info latlong.hdr >info.txt
for projection in cube sphere paraboloid angular octahedral equal-area; do
  envmap convert latlong.hdr $projection.exr --to $projection --size 96
done
envmap prefilter latlong.hdr ggx.ktx2 --lobe ggx --levels 4 --size 32 -q
envmap generate directions directions.exr --to latlong --size 64
envmap convert cube.exr 'face_{face}.png' --size 32 --clamp -q
envmap mipmap latlong.hdr levels.dds --depth half
envmap preview latlong.hdr sheet.png --sheet
envmap preview latlong.hdr --html look.html -q
envmap bake latlong.hdr three --for three -q
envmap sh latlong.hdr >sh.txt
envmap render "$2/cellar.glb" drawn.exr --to latlong --size 64 --at 0,1.5,0.5 --ambient 0.05 --method exact --context osmesa -q
envmap view "$2/ball.glb" view.png --environment latlong.hdr --width 64 --height 48 --context osmesa -q
envmap render "$2/ball.glb" rays.exr --method raycast --size 32 --ambient 1 -q
JOBS

# What is of the archive of formats.
cat >"$work/formats.sh" <<'FORMATS'
set -eu
for format in tif jpg webp; do
  envmap convert latlong.hdr "map.$format" --size 64 --clamp -q
  envmap info "map.$format" >"$format.txt"
done
FORMATS

# What is of the folder alone: links, PATH, other people's libraries, jobs of jobs, a format that is apart.
cat >"$work/place.sh" <<'PLACE'
set -eu
fails() {
  echo "portable_test: $*" >&2
  exit 1
}
link=/usr/local/bin/envmap
mkdir -p /usr/local/bin
rm -f $link
ln -s "/opt/a folder/$1/bin/envmap" /linked
ln -s ../../../linked $link
[ "$(envmap manual --samples)" = "/opt/a folder/$1/share/envmap/samples" ] || fails 'a link hides the samples'
ln -s "/opt/a folder/$1" '/opt/a;b:c'
'/opt/a;b:c/bin/envmap' --version | grep -q '^draws with OSMesa, llvmpipe' || fails 'does not draw'
mkdir -p /wrong
: >/wrong/libstdc++.so.6
LD_LIBRARY_PATH=/wrong envmap --version >/dev/null || fails 'LD_LIBRARY_PATH counts'
for program in "/opt/a folder/$1/bin"/*; do
  "$program" --help >/dev/null || fails "$program does not start"
done
for path in man/man1/envmap-convert.1 bash-completion/completions/envmap doc/envmap/LICENSE doc/envmap/licenses/libtbb12.txt; do
  test -s "/opt/a folder/$1/share/$path" || fails "lacks $path"
done
cd /tmp
printf 'convert "%s/sample.hdr" a.exr --to cube --size 8\n' "$(envmap manual --samples)" >maps.txt
envmap batch maps.txt --make Makefile
grep -q "a folder/$1/bin/envmap" Makefile || fails 'jobs do not start the program'
printf 'RIFF\044\0\0\0WEBPVP8 \030\0\0\0%024d' 0 >x.webp
! envmap info x.webp 2>said || fails 'reads WebP'
grep -q "archive '-formats'" said || fails "says: $(cat said)"
PLACE

# run_there ROOT SCRIPT ARGUMENTS...: with /proc and /dev, and nothing of the environment.
run_there() {
  root=$1
  shift
  unshare --mount sh -c '
    mount -t proc proc "$0/proc" && mount --bind /dev "$0/dev"
    exec chroot "$0" /usr/bin/env -i PATH=/usr/local/bin:/usr/bin:/bin HOME=/tmp sh "$@"' "$root" "$@"
}

mkdir "$work/here"
mkdir "$work/program"
ln -s "$reference" "$work/program/envmap"
(cd "$work/here" && PATH=$work/program:$PATH sh "$work/jobs.sh" "$OLDPWD/samples" "$work/scenes")
[ ! -f "$formats" ] || (cd "$work/here" && PATH=$work/program:$PATH sh "$work/formats.sh")

passed=0 failed=0
if python3 tests/recipes.py . "$work/a folder/$folder/bin/envmap" README; then
  passed=1
else
  failed=1
fi
for system; do
  root=$work/$system
  mkdir "$root"
  if [ "$system" = busybox ]; then
    mkdir -p "$root/bin" "$root/usr/bin"
    cp "$(command -v busybox)" "$root/bin"
    for name in $(busybox --list); do
      [ "$name" = busybox ] || ln -s /bin/busybox "$root/bin/$name"
    done
    ln -s /bin/busybox "$root/usr/bin/env"
  else
    if [ ! -f "build/roots/$system.tar" ]; then # Whole, or not kept.
      mmdebstrap --quiet --variant=essential --aptopt='Acquire::Check-Valid-Until "false"' "$system" "$work/$system.tar"
      mv "$work/$system.tar" build/roots
    fi
    tar -C "$root" -xf "build/roots/$system.tar" --exclude='./dev/*'
  fi
  mkdir -p "$root/opt" "$root/tmp/jobs" "$root/proc" "$root/dev"
  cp -al "$work/a folder" "$root/opt" # No copies of 250 MB.
  cp -a "$work/scenes" "$root/opt"
  cp "$work/jobs.sh" "$work/place.sh" "$work/formats.sh" "$root"
  if run_there "$root" /place.sh "$folder" &&
    run_there "$root" -c 'cd /tmp/jobs && sh /jobs.sh "$(envmap manual --samples)" /opt/scenes' &&
    { [ ! -f "$formats" ] || { tar -C "$root/opt/a folder" -xf "$formats" && run_there "$root" -c 'cd /tmp/jobs && sh /formats.sh'; }; } &&
    diff -r "$work/here" "$root/tmp/jobs"; then
    passed=$((passed + 1))
    echo "$system: $(find "$work/here" -type f | wc -l) files have the same bytes"
  else
    failed=$((failed + 1))
    echo "$system: failed"
  fi
  rm -rf "$root"
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]

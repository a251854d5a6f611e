#!/bin/sh
# Builds envmap in a fresh Debian (bookworm, trixie, testing or sid), runs every test and the tour there, makes the packages,
# installs and uses them, and prints the log. The last line is 'N passed, N failed'; the tour and the packages count as one
# each. build/systems/SUITE gets the log, the tour's picture, the packages and what 'envmap --version' says. Needs mmdebstrap, root or user namespaces, a mirror, and 10 GB in TMPDIR.
#
#   sh packaging/try_system.sh SUITE [MIRROR]
set -eu
cd "$(dirname "$0")/.."
[ $# -ge 1 ] || { echo 'try_system: name a suite, such as trixie' >&2; exit 2; }
suite=$1
results=$PWD/build/systems/$suite
rm -rf "$results"
mkdir -p "$results"

# What git would keep, with changes that are not committed.
git ls-files -z --cached --others --exclude-standard |
  tar --null --files-from=- --ignore-failed-read -cf "$results/source.tar"

cat >"$results/inside.sh" <<'INSIDE'
mkdir "/$1"
cd /envmap
export CI=true LC_ALL=C.UTF-8
sh tests/run.sh >"/$1/tests.log" 2>&1
cat "/$1/tests.log"
read -r passed failed <<SUMS
$(tail -n 1 "/$1/tests.log" | sed -nE 's/^([0-9]+) passed, ([0-9]+) failed$/\1 \2/p')
SUMS
sh samples/tour.sh && passed=$((${passed:-0} + 1)) || failed=$((${failed:-0} + 1))
cp out/tour/tour.png "/$1"
build/ci/envmap --version | tee "/$1/version"
# The packages come out of the same build.
export DEBFULLNAME=envmap DEBEMAIL=envmap@localhost
pack() {
  sh packages.sh deb && cmake --preset ci -DCMAKE_INSTALL_PREFIX=/usr && cmake --build --preset ci &&
    cpack --config build/ci/CPackConfig.cmake -B "/$1" &&
    apt-get -qq -y install "/$1"/*.deb && cd / && envmap --version && envmap generate sky sky.exr --size 16 &&
    envmap convert sky.exr sky.png --to cube --clamp && python3 -c 'import envmap; print(envmap.read("/sky.exr").projection)'
}
pack "$1" && passed=$((${passed:-0} + 1)) || failed=$((${failed:-0} + 1))
echo "${passed:-0} passed, ${failed:-1} failed"
INSIDE

# Old lists of sid are as good as new ones.
mmdebstrap --quiet --variant=apt --aptopt='Acquire::Check-Valid-Until "false"' \
  --customize-hook='mkdir "$1/envmap"' \
  --customize-hook="tar-in '$results/source.tar' /envmap" \
  --customize-hook="copy-in '$results/inside.sh' /" \
  --customize-hook='chroot "$1" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root sh /inside.sh '"$suite" \
  --customize-hook="copy-out /$suite '$PWD/build/systems'" \
  "$suite" /dev/null ${2:-} 2>&1 | tee "$results/log"
rm "$results/source.tar" "$results/inside.sh"
tail -n 1 "$results/log" | grep -q ' passed, 0 failed$'

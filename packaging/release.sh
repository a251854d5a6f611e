#!/bin/sh
# Makes a release of the commit that is checked out, in fresh systems, and prints its folder:
#
#   sh packaging/release.sh [OUTPUT [SUITE...]]     (default: out/release, bookworm trixie)
#
#   envmap-VERSION-linux-x86_64.tar.xz and -formats      of the first suite
#   envmap-VERSION-...whl                                of the first suite
#   SUITE/envmap_VERSION-1_amd64.deb and python3-envmap  of each suite
#   *.spdx.json                                          names and versions of what the archives hold
#   SHA256SUMS
#
# A second run on the same day's packages of Debian gives the same bytes: the date in all of them is SOURCE_DATE_EPOCH, or that of the
# commit. Needs git, mmdebstrap, root or user namespaces, a mirror, and 10 GB in TMPDIR.
#
#   sh packaging/release.sh --inside OUTPUT [archives]   what is run in each system: builds, and packs into OUTPUT
set -eu
cd "$(dirname "$0")/.."
: "${SOURCE_DATE_EPOCH:=$(git log -1 --format=%ct)}"
export SOURCE_DATE_EPOCH

if [ "${1:-}" = --inside ]; then
  output=$2
  mkdir -p "$output"
  sh packages.sh deb
  cmake --preset deb
  cmake --build --preset deb
  cpack --preset deb -B "$output/packages"
  mv "$output"/packages/*.deb "$output"
  rm -rf "$output/packages"
  [ "${3:-}" = archives ] || exit 0
  python3 packaging/portable.py build/deb "$output" --formats
  python3 packaging/wheel.py build/deb "$output"
  for archive in "$output"/envmap-*-x86_64.tar.xz "$output"/envmap-*-formats.tar.xz; do
    tar -C "$output" --wildcards --strip-components=4 -xf "$archive" '*.spdx.json'
  done
  exit
fi

output=${1:-out/release}
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- bookworm trixie
[ -z "$(git status --porcelain)" ] || { echo 'release: there are changes that are not committed' >&2; exit 1; }
rm -rf "$output"
mkdir -p "$output"
output=$(cd "$output" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
git clone -q --depth 1 "file://$PWD" "$work/envmap"
tar -C "$work" -cf "$work/source.tar" envmap

archives=archives
for suite; do
  mmdebstrap --quiet --variant=apt --include=git,patchelf,xz-utils,ca-certificates \
    --customize-hook="tar-in '$work/source.tar' /" \
    --customize-hook="chroot \"\$1\" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root SOURCE_DATE_EPOCH=$SOURCE_DATE_EPOCH \
DEBFULLNAME='${DEBFULLNAME:-$(git config user.name)}' DEBEMAIL='${DEBEMAIL:-$(git config user.email)}' \
sh /envmap/packaging/release.sh --inside /$suite $archives" \
    --customize-hook="copy-out /$suite '$output'" \
    "$suite" /dev/null
  [ -z "$archives" ] || find "$output/$suite" -maxdepth 1 -type f ! -name '*.deb' -exec mv {} "$output" ';'
  archives=
done
(cd "$output" && find . -type f ! -name SHA256SUMS -printf '%P\n' | LC_ALL=C sort | xargs sha256sum >SHA256SUMS)
cat "$output/SHA256SUMS"
echo "$output"

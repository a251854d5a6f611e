#!/bin/sh
# Installs the Debian packages that are needed and missing, and nothing else.
# With all of them there it asks dpkg once and ends: no network, no root.
#
#   sh packages.sh           what the build, the tests and the tour need
#   sh packages.sh bench     also the tools that tests/bench times beside envmap
#   sh packages.sh deb       also what packaging/deb_test.sh makes, checks and installs a .deb with
set -eu

# For the tests: libgtest-dev, libbenchmark-dev (CI builds the benchmarks too), libopenexr-dev and openexr (files as
# OpenEXR itself makes them), openimageio-tools, python3 and zstd (tests/ktx2_check.py), mandoc (checks the man pages), zsh and
# fish (their completions), make (reads depfiles), python3-jsonschema (tests/schemas.py); python3-dev, pybind11-dev, numpy and
# pytest: the Python module.
# fonts-dejavu-core writes the names into the pictures of 'envmap preview'.
packages='
  g++ cmake ninja-build pkg-config
  libopenimageio-dev libopencolorio-dev libglm-dev libcli11-dev libtbb-dev libhwy-dev libfmt-dev libpng-dev libzstd-dev
  nlohmann-json3-dev
  libdraco-dev libembree-dev libosmesa6-dev libegl-dev python3-glad
  libgtest-dev libbenchmark-dev libopenexr-dev openexr openimageio-tools python3 python3-dev pybind11-dev python3-numpy python3-pytest python3-jsonschema zstd mandoc fonts-dejavu-core zsh fish
  make'

fail() {
  echo "packages.sh: $1" >&2
  exit 1
}

case ${1:-} in
  '') ;;
  bench) packages="$packages pfstools ffmpeg" ;;
  deb) packages="$packages dpkg-dev file lintian mmdebstrap" ;;
  *) fail "$1: only 'bench', 'deb' or nothing" ;;
esac

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  fail 'not a Debian system: install what this script lists, then build with: cmake --preset release && cmake --build --preset release'
fi

# A removed package that left its settings behind is still known to dpkg, so the status counts, not the name.
there=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' $packages 2>/dev/null) || true
missing=
for package in $packages; do
  printf '%s\n' "$there" | grep -qxF "$package installed" || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

if [ "$(id -u)" -eq 0 ]; then
  as_root=
elif command -v sudo >/dev/null; then
  as_root=sudo
else
  fail "run as root: apt-get install --no-install-recommends$missing"
fi

# A third-party source that fails to refresh need not keep Debian's own packages from being installed.
# Another apt at work (unattended upgrades) is waited for.
echo "packages.sh: installing$missing"
$as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq update ||
  echo 'packages.sh: going on with the package lists at hand' >&2
$as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -y --no-install-recommends -o DPkg::Lock::Timeout=300 \
  install $missing >/dev/null || fail "not installed:$missing"

#!/bin/sh
# Installs the packages that are needed and missing, and nothing else, on Debian 12, 13, testing and sid, and on Ubuntu 24.04
# and newer. With all of them there it ends at once: no network, no root. On other systems it prints what is needed.
#
#   sh packages.sh           what the build, the tests and the tour need
#   sh packages.sh bench     also the tools that tests/bench times beside envmap
#   sh packages.sh deb       also what packaging/deb_test.sh makes, checks and installs a .deb with
set -eu

# For the tests: libgtest-dev, libbenchmark-dev (CI builds the benchmarks too), libopenexr-dev and openexr (files as
# OpenEXR itself makes them), openimageio-tools, python3 and zstd (tests/ktx2_check.py), mandoc (checks the man pages), zsh and
# fish (their completions), make (reads depfiles), python3-jsonschema (tests/schemas.py); python3-dev, pybind11-dev, numpy and
# pytest: the Python module, whose stubs python3-mypy checks.
# fonts-dejavu-core writes the names into the pictures of 'envmap preview'. libegl1 and libgl1-mesa-dri draw on any system, libosmesa6
# where Mesa still has it. djpeg and dwebp read pictures in tests/orientation.py.
# 'a|b': the first of them that the system has.
packages='
  g++ cmake ninja-build pkg-config
  libopenimageio-dev libopencolorio-dev libglm-dev libcli11-dev libtbb-dev libhwy-dev libfmt-dev libpng-dev libjpeg-dev libtiff-dev liblcms2-dev zlib1g-dev libfreetype-dev libzstd-dev
  nlohmann-json3-dev
  libdraco-dev libembree-dev libegl-dev python3-glad libegl1 libgl1-mesa-dri libosmesa6|libgl1-mesa-dri
  libgtest-dev libbenchmark-dev libopenexr-dev openexr openimageio-tools python3 python3-dev pybind11-dev python3-numpy python3-pytest python3-mypy python3-jsonschema zstd mandoc fonts-dejavu-core zsh fish
  libjpeg-turbo-progs webp make'

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
  sed -n '/^| needed/,/^$/p' "$(dirname "$0")/docs/systems.md" >&2
  fail 'no apt-get here: install what the table lists, then build with: cmake --preset release && cmake --build --preset release'
fi

knows() {
  apt-cache show "$1" 2>/dev/null | grep -q '^Version:'
}

# A removed package that left its settings behind is still known to dpkg, so the status counts, not the name.
installed() {
  printf '%s\n' "$there" | grep -qxF "$1 installed"
}

# Prints what is missing.
list_missing() {
  there=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' $(echo "$packages" | tr '|' ' ') 2>/dev/null) || true
  for names in $packages; do
    package=${names%|*}
    installed "$package" || knows "$package" || package=${names#*|}
    installed "$package" || printf ' %s' "$package"
  done
}

missing=$(list_missing)
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
missing=$(list_missing) # Now that apt knows all packages.
$as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -y --no-install-recommends -o DPkg::Lock::Timeout=300 \
  install $missing >/dev/null || fail "not installed:$missing"

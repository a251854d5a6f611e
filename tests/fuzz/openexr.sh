#!/bin/sh
# Fuzzes the reading of EXR files with OpenEXR itself instrumented: address sanitizer, and coverage that guides libFuzzer
# through the library.
#
#   sh tests/fuzz/openexr.sh [SECONDS [TARGET...]]
#
# SECONDS for each target (default: 60). Targets: exr part read, as run.sh has them, over EXR files alone.
# OpenEXR and Imath are built with clang out of Debian's source packages, of the versions that are installed; these are
# fetched once (apt, without root, into build/fuzz-openexr). What is new goes to build/fuzz/corpus, a find to build/fuzz/found.
set -eu

seconds=${1:-60}
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- exr part read
cd "$(dirname "$0")/../.."
kept=$PWD/tests/fuzz/corpus
mkdir -p build/fuzz-openexr/lists/partial
cd build/fuzz-openexr
here=$PWD

if ! [ -e installed/lib/libOpenEXR-3_1.a ]; then
  key=/usr/share/keyrings/debian-archive-keyring.gpg
  codename=$(. /etc/os-release && echo "$VERSION_CODENAME")
  for suite in "debian $codename" "debian-security $codename-security"; do
    echo "deb-src [signed-by=$key] http://deb.debian.org/$suite main"
  done >sources.list
  apt="-qq -o Dir::Etc::SourceList=$here/sources.list -o Dir::Etc::SourceParts=- -o Dir::State::Lists=$here/lists
       -o Dir::Cache::PkgCache= -o Dir::Cache::SrcPkgCache= -o APT::Sandbox::User=$(id -un)"
  version() { dpkg-query -W -f '${source:Version}' "$1"; }
  # shellcheck disable=SC2086  # Words.
  apt-get $apt update && apt-get $apt source "openexr=$(version libopenexr-dev)" "imath=$(version libimath-dev)"
  for library in imath openexr; do
    flags='-O1 -g1 -fno-omit-frame-pointer -fsanitize=fuzzer-no-link,address'
    cmake -G Ninja -S $library-*/ -B $library -DCMAKE_BUILD_TYPE=None -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ \
      -DCMAKE_C_FLAGS="$flags" -DCMAKE_CXX_FLAGS="$flags" -DBUILD_SHARED_LIBS=OFF -DBUILD_TESTING=OFF \
      -DOPENEXR_BUILD_TOOLS=OFF -DOPENEXR_INSTALL_EXAMPLES=OFF -DCMAKE_PREFIX_PATH="$here/installed" \
      -DCMAKE_INSTALL_PREFIX="$here/installed" -DCMAKE_INSTALL_LIBDIR=lib
    cmake --build $library --target install
  done
fi

cd ../..
cmake --preset fuzz -D ENVMAP_FUZZ_OPENEXR="$here/installed/lib"
targets=
for target; do targets="$targets fuzz_openexr_$target"; done
# shellcheck disable=SC2086  # Words.
cmake --build --preset fuzz --target $targets
cd build/fuzz
mkdir -p found

status=0
for target; do
  grown=corpus/openexr-$target
  mkdir -p "$grown"
  folders=$kept/exr
  [ "$target" != part ] || folders=$kept/part
  # Leaks are those that libFuzzer finds in one input again.
  # shellcheck disable=SC2086  # Words.
  timeout -s KILL $((seconds + 60)) "./fuzz_openexr_$target" -close_fd_mask=3 -timeout=20 -print_final_stats=1 -artifact_prefix=found/ \
    -max_len=4096 -len_control=0 -rss_limit_mb=2048 -malloc_limit_mb=1024 -max_total_time="$seconds" ${FUZZ_OPTIONS:-} $grown $folders || status=1
done
exit $status

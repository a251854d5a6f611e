#!/bin/sh
# Runs the program's commands on small inputs, and the tests of the library, with several threads under the thread sanitizer; the exit status is 0 where it saw
# no race.
#
#   sh tests/tsan.sh
#
# The sanitizer must see how oneTBB hands work from thread to thread, so that library is built with it, too: from Debian's
# source package, which is fetched once, of the version that is installed (apt, without root, into build/tsan). Other
# libraries are used as they are installed and not looked into; tests/tsan.supp is for what is seen of them all the same.
set -eu

cd "$(dirname "$0")/.."
root=$PWD
mkdir -p build/tsan/onetbb/lists/partial
cd build/tsan/onetbb

if ! [ -e tbb/libtbb.so.12 ]; then
  version=$(dpkg-query -W -f '${source:Version}' libtbb12)
  key=/usr/share/keyrings/debian-archive-keyring.gpg
  codename=$(. /etc/os-release && echo "$VERSION_CODENAME")
  for suite in "debian $codename" "debian-security $codename-security"; do
    echo "deb-src [signed-by=$key] http://deb.debian.org/$suite main"
  done >sources.list
  apt="-qq -o Dir::Etc::SourceList=$PWD/sources.list -o Dir::Etc::SourceParts=- -o Dir::State::Lists=$PWD/lists
       -o Dir::Cache::PkgCache= -o Dir::Cache::SrcPkgCache= -o APT::Sandbox::User=$(id -un)"
  # shellcheck disable=SC2086  # Words.
  apt-get $apt update && apt-get $apt source "onetbb=$version"
  cmake -G Ninja -S onetbb-*/ -B build -DCMAKE_BUILD_TYPE=RelWithDebInfo -DTBB_SANITIZE=thread -DTBB_TEST=OFF -DTBB_STRICT=OFF \
    -DTBBMALLOC_BUILD=OFF
  cmake --build build --target tbb
  ln -sfn build/*_relwithdebinfo tbb
fi
export LD_LIBRARY_PATH="$PWD/tbb"

cd "$root"
cmake --preset tsan
cmake --build --preset tsan --target envmap_program library_tests
export TSAN_OPTIONS="suppressions=$root/tests/tsan.supp halt_on_error=0 exitcode=66 second_deadlock_stack=1 history_size=7 ${TSAN_OPTIONS:-}"
# Randomised addresses can lie where the sanitizer keeps its own memory.
sh tests/every_command.sh "$root/build/tsan/envmap" setarch -R
setarch -R build/tsan/library_tests
echo 'no race'

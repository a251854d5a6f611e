#!/bin/sh
# Which lines and branches of src/ and tools/ the tests reach: a table, and build/coverage/report/index.html.
#
#   sh tests/coverage.sh [OPTIONS...]
#
# OPTIONS go to ctest, such as -R NAME. Needs gcovr. Branches that only exceptions take are not counted. Tests that limit how large a
# file may be are left out: they would cut the files of the counters, whose messages other tests then find.
set -eu

cd "$(dirname "$0")/.."
cmake --preset coverage
cmake --build --preset coverage
find build/coverage -name '*.gcda' -delete
ctest --preset coverage -j "$(nproc)" -E 'FullDisk|full_disk|CutShort|NoTmpfile' "$@" || echo 'tests/coverage.sh: some tests failed' >&2
mkdir -p build/coverage/report
gcovr --root . --object-directory build/coverage --filter src/ --filter tools/ --exclude-throw-branches --exclude-unreachable-branches \
  --gcov-ignore-parse-errors --html-details build/coverage/report/index.html --txt --print-summary

#!/bin/sh
# Installs the packages that are missing, builds, and runs every test. The last line is 'N passed, N failed'; the exit
# status is 0 only if tests ran and all of them passed.
#
#   sh tests/run.sh [PRESET [OPTIONS...]]
#
# PRESET is one of CMakePresets.json (default: release, and ci where CI=true); OPTIONS go to ctest, such as -R NAME.
set -eu

preset=release
[ "${CI:-}" != true ] || preset=ci
preset=${1:-$preset}
[ $# -eq 0 ] || shift

cd "$(dirname "$0")/.."

# Whatever goes wrong before the tests, the last line is there to be read.
give_up() {
  echo "tests/run.sh: $1" >&2
  echo '0 passed, 0 failed'
  exit 1
}

sh packages.sh || give_up 'packages are missing'
cmake --preset "$preset" || give_up 'not configured'
cmake --build --preset "$preset" || give_up 'not built'

results=$PWD/build/$preset/results.xml
rm -f "$results"
status=0
ctest --preset "$preset" -j "$(nproc)" --output-junit "$results" "$@" || status=$?
[ -f "$results" ] || give_up 'ctest wrote no results'

# Test output inside the file has its '<' escaped, so only ctest's own tags match.
count() {
  grep -c "$1" "$results" || true
}
all=$(count '<testcase ')
passed=$(count '<testcase .*status="run"')
# A test that says of itself that it cannot run here is no failure; one that ctest could not start is.
skipped=$(count '<skipped message="SKIP_')
disabled=$(count '<testcase .*status="disabled"')
failed=$((all - passed - skipped - disabled))

[ $((skipped + disabled)) -eq 0 ] || echo "$skipped skipped, $disabled disabled"
if [ "$status" -eq 0 ] && [ $((passed + failed)) -eq 0 ]; then
  echo 'tests/run.sh: no test ran' >&2
  status=1
fi
[ "$failed" -eq 0 ] || [ "$status" -ne 0 ] || status=1
echo "$passed passed, $failed failed"
exit "$status"

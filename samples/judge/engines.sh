#!/bin/sh
# What engines make of maps that they filter themselves: a line of JSON for each. Called by judge.py.
#
#   sh engines.sh FOLDER MAP...
#
# FOLDER holds asked.json and MAP/background.exr. The engines and the browser are those of tests/engines.
set -eu

judge=$(cd "$(dirname "$0")" && pwd)
asked=$(realpath "$1")
shift
here=$judge/../../tests/engines
. "$here/install.sh"
cp "$judge"/*.mjs "$folder"
rm -rf "$folder/asked"  # Where a folder is kept.
cp -r "$asked" "$folder/asked"
node ask.mjs "$@"

#!/bin/sh
# What Godot 3 (Debian's godot3) shows of the folder that `envmap bake --for godot` writes, on a virtual display (xvfb), into results.json.
#
#   [ENVMAP=PROGRAM] sh tests/engines/godot.sh
#
# The preset is read from Godot 4's shaders, which no package here has; Godot 3 holds panoramas in the same frame.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
envmap=$(realpath "${ENVMAP:-$here/../../build/ci/envmap}")
for tool in godot3 xvfb-run node; do
  command -v $tool >/dev/null || { echo "tests/engines: Godot skipped, no $tool here"; exit 0; }
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp "$here/godot3.gd" "$folder"
cd "$folder"
printf 'config_version=4\n[rendering]\nquality/driver/driver_name="GLES3"\n' > project.godot
"$envmap" generate directions directions.exr --to cube --size 256
"$envmap" bake directions.exr light --for godot -q
xvfb-run -a godot3 --path . -s godot3.gd light/background.exr 2>/dev/null | grep '^{' > found.json
cat > merge.mjs <<'END'
import { readFileSync, writeFileSync } from 'node:fs';

const [path, version, envmap] = process.argv.slice(2), limits = { sky: 0.02, mirror: 0.05, diffuse: 0.1 };
const { directions } = JSON.parse(readFileSync('found.json')), failures = [];
for (const what in directions) directions[what] = Number(directions[what].toPrecision(3));
for (const what in limits) if (!(directions[what] <= limits[what])) failures.push(`directions: ${what} is off by ${directions[what]}`);
const results = { ...JSON.parse(readFileSync(path)), godot3: { version, envmap, failures, directions } };
writeFileSync(path, JSON.stringify(Object.fromEntries(Object.entries(results).sort()), null, 2) + '\n');
console.log('godot3:', failures.length ? failures.join('; ') : 'as it should be', JSON.stringify(directions));
process.exit(failures.length ? 1 : 0);
END
node merge.mjs "$here/results.json" "$(godot3 --version 2>/dev/null | tail -n 1)" "$("$envmap" --version | head -n 1)"

# What run.sh and real.sh begin with: the engines of package.json and the pages in $folder, and there. Ends with 0 where that cannot be.
# Read with `.`, with $here set.
for tool in node npm chromium; do
  command -v $tool >/dev/null || { echo "tests/engines: skipped, no $tool here"; exit 0; }
done
if [ -n "${ENGINES_FOLDER:-}" ]; then
  folder=$ENGINES_FOLDER
  mkdir -p "$folder"
else
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
fi
cp "$here/package.json" "$folder"
if [ ! -d "$folder/node_modules" ] && ! npm --prefix "$folder" install --silent --no-audit --no-fund; then
  echo "tests/engines: skipped, npm cannot install the engines"
  exit 0
fi
# bake_for ENGINE PROBE FOLDER: as the engine's module loads it.
bake_for() {
  case $1 in
  three-jpeg) "$envmap" bake "$2" "$3" --for three --gain-map -q ;;
  *) "$envmap" bake "$2" "$3" --for "${1%-webgpu}" -q ;;
  esac
}
mkdir -p "$folder/probes"
cp "$here"/*.mjs "$here"/*.html "$folder"
cd "$folder"

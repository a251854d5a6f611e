// Asks the page about each engine, and keeps what it measured.
import { existsSync, readFileSync, readdirSync, statSync, writeFileSync } from 'node:fs';
import { open_browser } from './browser.mjs';

const [envmap, results, ...engines] = process.argv.slice(2);
const browser = await open_browser();
const version = (name) => JSON.parse(readFileSync(`node_modules/${name}/package.json`)).version;
const packages = { babylon: 'babylonjs', 'babylon-env': 'babylonjs', gltf: 'babylonjs-loaders', 'three-jpeg': 'three', 'three-latlong': 'three', 'three-webgpu': 'three' };
const bytes = (folder) => readdirSync(folder).reduce((sum, file) => sum + statSync(`${folder}/${file}`).size, 0);
const all = existsSync(results) ? JSON.parse(readFileSync(results)) : {};
let status = 0;
for (const engine of engines) {
  const found = await browser.ask({ engine });
  if (found.error || found.failures.length > 0) status = 1;
  const { failures, ...figures } = found;
  console.log(`${engine}: ${found.error ?? (failures.length === 0 ? 'as it should be' : failures.join('; '))}`);
  console.log(JSON.stringify(figures, null, 1));
  all[engine] = { version: version(packages[engine] ?? engine), browser: browser.version, envmap, failures, bytes: bytes(`probes/${engine}-directions`), ...figures };
}
writeFileSync(results, JSON.stringify(Object.fromEntries(Object.entries(all).sort()), null, 2) + '\n');
await browser.close();
process.exit(status);

// What engines draw of the balls of pictures.mjs against `envmap view`, and that against Cycles.
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { FloatType } from 'three';
import { EXRLoader } from 'three/addons/loaders/EXRLoader.js';
import { open_browser } from './browser.mjs';
import { balls, eye, fov, name_of, size } from './pictures.mjs';

const [envmap, probe, results, ...engines] = process.argv.slice(2);

// Rows from the bottom, as the engines'.
function read_exr(path) {
  const bytes = readFileSync(path);
  const { data, width } = new EXRLoader().setDataType(FloatType).parse(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
  return { data, channels: data.length / width / width };
}

// Pixels whose middle sees the ball, 2% of its radius inside its rim.
const radius = (0.98 * size * Math.tan(Math.asin(1 / Math.hypot(...eye)))) / Math.tan((fov * Math.PI) / 360) / 2;
const inside = (k) => Math.hypot((k % size) + 0.5 - size / 2, Math.floor(k / size) + 0.5 - size / 2) < radius;

// Of a against b: the difference's rms over b's, and the means' ratio.
function differ(a, b) {
  let off = 0, all = 0, sum_a = 0, sum_b = 0;
  for (let k = 0; k < size * size; ++k)
    for (let c = 0; c < 3; ++c) {
      if (!inside(k)) continue;
      const x = a.data[a.channels * k + c], y = b.data[b.channels * k + c];
      off += (x - y) ** 2;
      all += y * y;
      sum_a += x;
      sum_b += y;
    }
  const rounded = (v) => Number(v.toPrecision(3));
  return { rms: rounded(Math.sqrt(off / all)), mean: rounded(sum_a / sum_b - 1) };
}

const names = balls.map(name_of);
const viewed = Object.fromEntries(names.map((n) => [n, read_exr(`balls/${n}.exr`)]));
const before = existsSync(results) ? JSON.parse(readFileSync(results)) : {};
const table = before.probe === probe ? before.table : {};  // Rows of engines that are not asked stay.
if (existsSync(`balls/${names[0]} cycles.exr`))
  table.cycles = Object.fromEntries(names.map((n) => [n, differ(read_exr(`balls/${n} cycles.exr`), viewed[n])]));
const browser = await open_browser();
for (const engine of engines) {
  const drawn = await browser.ask({ engine, probe: `probes/${engine}-real` });
  if (drawn.error) console.error(`${engine}: ${drawn.error}`);
  else table[engine] = Object.fromEntries(names.map((n) => [n, differ({ data: drawn[n], channels: 4 }, viewed[n])]));
}
await browser.close();
writeFileSync(results, JSON.stringify({ envmap, browser: browser.version, probe, against: 'envmap view', table }, null, 1) + '\n');
for (const [who, found] of Object.entries(table))
  console.log(`${who}: ${names.map((n) => `${n}: rms ${found[n].rms}, mean ${found[n].mean}`).join('; ')}`);

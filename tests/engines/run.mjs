// Serves the folder it runs in, opens page.html for each engine, and keeps what the pages measured.
import { createReadStream, existsSync, readFileSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';
import puppeteer from 'puppeteer-core';

const [envmap, results, ...engines] = process.argv.slice(2);
const types = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.wasm': 'application/wasm' };

const server = createServer((request, response) => {
  const file = join(process.cwd(), normalize(decodeURIComponent(new URL(request.url, 'http://localhost').pathname)));
  if (!existsSync(file)) {
    response.writeHead(404).end();
    return;
  }
  response.writeHead(200, { 'Content-Type': types[extname(file)] ?? 'application/octet-stream' });
  createReadStream(file).pipe(response);
});
await new Promise((listening) => server.listen(0, '127.0.0.1', listening));

const browser = await puppeteer.launch({
  executablePath: '/usr/bin/chromium',
  headless: true,
  protocolTimeout: 600000,
  // Mesa's llvmpipe. SwiftShader tears triangles that reach behind the camera, such as those of three.js' sky.
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=gl-egl', '--ozone-platform=headless', '--ignore-gpu-blocklist'],
});
const version = (name) => JSON.parse(readFileSync(`node_modules/${name}/package.json`)).version;
const packages = { babylon: 'babylonjs' };
const all = existsSync(results) ? JSON.parse(readFileSync(results)) : {};
let status = 0;
for (const engine of engines) {
  const page = await browser.newPage();
  page.on('pageerror', (e) => console.error(`${engine}: ${e}`));
  page.on('console', (m) => ['error', 'warn'].includes(m.type()) && console.error(`${engine}: ${m.text()}`));
  await page.goto(`http://127.0.0.1:${server.address().port}/page.html?engine=${engine}`);
  const found = await (await page.waitForFunction('window.result', { timeout: 600000 })).jsonValue();
  await page.close();
  if (found.error || found.failures.length > 0) status = 1;
  const { failures, ...figures } = found;
  console.log(`${engine}: ${found.error ?? (failures.length === 0 ? 'as it should be' : failures.join('; '))}`);
  console.log(JSON.stringify(figures, null, 1));
  all[engine] = {
    version: version(packages[engine] ?? engine), browser: await browser.version(), envmap, failures, ...figures };
}
writeFileSync(results, JSON.stringify(Object.fromEntries(Object.entries(all).sort()), null, 2) + '\n');
await browser.close();
server.close();
process.exit(status);

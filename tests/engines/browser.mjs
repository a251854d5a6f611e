// Chromium without a display, and a server of the folder that it runs in.
import { createReadStream, existsSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';
import puppeteer from 'puppeteer-core';

const types = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.wasm': 'application/wasm' };

// @return ask(query): opens page.html for it, and gives window.result; version; close().
export async function open_browser() {
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
  return {
    version: await browser.version(),
    async ask(query) {
      const page = await browser.newPage();
      page.on('pageerror', (e) => console.error(`${query.engine}: ${e}`));
      page.on('console', (m) => ['error', 'warn'].includes(m.type()) && console.error(`${query.engine}: ${m.text()}`));
      await page.goto(`http://127.0.0.1:${server.address().port}/page.html?${new URLSearchParams(query)}`);
      const found = await (await page.waitForFunction('window.result', { timeout: 600000 })).jsonValue();
      await page.close();
      return found;
    },
    async close() {
      await browser.close();
      server.close();
    },
  };
}

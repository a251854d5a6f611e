// Chromium without a display, and a server of the folder that it runs in.
import { createReadStream, existsSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';
import puppeteer from 'puppeteer-core';

const types = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.wasm': 'application/wasm' };

// Mesa's llvmpipe. SwiftShader tears triangles that reach behind the camera, such as those of three.js' sky.
const webgl = ['--use-gl=angle', '--use-angle=gl-egl', '--ozone-platform=headless'];
const webgpu = ['--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader', '--enable-features=Vulkan'];

const launch = (more) => puppeteer.launch({
  executablePath: '/usr/bin/chromium', headless: true, protocolTimeout: 600000, args: ['--no-sandbox', '--ignore-gpu-blocklist', ...more] });

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
  const browser = await launch(webgl);
  let for_webgpu = null;
  return {
    version: await browser.version(),
    async ask(query) {
      const of_gpu = query.engine.endsWith('-webgpu');
      if (of_gpu) for_webgpu ??= await launch(webgpu);
      const page = await (of_gpu ? for_webgpu : browser).newPage();
      page.on('pageerror', (e) => console.error(`${query.engine}: ${e}`));
      page.on('console', (m) => ['error', 'warn'].includes(m.type()) && console.error(`${query.engine}: ${m.text()}`));
      await page.goto(`http://127.0.0.1:${server.address().port}/page.html?${new URLSearchParams(query)}`);
      const found = await (await page.waitForFunction('window.result', { timeout: 600000 })).jsonValue();
      await page.close();
      return found;
    },
    async close() {
      await for_webgpu?.close();
      await browser.close();
      server.close();
    },
  };
}

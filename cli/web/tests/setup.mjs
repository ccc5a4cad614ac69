// What the tests share: the program, the browser, and looks at a page.

import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { mkdirSync } from 'node:fs';
import { createInterface } from 'node:readline';
import { join } from 'node:path';
import { chromium } from 'playwright-core';

/** Where the tests write. */
export const SCRATCH = join(process.cwd(), 'scratch');

const SHOTS = join(SCRATCH, 'shots');
mkdirSync(SHOTS, { recursive: true });

/** Software WebGL, and none of the browser's own connections. */
const FLAGS = [
  '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--no-first-run',
  '--disable-background-networking', '--disable-component-update', '--disable-sync',
];

/** Runs motif and gives its JSON document. */
export function motif(...args) {
  const out = execFileSync(process.env.MOTIF, [...args, '--json'], {
    maxBuffer: 1 << 28, stdio: ['ignore', 'pipe', 'inherit'],
  });
  return JSON.parse(out);
}

/** Starts `motif view`; gives its address and how to end it. */
export async function startView(...args) {
  const server = spawn(process.env.MOTIF, ['view', ...args, '--port', '0'], {
    stdio: ['ignore', 'pipe', 'pipe'],
  });
  const said = [];
  const address = await new Promise((resolve, reject) => {
    server.on('exit', () => reject(new Error(`view ended: ${said.join('\n')}`)));
    for (const stream of [server.stdout, server.stderr]) {
      createInterface({ input: stream }).on('line', (line) => {
        said.push(line);
        const found = /http:\/\/127\.0\.0\.1:\d+/.exec(line);
        if (found) resolve(found[0]);
      });
    }
  });
  return { address, pid: server.pid, stop: () => server.kill('SIGINT') };
}

export const launch = () => chromium.launch({
  executablePath: process.env.MOTIF_BROWSER, args: FLAGS,
});

/** Opens a page; `errors` and `requests` grow as it goes on. */
export async function open(browser, url, { width = 1280, height = 900, colorScheme = 'light' } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme });
  const page = await context.newPage();
  const errors = [];
  const requests = [];
  page.on('console', (message) => {
    if (message.type() === 'error') errors.push(message.text());
  });
  page.on('pageerror', (error) => errors.push(String(error)));
  page.on('request', (request) => requests.push(request.url()));
  await page.goto(url);
  return { page, errors, requests, close: () => context.close() };
}

export const byId = (page, id) => page.locator(`[data-testid="${id}"]`);

/**
 * The stage's pixels: how many are blue as left limbs and orange as right ones, and all as one number, to see whether
 * the picture changed.
 */
export async function stagePixels(page) {
  await page.waitForFunction(() => document.querySelector('[data-testid="canvas3d"]')?.width > 0);
  return page.evaluate(() => {
    const gl = document.querySelector('[data-testid="canvas3d"]').getContext('webgl2');
    const { drawingBufferWidth: w, drawingBufferHeight: h } = gl;
    const pixels = new Uint8Array(w * h * 4);
    gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    let [left, right, print] = [0, 0, 0];
    for (let i = 0; i < pixels.length; i += 4) {
      const warmth = pixels[i] - pixels[i + 2];
      if (warmth < -60) left += 1;
      if (warmth > 60) right += 1;
      for (let k = i; k < i + 4; k += 1) print = (Math.imul(print, 31) + pixels[k]) | 0;
    }
    return { left, right, print };
  });
}

/** The frame that the player states. */
export async function frame(page) {
  const text = await byId(page, 'time').textContent();
  const found = /frame\s+(\d+)/i.exec(text);
  assert.ok(found, `expected a frame in ${JSON.stringify(text)}`);
  assert.match(text, /\d(\.\d+)?\s*s/, 'seconds stand beside the frame');
  return Number(found[1]);
}

/** Waits for two frames: one to lay out, one to draw. */
export const drawn = (page) => page.evaluate(() => new Promise((done) => {
  requestAnimationFrame(() => requestAnimationFrame(done));
}));

/** Keeps a picture for a person to look at. */
export const shot = (page, name) => page.screenshot({ path: join(SHOTS, `${name}.png`) });

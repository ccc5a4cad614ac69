// The live viewer over a library of 600 clips made from the demo's corpus.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { cpSync, existsSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { SCRATCH, byId, launch, limbPixels, motif, open, shot, startView } from './setup.mjs';

const CLIPS = 600;
/** More than fit on a screen, far fewer than there are. */
const MOST_LOADED = 200;

let browser;
let view;

before(async () => {
  const demo = join(SCRATCH, 'demo');
  if (!existsSync(join(demo, 'corpus'))) motif('demo', '--dir', demo);
  const many = join(SCRATCH, 'many');
  const library = join(SCRATCH, 'many-library');
  for (const dir of [many, library]) rmSync(dir, { recursive: true, force: true });
  const { result } = motif('info', join(demo, 'corpus'));
  const copies = Math.ceil(CLIPS / result.length);
  for (let k = 0; k < copies; k += 1) cpSync(join(demo, 'corpus'), join(many, `copy${k}`), { recursive: true });
  motif('index', many, '-o', library);
  view = await startView(library, '--templates', join(demo, 'templates'));
  browser = await launch();
});
after(async () => {
  await browser?.close();
  view?.stop();
});

test('the contact sheet of a large library opens', async (t) => {
  const start = performance.now();
  const { page, errors, close } = await open(browser, `${view.address}/?test`);
  await byId(page, 'clip-row').first().waitFor();
  t.diagnostic(`contact sheet of ${CLIPS} clips and more: ${Math.round(performance.now() - start)} ms`);
  await page.waitForTimeout(500);
  const loaded = await page.evaluate(() => window.motif.store.clips.size);
  assert.ok(loaded > 0 && loaded <= MOST_LOADED, `${loaded} clips loaded`);
  await shot(page, 'view-library');
  await byId(page, 'filter').fill('squat');
  await page.waitForFunction(() => {
    const rows = [...document.querySelectorAll('[data-testid="clip-row"]')];
    return rows.length > 0 && rows.every((row) => /squat/i.test(row.textContent));
  });
  await byId(page, 'clip-row').first().click();
  await page.waitForFunction(() => document.querySelector('[data-testid="time"]').textContent !== '');
  await page.waitForTimeout(200);
  const { left, right } = await limbPixels(page);
  assert.ok(left > 300 && right > 300, `${left} blue and ${right} orange pixels`);
  assert.deepEqual(errors, []);
  await close();
});

test('a dragged span is searched', async () => {
  const { page, errors, close } = await open(browser, `${view.address}/?test`);
  await byId(page, 'filter').fill('squat');
  await page.waitForFunction(() => {
    const rows = [...document.querySelectorAll('[data-testid="clip-row"]')];
    return rows.length > 0 && rows.every((row) => /squat/i.test(row.textContent));
  });
  await byId(page, 'clip-row').first().click();
  await byId(page, 'tab-clip-0').waitFor();
  await byId(page, 'tab-live-0').click();
  const panel = byId(page, 'search-panel');
  await panel.waitFor();
  const track = byId(page, 'span-drag').first();
  await track.scrollIntoViewIfNeeded();
  const box = await track.boundingBox();
  const y = box.y + box.height / 2;
  await page.mouse.move(box.x + box.width * 0.2, y);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.5, y, { steps: 5 });
  await page.mouse.move(box.x + box.width * 0.8, y, { steps: 5 });
  await page.mouse.up();
  await byId(page, 'hit').first().waitFor();
  assert.ok(await byId(page, 'hit').count() > 0);
  await shot(page, 'view-search');
  assert.deepEqual(errors, []);
  await close();
});

test('a scene is searched, and an error stands where it is', async () => {
  const { page, close } = await open(browser, `${view.address}/?test`);
  await byId(page, 'tab-live-0').click();
  await page.getByText('Search by scene').click();
  const scene = byId(page, 'scene-input');
  await scene.fill('rknee_bent : 0 1 0\nrnee_bent : 0 1 0\n');
  const error = byId(page, 'scene-error');
  await error.waitFor();
  assert.equal(await error.getAttribute('data-line'), '2');
  assert.equal(await error.getAttribute('data-column'), '1');
  await shot(page, 'view-scene-error');
  await scene.fill('rknee_bent : 0 1 0\n');
  await byId(page, 'hit').first().waitFor();
  assert.equal(await error.isVisible(), false);
  await close();
});

test('a template is searched at the threshold chosen', async () => {
  const { page, errors, close } = await open(browser, `${view.address}/?test`);
  await byId(page, 'tab-live-0').click();
  const choice = byId(page, 'template-select');
  await choice.selectOption({ index: 1 });
  await byId(page, 'hit').first().waitFor();
  await shot(page, 'view-template');
  assert.deepEqual(errors, []);
  await close();
});

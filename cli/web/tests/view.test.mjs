// The live viewer over a library of 600 clips made from the demo's corpus.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { cpSync, existsSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { SCRATCH, byId, drawn, frame, launch, motif, open, shot, stagePixels, startView } from './setup.mjs';

const CLIPS = 600;
/** More than fit on a screen, far fewer than there are. */
const MOST_LOADED = 200;
/** Takes two answers: a page asks for 10,000 frames at once. */
const LONG_FRAMES = 12_000;

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
  writeFileSync(join(many, 'long.bvh'), lengthened(readFileSync(join(demo, 'corpus/dan/hop_01.bvh'), 'utf8')));
  motif('index', many, '-o', library);
  view = await startView(library, '--templates', join(demo, 'templates'));
  browser = await launch();
});
after(async () => {
  await browser?.close();
  view?.stop();
});

/** Two rows of three columns. */
const AGREEMENT = {
  image: 'data:image/gif;base64,R0lGODlhAQABAIAAAAAAAP///yH5BAEAAAAALAAAAAABAAEAAAIBRAA7', width: 1, height: 1, area: [0, 0, 1, 1], seconds: [0, 1],
  values: { of: 'cells', rows: ['rknee_bent', 'lknee_bent'], columns: 3, codes: 'AAEAAQAB', meanings: ['equal', 'different'], unit: null },
};

/** A BVH file with its frames again and again, at the library's rate, so that none is left out. */
function lengthened(bvh) {
  const rows = bvh.trimEnd().split(/Frame Time:.*\n/)[1].split('\n');
  const motion = Array.from({ length: LONG_FRAMES }, (_, k) => rows[k % rows.length]);
  return `${bvh.slice(0, bvh.indexOf('Frames:'))}Frames: ${LONG_FRAMES}\nFrame Time: ${1 / 30}\n${motion.join('\n')}\n`;
}

/** Types a filter and waits for the cards that it leaves. */
async function filtered(page, text) {
  await byId(page, 'filter').fill(text);
  await page.waitForFunction((wanted) => {
    const rows = [...document.querySelectorAll('[data-testid="clip-row"]')];
    return rows.length > 0 && rows.every((row) => row.textContent.includes(wanted));
  }, text);
}

test('the contact sheet of a large library opens', async (t) => {
  const start = performance.now();
  const { page, errors, close } = await open(browser, `${view.address}/?test`);
  await byId(page, 'clip-row').first().waitFor();
  t.diagnostic(`contact sheet of ${CLIPS} clips and more: ${Math.round(performance.now() - start)} ms`);
  await page.waitForLoadState('networkidle');
  const loaded = await page.evaluate(() => window.motif.store.clips.size);
  assert.ok(loaded > 0 && loaded <= MOST_LOADED, `${loaded} clips loaded`);
  await shot(page, 'view-library');
  await filtered(page, 'squat');
  await byId(page, 'clip-row').first().click();
  await page.waitForFunction(() => document.querySelector('[data-testid="time"]').textContent !== '');
  await drawn(page);
  const { left, right } = await stagePixels(page);
  assert.ok(left > 300 && right > 300, `${left} blue and ${right} orange pixels`);
  assert.deepEqual(errors, []);
  await close();
});

test('a dragged span is searched', async () => {
  const { page, errors, close } = await open(browser, `${view.address}/?test`);
  await filtered(page, 'squat');
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

  await scene.pressSequentially('overlap rknee_bent[2] lkn');
  const name = page.getByRole('button', { name: 'lknee_bent' });
  const [shown, around] = [await name.boundingBox(), await scene.boundingBox()];
  const right = shown.x - around.x;
  // Two lines of 21 pixels above it, 25 letters before it; a letter is 6 to 10 pixels wide.
  assert.ok(shown.y - around.y > 42 && shown.y - around.y < 84, `the name stands below the caret, not ${shown.y - around.y} down`);
  assert.ok(right > 25 * 6 && right < 25 * 10 + 20, `${right} pixels from the left`);
  await page.keyboard.press('Tab');
  assert.match(await scene.inputValue(), /\[2\] lknee_bent$/);
  await close();
});

test('a template is searched at the threshold chosen', async () => {
  const { page, errors, close } = await open(browser, `${view.address}/?test`);
  await byId(page, 'tab-live-0').click();
  const choice = byId(page, 'template-select');
  await choice.selectOption({ index: 1 });
  await byId(page, 'hit').first().waitFor();
  await shot(page, 'view-template');
  const told = '[data-testid="search-panel"] .note[role="status"]';
  const [, few] = /(\d+) hits?/.exec(await page.locator(told).textContent());
  await byId(page, 'tau').fill('0.3');
  await page.waitForFunction(([where, before]) => /(\d+) hits?/.exec(document.querySelector(where)?.textContent)?.[1] > before, [told, +few]);
  assert.deepEqual(errors, []);
  await close();
});

test('a long clip plays before all of it is there', async () => {
  const { page, errors, close } = await open(browser, `${view.address}/?test`);
  // The first clip of the sheet is shown by itself.
  await page.waitForFunction(() => document.querySelector('[data-testid="time"]').textContent !== '');
  await filtered(page, 'long');
  const card = byId(page, 'clip-row').first();
  let letGo;
  const held = new Promise((resolve) => { letGo = resolve; });
  const ranges = [];
  await page.route(`**/api/clips/${await card.getAttribute('data-clip')}/motion`, async (route) => {
    ranges.push(await route.request().headerValue('range'));
    if (ranges.length > 1) await held;
    await route.continue();
  });
  await card.click();
  await page.waitForFunction(() => /frame [1-9]\d* \/ 11999$/.test(document.querySelector('[data-testid="time"]').textContent));
  await page.evaluate(() => window.motif.player.pause());
  const limbs = async (at) => {
    await page.evaluate((to) => window.motif.player.seekFrame(to), at);
    await drawn(page);
    const { left, right } = await stagePixels(page);
    return Math.min(left, right);
  };
  assert.ok(await limbs(9999) > 300, 'what is there is drawn');
  assert.equal(await limbs(LONG_FRAMES - 1), 0, 'what is not there is not');
  letGo();
  await page.waitForFunction(() => [...window.motif.player.takes].every(({ motion }) => !motion.rest));
  await drawn(page);
  assert.equal(await frame(page), LONG_FRAMES - 1, 'the time stays');
  assert.ok(await limbs(LONG_FRAMES - 1) > 300, 'it is drawn once it is there');
  // 24 points of three numbers of two bytes.
  assert.deepEqual(ranges, [0, 1].map((k) => `bytes=${k * 1_440_000}-${(k + 1) * 1_440_000 - 1}`));
  assert.deepEqual(errors, []);
  await close();
});

test('where a hit agrees is asked for when it is opened', async () => {
  const { page, close } = await open(browser, `${view.address}/?test`);
  const asked = [];
  await page.route('**/api/scene?*', async (route) => {
    const response = await route.fetch();
    const answer = await response.json();
    for (const [k, hit] of answer.pages[0].hits.entries()) {
      Object.assign(hit, { agreement: null, ask: `agreement?hit=${k}` });
    }
    await route.fulfill({ response, json: answer });
  });
  await page.route('**/api/agreement*', (route) => {
    asked.push(new URL(route.request().url()).search);
    if (asked.length === 1) return route.fulfill({ status: 500, json: { error: 'too many at once' } });
    return route.fulfill({ json: { agreement: AGREEMENT } });
  });
  await byId(page, 'tab-live-0').click();
  await page.getByText('Search by scene').click();
  await byId(page, 'scene-input').fill('rknee_bent : 0 1 0\n');
  const second = page.locator('[data-testid="hit"][data-rank="2"]');
  await second.click();
  await page.getByText('too many at once').waitFor();
  await second.click();
  await second.click();
  await byId(page, 'plot').waitFor();
  assert.equal(await page.getByText('too many at once').count(), 0);
  assert.equal(await page.getByText('Dark blue is on').isVisible(), true);
  await second.click();
  await second.click();
  assert.deepEqual(asked, ['?hit=1', '?hit=1'], 'what came is not asked for again');
  await shot(page, 'view-agreement');
  await close();
});

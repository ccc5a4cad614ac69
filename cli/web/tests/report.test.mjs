// The report of the demo's whole tour, opened from a file.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { readdirSync } from 'node:fs';
import { join } from 'node:path';
import { SCRATCH, byId, drawn, frame, launch, motif, open, shot, stagePixels } from './setup.mjs';

/** Pixels of one side's limbs at least: a skeleton of lines one pixel wide has fewer. */
const LIMB_PIXELS = 300;

let browser;
let url;

before(async () => {
  const dir = join(SCRATCH, 'demo');
  motif('demo', '--dir', dir);
  const pages = readdirSync(dir).filter((name) => name.endsWith('.html'));
  assert.equal(pages.length, 1, 'the demo ends with one report');
  url = `file://${join(dir, pages[0])}?test`;
  browser = await launch();
});
after(() => browser?.close());

/** Goes to the first tab of a kind and waits until something can be played. */
async function tab(page, kind) {
  await byId(page, `tab-${kind}-0`).click();
  await page.waitForFunction(() => document.querySelector('[data-testid="page"]').childElementCount > 0);
}

async function shown(page) {
  await page.waitForFunction(() => document.querySelector('[data-testid="time"]').textContent !== '');
  await drawn(page);
}

for (const [name, options] of Object.entries({
  desk: { width: 1280, height: 900 },
  phone: { width: 390, height: 844 },
  dark: { width: 1280, height: 900, colorScheme: 'dark' },
})) {
  test(`every page opens, ${name}`, async () => {
    const { page, errors, requests, close } = await open(browser, url, options);
    const tabs = page.locator('[role="tab"]');
    const kinds = new Set();
    for (let k = 0; k < await tabs.count(); k += 1) {
      const id = await tabs.nth(k).getAttribute('data-testid');
      kinds.add(id.split('-')[1]);
      await tabs.nth(k).click();
      await drawn(page);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth);
      assert.ok(wide <= options.width, `${id}: ${wide} pixels wide`);
      // There is nothing to play on the page of a template.
      assert.equal(await byId(page, 'player').isVisible(), !id.includes('template'), id);
      await shot(page, `${name}-${id}`);
    }
    const wanted = ['library', 'search', 'annotation', 'template', 'alignment', 'bundles'];
    assert.deepEqual(wanted.filter((kind) => !kinds.has(kind)), []);
    assert.deepEqual(errors, []);
    assert.deepEqual(requests.filter((request) => !/^(file|data|blob):/.test(request)), []);
    await close();
  });
}

test('a skeleton is drawn, scrubbed and stepped', async () => {
  const { page, errors, close } = await open(browser, url);
  await tab(page, 'library');
  await byId(page, 'clip-row').first().click();
  await shown(page);
  const { left, right } = await stagePixels(page);
  assert.ok(left > LIMB_PIXELS && right > LIMB_PIXELS, `${left} blue and ${right} orange pixels`);

  // A clip that is clicked plays at once.
  await page.evaluate(() => window.motif.player.pause());
  await page.keyboard.press('Home');
  const first = await frame(page);
  const { print } = await stagePixels(page);
  await page.keyboard.press('ArrowRight');
  assert.equal(await frame(page), first + 1);
  await page.keyboard.press('Shift+ArrowRight');
  assert.equal(await frame(page), first + 11);
  await page.keyboard.press('ArrowLeft');
  assert.equal(await frame(page), first + 10);
  await drawn(page);
  assert.notEqual((await stagePixels(page)).print, print, 'another frame is another picture');

  const scrub = byId(page, 'scrub');
  const last = Number(await scrub.getAttribute('max'));
  await byId(page, 'play').click();
  await scrub.fill(String(Math.round((first + last) / 2)));
  const there = await frame(page);
  assert.ok(there >= (first + last) / 2 - 1, `scrubbing while it plays leads to frame ${there}`);
  await page.waitForFunction((old) => {
    const now = /frame (\d+)/.exec(document.querySelector('[data-testid="time"]').textContent)[1];
    return Number(now) !== old;
  }, there);
  assert.deepEqual(errors, []);
  await close();
});

test('two clips follow their path', async () => {
  const { page, errors, close } = await open(browser, url);
  await tab(page, 'alignment');
  await shown(page);
  const path = await page.evaluate(() => window.motif.store.pages.find(({ kind }) => kind === 'alignment').path);
  assert.ok(path.length > 10);
  for (const share of [0, 0.3, 0.7, 1]) {
    const [a, b] = path[Math.round(share * (path.length - 1))];
    await page.evaluate((to) => window.motif.player.seekFrame(to), a);
    assert.equal(Number(await byId(page, 'tag-0').getAttribute('data-frame')), a);
    const partner = Number(await byId(page, 'tag-1').getAttribute('data-frame'));
    const partners = path.filter(([of]) => of === a).map(([, to]) => to);
    assert.ok(partners.includes(partner), `frame ${a} with ${partner}, the path has ${partners}, here ${b}`);
  }
  assert.deepEqual(errors, []);
  await close();
});

test('a node of the graph plays its submotions', async () => {
  const { page, errors, close } = await open(browser, url);
  await tab(page, 'bundles');
  const node = byId(page, 'node').first();
  const bundle = await node.getAttribute('data-bundle');
  await node.click();
  await shown(page);
  const [playing, height] = await page.evaluate((id) => {
    const { nodes } = window.motif.store.pages.find(({ kind }) => kind === 'bundles');
    return [window.motif.player.takes.length, nodes.find((one) => one.id === id).height];
  }, bundle);
  assert.ok(playing > 1 && playing <= height, `${playing} of ${height} submotions`);
  const { left, right } = await stagePixels(page);
  assert.ok(left > LIMB_PIXELS && right > LIMB_PIXELS, `${left} blue and ${right} orange pixels`);
  await shot(page, 'node');
  assert.deepEqual(errors, []);
  await close();
});

test('hits and labelled spans play', async () => {
  const { page, errors, close } = await open(browser, url);
  await tab(page, 'search');
  await byId(page, 'hit').first().click();
  await shown(page);
  const hit = await frame(page);
  await tab(page, 'annotation');
  await byId(page, 'span').first().click();
  await shown(page);
  const span = await page.evaluate(() => {
    const { tracks } = window.motif.store.pages.find(({ kind }) => kind === 'annotation');
    return tracks.flatMap(({ spans }) => spans).map(({ start, end }) => [start, end]);
  });
  const now = await frame(page);
  assert.ok(span.some(([start, end]) => start <= now && now < end), `frame ${now} (the hit was at ${hit})`);
  assert.deepEqual(errors, []);
  await close();
});

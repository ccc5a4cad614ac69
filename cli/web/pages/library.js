import {make, factList, inSeconds, shortName} from '../store.js';
import {drawStrip, onTheme} from '../strip.js';
import {openClip} from './clip.js';

/** Of a card and its margin, in pixels. */
const CARD_HEIGHT = 150;
const CARD_WIDTH = 270;
/** Clips asked for at once. */
const BLOCK = 40;

const SORTS = {
  name: (a, b) => (a.name < b.name ? -1 : +(a.name > b.name)),
  label: (a, b) => ((a.label ?? '') < (b.label ?? '') ? -1 : +((a.label ?? '') > (b.label ?? ''))),
  seconds: (a, b) => (a.end - a.start) / a.rate - (b.end - b.start) / b.rate,
};

/** The clips of a library in the order and choice of a query; `at(k)` is undefined until it is known. */
class Sheet {
  /** @param {function(): void} arrived called when more is known */
  constructor(store, library, arrived) {
    Object.assign(this, { store, library, arrived });
    this.ask({ sort: 'name', down: 0, label: '', text: '' });
  }

  ask(query) {
    this.query = query;
    this.asked = new Set();
    this.clips = [];
    this.total = this.library.n_clips;
    this.failure = null;
    if (this.store.live) return;
    const text = query.text.toLowerCase();
    const sign = query.down ? -1 : 1;
    this.clips = [...this.store.clips.values()]
      .filter((clip) => clip.strip && (!query.label || clip.label === query.label) && clip.name.toLowerCase().includes(text))
      .sort((a, b) => sign * SORTS[query.sort](a, b) || a.id - b.id);
    this.total = this.clips.length;
  }

  at(k) {
    const block = Math.floor(k / BLOCK);
    if (this.store.live && !this.asked.has(block)) {
      this.asked.add(block);
      this.#fetch(block * BLOCK, this.query);
    }
    return this.clips[k];
  }

  async #fetch(from, query) {
    try {
      const answer = await this.store.ask('clips', { from, n: BLOCK, ...query });
      this.store.merge(answer);
      if (query !== this.query) return;
      this.total = answer.total;
      answer.clips.forEach((clip, k) => { this.clips[from + k] = this.store.clips.get(clip.id); });
    } catch (error) {
      if (query === this.query) this.failure = error.message;
    }
    this.arrived();
  }
}

function clipCard(clip, ctx) {
  return make('button', { class: 'card', type: 'button', 'data-testid': 'clip-row', 'data-clip': clip.id, title: clip.name, click: () => openClip(clip.id, ctx) },
    make('canvas', { class: 'strip', 'aria-hidden': 'true' }),
    make('strong', {}, shortName(clip)),
    make('span', { class: 'bar small muted number' },
      clip.label ? make('span', { class: 'chip' }, clip.label) : null,
      make('span', {}, `${inSeconds((clip.end - clip.start) / clip.rate)} · ${clip.end - clip.start} frames`),
      make('span', { class: 'rig' }, clip.rig ?? 'no rig')));
}

/** A contact sheet. Only the cards in sight exist. */
export function renderLibraryPage(page, ctx) {
  const cards = new Map();
  const space = make('div', { class: 'sheet' });
  const count = make('p', { class: 'muted small', role: 'status' });
  const filter = make('input', { type: 'search', placeholder: 'Filter by name', 'aria-label': 'Filter by name', 'data-testid': 'filter', input: () => again() });
  const label = make('select', { 'aria-label': 'Label', 'data-testid': 'label-filter', change: () => again() },
    make('option', { value: '' }, 'All labels'), ...page.labels.map((name) => make('option', { value: name }, name)));
  const sort = make('select', { 'aria-label': 'Sort by', 'data-testid': 'sort', change: () => again() },
    ...Object.keys(SORTS).map((name) => make('option', { value: name }, `by ${name}`)));
  const down = make('button', { type: 'button', 'aria-pressed': 'false', 'aria-label': 'Descending', title: 'Descending', click: () => {
    down.setAttribute('aria-pressed', down.getAttribute('aria-pressed') !== 'true');
    again();
  } }, '↓');
  const sheet = new Sheet(ctx.store, page, () => layOut());
  let waiting = false;

  function again() {
    sheet.ask({ sort: sort.value, down: +(down.getAttribute('aria-pressed') === 'true'), label: label.value, text: filter.value });
    clear();
    layOut();
  }

  function clear() {
    for (const card of cards.values()) card.remove();
    cards.clear();
  }

  function layOut() {
    if (!space.isConnected) return;
    const { top, width } = space.getBoundingClientRect();
    const columns = Math.max(1, Math.floor(width / CARD_WIDTH));
    const first = Math.max(0, Math.floor(-top / CARD_HEIGHT)) * columns;
    const last = Math.min(sheet.total, Math.ceil((innerHeight - top) / CARD_HEIGHT) * columns);
    for (const [k, card] of cards) {
      if ((k >= first && k < last) || card === document.activeElement) continue;
      card.remove();
      cards.delete(k);
    }
    for (let k = first; k < last; k++) {
      const clip = sheet.at(k);
      if (!clip || cards.has(k)) continue;
      const card = clipCard(clip, ctx);
      cards.set(k, card);
      // Tab and readers go through the cards in their order.
      const next = Math.min(...[...cards.keys()].filter((other) => other > k));
      space.insertBefore(card, cards.get(next) ?? null);
      card.style.width = `calc(${100 / columns}% - 10px)`;
      card.style.left = `${((k % columns) * 100) / columns}%`;
      card.style.top = `${Math.floor(k / columns) * CARD_HEIGHT}px`;
      if (clip.strip) drawStrip(card.firstChild, clip.strip, ctx.store.figures[clip.figure]);
    }
    space.style.height = `${Math.ceil(sheet.total / columns) * CARD_HEIGHT}px`;
    count.textContent = sheet.failure ?? (sheet.total === page.n_clips ? `${page.n_clips} clips` : `${sheet.total} of ${page.n_clips} clips`);
  }

  const soon = () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      layOut();
    });
  };
  let wide = 0;
  new ResizeObserver(([{ contentRect }]) => {
    if (contentRect.width !== wide) clear();
    wide = contentRect.width;
    layOut();
  }).observe(space);
  addEventListener('scroll', soon, { passive: true });
  addEventListener('resize', soon);
  onTheme(() => {
    clear();
    layOut();
  });
  // An empty player invites less than a first clip.
  const greet = () => {
    const clip = sheet.at(0);
    if (clip && !ctx.player.takes.length) ctx.player.show([{ clip: clip.id }]);
  };
  return make('article', { class: 'stack', open: greet },
    make('header', { class: 'panel stack' },
      make('h2', {}, 'Library'),
      make('p', { class: 'muted small path' }, page.path),
      factList([
        { name: 'clips', value: page.n_clips },
        { name: 'length', value: page.seconds < 600 ? inSeconds(page.seconds) : `${(page.seconds / 60).toFixed(1)} min` },
        { name: 'feature set', value: page.set },
        { name: 'words per second', value: page.rate },
      ]),
      page.note ? make('p', { class: 'small' }, page.note) : null,
      make('div', { class: 'bar' }, filter, label, sort, down, count)),
    space);
}

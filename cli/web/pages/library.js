import {make, factList, inSeconds, shortName} from '../store.js';
import {drawStrip, onTheme} from '../strip.js';
import {openClip} from './clip.js';

/** Of a card with its margin, in pixels. */
const CARD_HEIGHT = 150;
const CARD_WIDTH = 270;
/** Clips asked for at once. */
const BLOCK = 40;

const secondsOf = (clip) => (clip.end - clip.start) / clip.rate;
const SORTS = {name: (clip) => clip.name, label: (clip) => clip.label ?? '', seconds: secondsOf};

/** The clips of a library in the order and choice of a query; `at(k)` is undefined until it is known. */
class Sheet {
  /** @param {function(): void} arrived called when more is known */
  constructor(store, n, arrived) {
    Object.assign(this, {store, n, arrived});
  }

  ask(query) {
    Object.assign(this, {query, asked: new Set(), clips: [], total: this.n, failure: null});
    if (this.store.live) return;
    const sign = query.down ? -1 : 1;
    const value = SORTS[query.sort];
    this.clips = [...this.store.clips.values()]
      .filter(({name, label, strip}) => strip && (!query.label || label === query.label) && name.toLowerCase().includes(query.text.toLowerCase()))
      .sort((a, b) => (value(a) < value(b) ? -sign : value(a) > value(b) ? sign : a.id - b.id));
    this.total = this.clips.length;
  }

  at(k) {
    const from = k - (k % BLOCK);
    if (this.store.live && !this.asked.has(from)) {
      this.asked.add(from);
      this.#fetch(from, this.query);
    }
    return this.clips[k];
  }

  async #fetch(from, query) {
    const answer = await this.store.ask('clips', {from, n: BLOCK, ...query}).catch((error) => ({total: 0, failure: error.message}));
    this.store.merge(answer);
    if (query !== this.query) return;
    Object.assign(this, {total: answer.total, failure: answer.failure});
    answer.clips?.forEach(({id}, k) => { this.clips[from + k] = this.store.clips.get(id); });
    this.arrived();
  }
}

function clipCard(clip, ctx) {
  return make('button', {class: 'card', type: 'button', 'data-testid': 'clip-row', 'data-clip': clip.id, title: clip.name, click: () => openClip(clip.id, ctx)},
    make('canvas', {class: 'strip', 'aria-hidden': 'true'}),
    make('strong', {}, shortName(clip)),
    make('span', {class: 'bar small muted number'},
      clip.label && make('span', {class: 'chip'}, clip.label),
      `${inSeconds(secondsOf(clip))} · ${clip.end - clip.start} frames`,
      make('span', {class: 'rig'}, clip.rig ?? 'no rig')));
}

/** A contact sheet. Only the cards in sight exist. */
export function renderLibraryPage(page, ctx) {
  const cards = new Map();
  const space = make('div', {class: 'sheet'});
  const count = make('p', {class: 'muted small', role: 'status'});
  const options = (values, text) => values.map((value) => make('option', {value}, text(value)));
  const filter = make('input', {type: 'search', placeholder: 'Filter by name', 'aria-label': 'Filter by name', 'data-testid': 'filter', input: ask});
  const label = make('select', {'aria-label': 'Label', 'data-testid': 'label-filter', change: ask}, make('option', {value: ''}, 'All labels'), ...options(page.labels, String));
  const sort = make('select', {'aria-label': 'Sort by', 'data-testid': 'sort', change: ask}, ...options(Object.keys(SORTS), (name) => `by ${name}`));
  const down = make('button', {type: 'button', 'aria-pressed': false, 'aria-label': 'Descending', title: 'Descending', click: () => {
    down.ariaPressed = down.ariaPressed !== 'true';
    ask();
  }}, '↓');
  const sheet = new Sheet(ctx.store, page.n_clips, layOut);

  function ask() {
    sheet.ask({sort: sort.value, down: +(down.ariaPressed === 'true'), label: label.value, text: filter.value});
    again();
  }

  function again() {
    cards.clear();
    space.replaceChildren();
    layOut();
  }

  function layOut() {
    if (!space.isConnected) return;
    const {top, width} = space.getBoundingClientRect();
    const columns = Math.max(1, Math.floor(width / CARD_WIDTH));
    const first = Math.max(0, Math.floor(-top / CARD_HEIGHT)) * columns;
    const end = Math.min(sheet.total, Math.ceil((innerHeight - top) / CARD_HEIGHT) * columns);
    for (const [k, card] of cards) {
      if ((k >= first && k < end) || card === document.activeElement) continue;
      card.remove();
      cards.delete(k);
    }
    for (let k = first; k < end; k++) {
      const clip = sheet.at(k);
      if (!clip || cards.has(k)) continue;
      const card = clipCard(clip, ctx);
      // Keys and readers go through the cards in their order.
      space.insertBefore(card, cards.get(Math.min(...[...cards.keys()].filter((other) => other > k))) ?? null);
      cards.set(k, card);
      Object.assign(card.style, {
        width: `calc(${100 / columns}% - 10px)`,
        left: `${((k % columns) * 100) / columns}%`,
        top: `${Math.floor(k / columns) * CARD_HEIGHT}px`,
      });
      if (clip.strip) drawStrip(card.firstChild, clip.strip, ctx.store.figures[clip.figure]);
    }
    space.style.height = `${Math.ceil(sheet.total / columns) * CARD_HEIGHT}px`;
    count.textContent = sheet.failure ?? `${sheet.total === page.n_clips ? '' : `${sheet.total} of `}${page.n_clips} clips`;
    // An empty player invites less than a first clip.
    if (!ctx.player.title.textContent && sheet.clips[0]) ctx.player.show([{clip: sheet.clips[0].id}]);
  }

  let wide = 0;
  new ResizeObserver(([{contentRect}]) => {
    if (contentRect.width === wide) return;
    wide = contentRect.width;
    again();
  }).observe(space);
  addEventListener('scroll', layOut, {passive: true});
  addEventListener('resize', layOut);
  onTheme(again);
  ask();
  return make('article', {class: 'stack'},
    make('header', {class: 'panel stack'},
      make('h2', {}, 'Library'),
      make('p', {class: 'muted small'}, page.path),
      factList([
        {name: 'clips', value: page.n_clips},
        {name: 'length', value: page.seconds < 600 ? inSeconds(page.seconds) : `${(page.seconds / 60).toFixed(1)} min`},
        {name: 'feature set', value: page.set},
        {name: 'words per second', value: page.rate},
      ]),
      page.note && make('p', {class: 'small'}, page.note),
      make('div', {class: 'bar'}, filter, label, sort, down, count)),
    space);
}

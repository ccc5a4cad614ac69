// The result of a search: hits in order, each played beside the example.

import {make, factList, shortName} from '../store.js';
import {picturePlot, short, spanText, follow, playItems} from '../plot.js';

/** Segments of a hit as a bar; a segment's share of it is its share of the hit's frames. */
function segmentBar({start, end, segments}) {
  const bar = make('span', {class: 'segments', 'aria-hidden': 'true'}, ...(segments.length ? segments : [[start, end]]).map(([a, b], k) => {
    const part = make('i', {title: `segment ${k + 1}: frames ${a}–${b}`});
    part.style.left = `${(a - start) / (end - start) * 100}%`;
    part.style.width = `${(b - a) / (end - start) * 100}%`;
    return part;
  }));
  const cursor = make('b', {hidden: true});
  bar.append(cursor);
  bar.setFrame = (frame) => {
    cursor.hidden = !(frame >= start && frame < end);
    cursor.style.left = `${(frame - start) / (end - start) * 100}%`;
  };
  return bar;
}

/** @returns {HTMLElement} */
export function renderSearchPage(page, ctx) {
  const {store, player} = ctx;
  const {example, hits} = page;
  let shown = null;
  let layout = 'side';

  const trouble = make('p', {class: 'error', role: 'status'});
  const overlay = make('button', {type: 'button', 'aria-pressed': 'false', click() {
    layout = layout === 'side' ? 'overlay' : 'side';
    overlay.setAttribute('aria-pressed', String(layout === 'overlay'));
    if (shown) play(shown);
  }}, 'Overlay on the example');

  function play({hit}) {
    const items = [{clip: hit.clip, start: hit.start, end: hit.end}];
    const title = `${hit.rank}. ${shortName(store.clips.get(hit.clip))}`;
    if (!example) return playItems(ctx, items, {title}, trouble);
    items.push({clip: example.clip, start: example.start, end: example.end});
    // From end to end, so that what corresponds is seen at once however long the two take.
    const path = [[hit.start, example.start], [hit.end - 1, example.end - 1]];
    return playItems(ctx, items, {layout, path, title: `${title} and the example`}, trouble);
  }

  /** The one hit that is open has its agreement below it. */
  function choose(entry) {
    if (shown && shown !== entry) {
      shown.button.setAttribute('aria-expanded', 'false');
      shown.more.replaceChildren();
      shown.plot = null;
    }
    if (entry.hit.agreement && !entry.plot) {
      const {rate} = store.clips.get(entry.hit.clip);
      const onSeek = (seconds) => player.seek(seconds);
      entry.plot = picturePlot(entry.hit.agreement, {onSeek, rate, legend: true, label: `Agreement of hit ${entry.hit.rank}`});
      entry.more.replaceChildren(entry.plot);
    }
    entry.button.setAttribute('aria-expanded', 'true');
    shown = entry;
    play(entry);
  }

  const entries = hits.map((hit) => {
    const clip = store.clips.get(hit.clip);
    const bar = segmentBar(hit);
    const more = make('div', {class: 'hit-more'});
    const button = make('button', {
      type: 'button', class: 'hit', 'aria-expanded': 'false', 'data-testid': 'hit', 'data-rank': hit.rank, click: () => choose(entry),
    },
    make('span', {class: 'hit-rank number'}, String(hit.rank)),
    make('span', {class: 'hit-name'}, make('strong', {title: clip.name}, shortName(clip)),
      clip.label && make('span', {class: 'chip'}, clip.label), hit.mirrored ? make('span', {class: 'chip'}, 'mirrored') : null),
    make('span', {class: 'hit-cost number'}, make('small', {}, 'cost '), short(hit.cost)),
    make('span', {class: 'hit-when number muted small'}, spanText(hit)), bar);
    const entry = {hit, button, bar, more, plot: null};
    return entry;
  });

  const list = make('ol', {class: 'hits', 'aria-label': 'Hits', keydown(event) {
    const at = entries.findIndex(({button}) => button === event.target);
    const next = entries[{ArrowUp: at - 1, ArrowDown: at + 1}[event.key]];
    if (at < 0 || !next) return;
    event.preventDefault();
    event.stopPropagation();
    next.button.focus();
    choose(next);
  }}, ...entries.map(({button, more}) => make('li', {}, button, more)));

  follow(ctx, ({clip, frame, seconds}) => {
    if (clip !== shown?.hit.clip) return;
    shown.bar.setFrame(frame);
    shown.plot?.setTime(seconds);
  });

  const listed = hits.length < page.n_hits ? `the first ${hits.length} of ${page.n_hits} hits` : `${page.n_hits} ${page.n_hits === 1 ? 'hit' : 'hits'}`;
  return make('section', {class: 'panel search-page', 'aria-label': page.title},
    make('div', {class: 'bar spread'}, make('h2', {}, page.title), make('span', {class: 'muted number'}, listed)),
    factList(page.query),
    hits.length && example ? make('div', {class: 'bar'}, playExample(ctx, example, trouble), overlay) : null,
    trouble,
    hits.length ? list : make('p', {class: 'empty'}, 'Nothing was found.'));
}

function playExample(ctx, example, trouble) {
  const items = [{clip: example.clip, start: example.start, end: example.end}];
  return make('button', {type: 'button', title: spanText(example), click: () => playItems(ctx, items, {title: 'The example'}, trouble)}, 'Play the example');
}

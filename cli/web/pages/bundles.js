// Motion bundles: a graph of what follows what, whose nodes play, and walks through it.

import {make, factList, inSeconds, shortName} from '../store.js';
import {adoptSvg, short, follow, playItems} from '../plot.js';

/** Submotions that are played at once; more could not be told apart. */
const MOST_PLAYED = 12;

/** @returns {HTMLElement} */
export function renderBundlesPage(page, ctx) {
  const {store, player} = ctx;
  const byId = new Map(page.nodes.map((node) => [node.id, node]));
  const trouble = make('p', {class: 'error', role: 'status'});
  const told = make('p', {class: 'told number', 'aria-live': 'polite'}, 'Choose a bundle to see its submotions together.');
  const graph = adoptSvg(page.svg);
  const drawn = new Map();
  let walk = null;

  const describe = ({id, height, mean_frames, volume, next}) =>
    `${id}: ${height} submotions, ${short(mean_frames)} frames on average, volume ${short(volume)}${next.length ? `, then ${next.join(', ')}` : ', a dead end'}`;

  /** Marks a bundle, its edges and what can follow it. */
  const mark = (id, name) => {
    const next = new Set(byId.get(id)?.next);
    for (const element of graph.querySelectorAll('[data-bundle], [data-from]')) {
      const {bundle, from, to} = element.dataset;
      element.classList.toggle(name, bundle != null && bundle === id);
      element.classList.toggle(`${name}-next`, bundle == null ? from === id || to === id : next.has(bundle));
    }
  };
  const playBundle = (node) => {
    walk = null;
    mark(node.id, 'current');
    const items = node.spans.slice(0, MOST_PLAYED).map(({clip, start, end}) => ({clip, start, end}));
    const some = items.length < node.spans.length ? `, ${items.length} of ${node.spans.length} submotions` : '';
    told.textContent = describe(node);
    return playItems(ctx, items, {layout: 'overlay', title: `Bundle ${node.id}${some}`}, trouble);
  };

  for (const element of graph?.querySelectorAll('[data-bundle]') ?? []) {
    const node = byId.get(element.dataset.bundle);
    if (!node) continue;
    drawn.set(node.id, element);
    for (const [name, value] of Object.entries({tabindex: 0, role: 'button', 'aria-label': describe(node), 'data-testid': 'node'})) {
      element.setAttribute(name, value);
    }
    const look = () => {
      told.textContent = describe(node);
      mark(node.id, 'looked');
    };
    element.addEventListener('pointerenter', look);
    element.addEventListener('focus', look);
    element.addEventListener('pointerleave', () => mark(null, 'looked'));
    element.addEventListener('blur', () => mark(null, 'looked'));
    element.addEventListener('click', () => playBundle(node));
    element.addEventListener('keydown', (event) => {
      if (event.key !== 'Enter' && event.key !== ' ') return;
      event.preventDefault();
      event.stopPropagation();
      playBundle(node);
    });
  }

  const walks = page.walks.map((each) => {
    const clip = store.clips.get(each.clip);
    const steps = each.path.map(({bundle, start_s}) => make('button', {type: 'button', class: 'step number', async click() {
      if (walk !== entry) await playWalk(entry);
      player.seek(start_s);
    }}, bundle, make('small', {}, ` ${inSeconds(start_s)} · ${Math.round(start_s * clip.rate)}`)));
    const entry = {each, steps, at: -1};
    const button = make('button', {type: 'button', 'data-testid': 'walk', click: () => playWalk(entry)}, `▶ ${each.title}`);
    const seconds = (clip.end - clip.start) / clip.rate;
    return make('li', {}, make('div', {class: 'bar'}, button, make('span', {class: 'muted small number'},
      `${shortName(clip)} · ${inSeconds(seconds)} · ${clip.end - clip.start} frames`)), make('div', {class: 'bar steps'}, ...steps));
  });
  function playWalk(entry) {
    walk = entry;
    entry.at = -1;
    return playItems(ctx, [{clip: entry.each.clip}], {title: entry.each.title}, trouble);
  }
  follow(ctx, ({clip, seconds}) => {
    if (clip !== walk?.each.clip) return;
    const {each, steps} = walk;
    const at = each.path.findLastIndex(({start_s}) => start_s <= seconds);
    if (at === walk.at) return;
    steps[walk.at]?.removeAttribute('aria-current');
    steps[at]?.setAttribute('aria-current', 'step');
    walk.at = at;
    const id = each.path[at]?.bundle;
    mark(id, 'current');
    drawn.get(id)?.scrollIntoView({block: 'nearest', inline: 'nearest'});
  });

  const scroll = make('div', {class: 'graph scroll', tabindex: 0, role: 'group', 'aria-label': 'Bundle graph'}, graph ?? make('p', {class: 'empty'}, 'No graph.'));
  let zoom = 0;
  const resize = (by) => {
    zoom = by ? Math.min(8, Math.max(0.1, (zoom || graph.getBoundingClientRect().width / graph.viewBox.baseVal.width) * by)) : 0;
    graph.style.width = zoom ? `${zoom * graph.viewBox.baseVal.width}px` : '';
    scroll.classList.toggle('fits', !zoom);
  };
  if (graph) resize(0);
  const tool = (text, name, by) => make('button', {type: 'button', 'aria-label': name, click: () => resize(by)}, text);
  return make('section', {class: 'panel bundles-page'},
    make('h2', {}, 'Motion bundles'), factList(page.facts),
    make('div', {class: 'bar'}, told, graph && tool('−', 'Smaller', 0.7), graph && tool('+', 'Larger', 1.4), graph && tool('fit', 'Fit the width', 0)),
    trouble, scroll,
    walks.length ? make('h3', {}, 'Walks') : null, make('ul', {class: 'walks'}, ...walks));
}

import {make, factList, inSeconds} from '../store.js';
import {adoptSvg, short, counted, follow} from '../plot.js';

/** More submotions at once could not be told apart. */
const MOST_PLAYED = 12;

const tellBundle = ({id, height, mean_frames, volume, next}) =>
  `${id}: ${counted(height, 'submotion')}, ${short(mean_frames)} frames on average, volume ${short(volume)}, ${next.length ? `then ${next.join(', ')}` : 'a dead end'}`;

/** A graph of what follows what, whose nodes play, and walks through it. */
export function renderBundlesPage(page, ctx) {
  const {store, player} = ctx;
  const byId = new Map(page.nodes.map((node) => [node.id, node]));
  const told = make('p', {class: 'told number', role: 'status'}, 'A bundle plays its submotions together.');
  const graph = adoptSvg(page.svg);
  let walk = null;

  /** Marks a bundle, its edges and what can follow it. */
  function mark(id, name) {
    const next = byId.get(id)?.next ?? [];
    for (const {dataset: {bundle, from, to}, classList} of graph.querySelectorAll('[data-bundle], [data-from]')) {
      classList.toggle(name, bundle === id && id != null);
      classList.toggle(`${name}-next`, next.includes(bundle) || (id != null && (from === id || to === id)));
    }
  }
  function playBundle(node) {
    walk = null;
    mark(node.id, 'current');
    const items = node.spans.slice(0, MOST_PLAYED).map(({clip, start, end}) => ({clip, start, end}));
    player.show(items, {layout: 'overlay', play: true, title: `Bundle ${node.id}: ${items.length} of ${counted(node.spans.length, 'submotion')}`});
  }
  for (const element of graph.querySelectorAll('[data-bundle]')) {
    const node = byId.get(element.dataset.bundle);
    if (!node) continue;
    for (const [name, value] of Object.entries({tabindex: 0, role: 'button', 'aria-label': tellBundle(node), 'data-testid': 'node'})) element.setAttribute(name, value);
    element.onpointerenter = element.onfocus = () => {
      told.textContent = tellBundle(node);
      mark(node.id, 'looked');
    };
    element.onpointerleave = element.onblur = () => mark(null, 'looked');
    element.onclick = () => playBundle(node);
    element.onkeydown = (event) => {
      if (event.key !== 'Enter' && event.key !== ' ') return;
      event.preventDefault();
      playBundle(node);
    };
  }

  const walks = page.walks.map(({title, clip: id, path}) => {
    const clip = store.clips.get(id);
    const frames = clip.end - clip.start;
    const entry = {id, path, at: -1, steps: path.map(({bundle, start_s}) => make('button', {type: 'button', class: 'number', click: () => start(start_s)},
      bundle, make('small', {}, ` ${inSeconds(start_s)} · ${Math.round(start_s * clip.rate)}`)))};
    async function start(seconds) {
      if (walk !== entry) {
        walk = entry;
        await player.show([{clip: id}], {title, play: true});
      }
      player.seek(seconds);
      player.play();
    }
    return make('li', {class: 'stack'}, make('div', {class: 'bar'}, make('button', {type: 'button', class: 'primary', 'data-testid': 'walk', click: () => start(0)}, `▶ ${title}`),
      make('span', {class: 'muted small number'}, `${inSeconds(frames / clip.rate)} · ${frames} frames`)), make('div', {class: 'bar steps'}, ...entry.steps));
  });
  follow(ctx, ({clip, seconds}) => {
    if (clip !== walk?.id) return;
    const {path, steps} = walk;
    const at = path.findLastIndex(({start_s}) => start_s <= seconds);
    if (at === walk.at) return;
    steps[walk.at]?.removeAttribute('aria-current');
    steps[at]?.setAttribute('aria-current', 'step');
    walk.at = at;
    mark(path[at]?.bundle, 'current');
    graph.querySelector('.current')?.scrollIntoView({block: 'nearest', inline: 'nearest'});
  });

  const fit = make('button', {type: 'button', 'aria-pressed': true, click: () => { fit.ariaPressed = graph.classList.toggle('fits'); }}, 'Fit the width');
  graph.classList.add('fits');
  return make('section', {class: 'panel stack'},
    make('h2', {}, 'Motion bundles'), factList(page.facts), make('div', {class: 'bar'}, told, fit), make('div', {class: 'graph'}, graph),
    walks.length ? make('h3', {}, 'Walks') : null, make('ul', {class: 'hits'}, ...walks));
}

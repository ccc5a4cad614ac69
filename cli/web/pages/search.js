import {make, factList, shortName} from '../store.js';
import {picturePlot, short, spanText, counted, follow} from '../plot.js';

/** Segments as a bar, each as long as its share of the frames. */
function segmentBar({start, end, segments}) {
  const share = (frames) => `${(frames / Math.max(1, end - start)) * 100}%`;
  const cursor = make('b', {hidden: true});
  const bar = make('span', {class: 'segments', 'aria-hidden': 'true'}, ...(segments.length ? segments : [[start, end]]).map(([a, b]) => {
    const part = make('i', {title: `frames ${a}–${b}`});
    part.style.left = share(a - start);
    part.style.width = share(b - a);
    return part;
  }), cursor);
  bar.setFrame = (frame) => {
    cursor.hidden = !(frame >= start && frame < end);
    cursor.style.left = share(frame - start);
  };
  return bar;
}

/** Hits in order; the chosen one plays beside the example and shows where it agrees. */
export function renderSearchPage(page, ctx) {
  const {store, player} = ctx;
  const {example, hits} = page;
  let chosen = null;

  function choose(entry) {
    const {hit} = entry;
    const clip = store.clips.get(hit.clip);
    if (chosen) {
      chosen.button.setAttribute('aria-expanded', false);
      chosen.more.replaceChildren();
      chosen.bar.setFrame(-1);
    }
    chosen = entry;
    entry.button.setAttribute('aria-expanded', true);
    if (hit.agreement) {
      entry.plot = picturePlot(hit.agreement, {onSeek: (seconds) => player.seek(seconds), rate: clip.rate, label: `Hit ${hit.rank}`});
      entry.more.append(entry.plot);
    }
    const {start, end} = hit;
    const items = [{clip: hit.clip, start, end}];
    const options = {title: `${hit.rank}. ${shortName(clip)}`, play: true};
    if (example) {
      items.push({clip: example.clip, start: example.start, end: example.end});
      // From end to end, so that what corresponds is seen at once however long the two take.
      Object.assign(options, {layout: 'side', path: [[start, example.start], [end - 1, example.end - 1]], title: `${options.title} and the example`});
    }
    player.show(items, options);
  }

  const entries = hits.map((hit) => {
    const clip = store.clips.get(hit.clip);
    const bar = segmentBar(hit);
    const more = make('div', {class: 'hit-more'});
    const chips = [clip.label, hit.mirrored ? 'mirrored' : null].map((text) => text && make('span', {class: 'chip'}, text));
    const button = make('button', {type: 'button', class: 'hit number', 'aria-expanded': false, 'data-testid': 'hit', 'data-rank': hit.rank, click: () => choose(entry)},
      make('span', {class: 'muted'}, String(hit.rank)),
      make('span', {class: 'bar'}, make('strong', {title: clip.name}, shortName(clip)), ...chips),
      make('span', {}, make('small', {class: 'muted'}, 'cost '), short(hit.cost)),
      make('span', {class: 'muted small'}, spanText(hit)), bar);
    const entry = {hit, button, bar, more, plot: null};
    return entry;
  });
  const keydown = (event) => {
    const next = entries[entries.findIndex(({button}) => button === event.target) + {ArrowUp: -1, ArrowDown: 1}[event.key]];
    if (!next || event.target.className !== next.button.className) return;
    event.preventDefault();
    next.button.focus();
    choose(next);
  };
  follow(ctx, ({clip, frame, seconds}) => {
    if (clip !== chosen?.hit.clip) return;
    chosen.bar.setFrame(frame);
    chosen.plot?.setTime(seconds);
  });
  const all = counted(page.n_hits, 'hit');
  return make('section', {class: 'panel stack found'},
    make('h2', {}, page.title),
    factList(page.query),
    make('p', {class: 'muted small', role: 'status'}, hits.length < page.n_hits ? `The first ${hits.length} of ${all}` : all),
    hits.length ? make('ol', {class: 'hits', keydown}, ...entries.map(({button, more}) => make('li', {}, button, more))) : make('p', {class: 'empty'}, 'Nothing was found.'));
}

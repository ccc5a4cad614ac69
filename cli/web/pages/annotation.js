// A clip with labelled spans: a track per label over playback, and the curve that each label was read off.

import {make, factList, shortName, inSeconds} from '../store.js';
import {picturePlot, short, spanText, follow, playItems} from '../plot.js';
import {Timeline, toneClass} from '../timeline.js';

/** @returns {HTMLElement} */
export function renderAnnotationPage(page, ctx) {
  const {store, player} = ctx;
  const clip = store.clips.get(page.clip);
  const trouble = make('p', {class: 'error', role: 'status'});
  // A span alone, or the whole clip: `null` until either was shown.
  let shown = null;

  const show = (span) => {
    shown = span;
    return playItems(ctx, [{clip: clip.id, start: span.start, end: span.end}], {title: span.title}, trouble);
  };
  /** What is outside the part shown is seen by showing the whole. */
  const seek = async (seconds) => {
    const frame = Math.round(seconds * clip.rate);
    if (!shown || frame < shown.start || frame >= shown.end) {
      await show({start: clip.start, end: clip.end, title: shortName(clip)});
      player.pause();
    }
    player.seek(seconds);
  };

  const tracks = page.tracks.map(({label, spans}) => ({
    label,
    spans: spans.map((span) => ({...span, title: `${label} ${spanText(span)} · cost ${short(span.cost)}`})),
  }));
  const timeline = new Timeline({rate: clip.rate, start: clip.start, end: clip.end, label: 'Time in the clip', tracks});
  timeline.addEventListener('seek', ({detail}) => seek(detail.seconds));
  timeline.addEventListener('pick', ({detail}) => show(detail));

  const plots = [];
  const curves = page.tracks.map(({label, tau, spans, curve}, number) => {
    const summary = make('summary', {}, make('i', {class: `swatch ${toneClass(number)}`}), label,
      make('span', {class: 'muted small number'}, `${tau == null ? '' : `τ ${short(tau)} · `}${spans.length} ${spans.length === 1 ? 'span' : 'spans'}`));
    if (!curve) return make('div', {class: 'fold'}, summary.firstChild, label);
    const details = make('details', {class: 'fold', toggle() {
      // Drawn when it is looked at: a clip can have a hundred labels.
      if (details.open && details.childElementCount === 1) {
        const plot = picturePlot(curve, {onSeek: seek, rate: clip.rate, label: `Δ of ${label}`});
        plot.setTime(timeline.frame / clip.rate);
        plots.push(plot);
        details.append(plot);
      }
    }}, summary);
    details.open = number === 0;
    return details;
  });

  follow(ctx, (time) => {
    if (time.clip !== clip.id) return;
    timeline.setTime(time.seconds);
    for (const plot of plots) plot.setTime(time.seconds);
  });

  return make('section', {class: 'panel annotation-page'},
    make('h2', {}, shortName(clip)),
    factList([
      {name: 'length', value: `${inSeconds((clip.end - clip.start) / clip.rate)} · ${clip.end - clip.start} frames`},
      {name: 'labels', value: String(page.tracks.length)},
      {name: 'spans', value: String(page.tracks.reduce((sum, {spans}) => sum + spans.length, 0))},
    ]),
    make('div', {class: 'bar'}, make('button', {type: 'button', class: 'primary', click: () => show({start: clip.start, end: clip.end, title: shortName(clip)})}, 'Play the clip')),
    trouble, timeline.element, ...curves);
}

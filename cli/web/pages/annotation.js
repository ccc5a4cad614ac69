import {make, factList, shortName, inSeconds} from '../store.js';
import {picturePlot, short, spanText, counted, follow} from '../plot.js';
import {Timeline, toneOf} from '../timeline.js';

/** A track per label over playback, and the curve that each label was read off. */
export function renderAnnotationPage(page, ctx) {
  const {store, player} = ctx;
  const clip = store.clips.get(page.clip);
  const {rate, start, end} = clip;
  const plots = [];
  let shown = {start, end};

  const show = (span) => {
    shown = span;
    return player.show([{clip: clip.id, start: span.start, end: span.end}], {title: span.title, play: true});
  };
  const seek = async (seconds) => {
    // What the span that plays lacks is seen in the whole.
    if (seconds * rate < shown.start || seconds * rate >= shown.end) {
      await show({start, end});
      player.pause();
    }
    player.seek(seconds);
  };

  const tracks = page.tracks.map(({label, spans}) => ({
    label, spans: spans.map((span) => ({...span, title: `${label} · ${spanText(span)} · cost ${short(span.cost)}`})),
  }));
  const timeline = new Timeline({clip, label: 'Time in the clip', tracks});
  timeline.addEventListener('seek', ({detail}) => seek(detail.seconds));
  timeline.addEventListener('pick', ({detail}) => show(detail));

  const curves = page.tracks.map(({label, tau, spans, curve}, k) => {
    if (!curve) return null;
    // Drawn when it is looked at: there may be a hundred labels.
    const toggle = ({target}) => {
      if (!target.open || target.children[1]) return;
      const plot = picturePlot(curve, {onSeek: seek, rate, label: `Δ of ${label}`});
      plot.setTime(timeline.frame / rate);
      plots.push(plot);
      target.append(plot);
    };
    return make('details', {class: 'fold', open: k === 0, toggle}, make('summary', {}, make('i', {class: `swatch ${toneOf(k)}`}), label,
      make('span', {class: 'muted small number'}, ` ${tau == null ? '' : `τ ${short(tau)} · `}${counted(spans.length, 'span')}`)));
  });
  follow(ctx, (time) => {
    if (time.clip === clip.id) for (const each of [timeline, ...plots]) each.setTime(time.seconds);
  });
  return make('section', {class: 'panel stack'},
    make('h2', {}, shortName(clip)),
    factList([
      {name: 'length', value: `${inSeconds((end - start) / rate)} · ${end - start} frames`},
      {name: 'labels', value: page.tracks.length},
      {name: 'spans', value: page.tracks.reduce((sum, {spans}) => sum + spans.length, 0)},
    ]),
    timeline.element, ...curves);
}

import {make, factList, inSeconds, shortName} from '../store.js';
import {drawStrip, onTheme} from '../strip.js';
import {picturePlot} from '../plot.js';

/** A clip in words. */
export function clipFacts(clip) {
  const frames = clip.end - clip.start;
  return [
    ['label', clip.label],
    ['length', inSeconds(frames / clip.rate)],
    ['frames', clip.start ? `${clip.start} to ${clip.end - 1} (${frames})` : frames],
    ['frames per second', +clip.rate.toFixed(3)],
    ['rig', clip.rig],
  ].flatMap(([name, value]) => (value == null ? [] : [{ name, value }]));
}

/** A clip's strip that follows its width and the theme. */
export function stripOf(clip, store) {
  const canvas = make('canvas', { class: 'strip', role: 'img', 'aria-label': `Poses of ${shortName(clip)}` });
  const draw = () => clip.strip && canvas.clientWidth && drawStrip(canvas, clip.strip, store.figures[clip.figure]);
  new ResizeObserver(draw).observe(canvas);
  onTheme(draw);
  return canvas;
}

/** Plots that seek in a clip and show where its playback is. */
export function plotsOf(clip, pictures, ctx) {
  const plots = pictures.filter(([, picture]) => picture).map(([label, picture]) => [label, picturePlot(picture, { label, onSeek: (seconds) => ctx.player.seek(seconds) })]);
  ctx.player.addEventListener('time', ({ detail }) => {
    if (detail.clip === clip) plots.forEach(([, plot]) => plot.setTime(detail.seconds));
  });
  return plots.map(([label, plot]) => make('section', { class: 'panel' }, make('h3', {}, label), plot));
}

/** Plays a clip and goes to its page. */
export async function openClip(id, ctx) {
  const { store, player } = ctx;
  let page = store.pages.find(({ kind, clip }) => kind === 'clip' && clip === id);
  if (!page && ctx.live) page = store.merge(await store.ask(`clips/${id}`)).find(({ kind }) => kind === 'clip');
  ctx.open(page ?? { kind: 'clip', clip: id, features: null });
  player.show([{ clip: id }], { play: true });
}

export function renderClipPage(page, ctx) {
  const clip = ctx.store.clips.get(page.clip);
  const host = make('article', { class: 'stack', open: () => ctx.player.show([{ clip: clip.id }]) },
    make('header', { class: 'panel stack' },
      make('h2', {}, shortName(clip)),
      make('p', { class: 'muted small path' }, clip.name),
      clip.strip ? stripOf(clip, ctx.store) : null,
      factList(clipFacts(clip))),
    ...plotsOf(clip.id, [['Features', page.features]], ctx));
  return host;
}

import {make, bytesOf, inSeconds} from './store.js';

/** A row of cells is at least this high, in pixels, so that its name can be read. */
const ROW_HEIGHT = 14;

/** Three significant digits, no trailing zeros. */
export const short = (value) => (value == null ? '–' : String(+value.toPrecision(3)));

/** Such as `1.25–2.60 s · frames 150–312`. */
export const spanText = ({start, end, start_s, end_s}) => `${start_s.toFixed(2)}–${inSeconds(end_s)} · frames ${start}–${end}`;

/** Such as `1 hit`, `2 hits`. */
export const counted = (n, name) => `${n} ${name}${n === 1 ? '' : 's'}`;

const clampTo = (value, from, to) => Math.min(to, Math.max(from, value));
const percent = (share) => `${share * 100}%`;

/** The root of an SVG text as an element of this page. */
export function adoptSvg(text) {
  return document.importNode(new DOMParser().parseFromString(text, 'image/svg+xml').documentElement, true);
}

/** Where a key leads, or null if nowhere: the arrows, ten steps with shift or by page, Home, End. The key is used up then. */
export function stepped(event, at, step, from, to, tenfold = event.shiftKey) {
  const size = tenfold || event.key.startsWith('Page') ? 10 * step : step;
  const target = {ArrowLeft: at - size, ArrowRight: at + size, PageUp: at - size, PageDown: at + size, Home: from, End: to}[event.key];
  if (target === undefined) return null;
  event.preventDefault();
  return clampTo(target, from, to);
}

/** What the colours mean: they are read off the picture, so that they agree with whatever drew it. */
async function fillLegend(host, img, {area: [left, top, right, bottom], values: {rows, columns, meanings, unit}}, codes) {
  await img.decode();
  const pen = make('canvas', {width: img.naturalWidth, height: img.naturalHeight}).getContext('2d', {willReadFrequently: true});
  pen.drawImage(img, 0, 0);
  const known = [...new Set(codes)].sort((a, b) => a - b);
  for (const code of meanings.length ? known : new Set([known[0], known[known.length >> 1], known.at(-1)])) {
    const at = codes.indexOf(code);
    const x = left + ((right - left) * ((at % columns) + 0.5)) / columns;
    const y = top + ((bottom - top) * (Math.floor(at / columns) + 0.5)) / rows.length;
    const swatch = make('i', {class: 'swatch'});
    swatch.style.background = `rgb(${pen.getImageData(x, y, 1, 1).data.slice(0, 3)})`;
    host.append(make('span', {}, swatch, meanings[code] ?? short(code * unit)));
  }
}

/**
 * A picture that is as wide as its place: a pointer or the arrows read values off it, a click or a drag seeks. Cells are
 * shown without the picture's own margins, whose letters would be scaled with it; their names and times stand beside.
 * @param {object} picture as `document.rs`
 * @param {{onSeek?: function(number): void, label?: string, rate?: number}} options `rate` adds frames to seconds
 * @returns {HTMLElement & {setTime: function(number): void}}
 */
export function picturePlot(picture, {onSeek, label, rate} = {}) {
  const {width, height, area: [left, top, right, bottom], seconds: [from, to], values} = picture;
  const codes = values.codes && bytesOf(values.codes);
  const names = values.rows ?? [values.name];
  const columns = Math.max(1, values.columns ?? values.y.length);
  const step = (to - from) / columns;
  let time = from;
  let row = 0;

  const img = picture.image.startsWith('<svg') ? adoptSvg(picture.image) : make('img', {src: picture.image, alt: '', draggable: 'false'});
  const cursor = make('i', {class: 'plot-cursor'});
  const hover = make('i', {class: 'plot-cursor plot-hover', hidden: true});
  const data = make('div', {class: 'plot-data'}, cursor, hover);
  const face = make('div', {class: 'plot-face', tabindex: 0, role: 'slider', 'aria-label': label, 'aria-valuemin': from, 'aria-valuemax': to, keydown, pointerdown: point, pointermove: point, pointerleave}, img, data);
  const readout = make('figcaption', {class: 'number'});
  const figure = make('figure', {class: 'plot', 'data-testid': 'plot'}, face, readout);
  if (codes) {
    const [w, h] = [right - left, bottom - top];
    Object.assign(img.style, {width: percent(width / w), height: percent(height / h), left: percent(-left / w), top: percent(-top / h)});
    face.style.height = `${names.length * ROW_HEIGHT}px`;
    const ticks = [0, 0.25, 0.5, 0.75, 1].map((share) => make('span', {}, inSeconds(from + share * (to - from))));
    const legend = make('div', {class: 'legend'});
    figure.classList.add('cells');
    figure.prepend(make('div', {class: 'plot-rows', 'aria-hidden': 'true'}, ...names.map((name) => make('span', {title: name}, name))));
    face.after(make('div', {class: 'plot-ticks', 'aria-hidden': 'true'}, ...ticks));
    figure.append(legend);
    if (codes.length) fillLegend(legend, img, picture, codes).catch(() => legend.remove());
  } else {
    Object.assign(data.style, {left: percent(left / width), right: percent(1 - right / width), top: percent(top / height), bottom: percent(1 - bottom / height)});
  }

  const place = (line, at) => {
    line.hidden = !(at >= from && at <= to);
    line.style.left = percent((at - from) / (to - from || 1));
  };
  function read(at) {
    const column = clampTo(Math.floor((at - from) / (step || 1)), 0, columns - 1);
    const code = codes?.[row * columns + column];
    const value = codes ? values.meanings[code] ?? short(code * values.unit) : short(values.y[column]);
    readout.textContent = [inSeconds(at), rate && `frame ${Math.round(at * rate)}`, `${names[row]}: ${value}`].filter(Boolean).join(' · ');
    face.setAttribute('aria-valuenow', at.toFixed(3));
    face.setAttribute('aria-valuetext', readout.textContent);
  }
  function go(at) {
    figure.setTime(at);
    onSeek?.(at);
  }
  function point(event) {
    if (event.type === 'pointerdown') face.setPointerCapture(event.pointerId);
    const box = data.getBoundingClientRect();
    const at = from + (to - from) * clampTo((event.clientX - box.left) / box.width, 0, 1);
    row = clampTo(Math.floor(((event.clientY - box.top) / box.height) * names.length), 0, names.length - 1);
    place(hover, at);
    read(at);
    if (event.buttons) go(at);
  }
  function pointerleave() {
    hover.hidden = true;
    read(time);
  }
  function keydown(event) {
    const at = stepped(event, clampTo(time, from, to), step, from, to);
    if (at != null) return go(at);
    const by = {ArrowUp: -1, ArrowDown: 1}[event.key];
    if (!by || !names[1]) return;
    event.preventDefault();
    row = clampTo(row + by, 0, names.length - 1);
    read(time);
  }
  figure.setTime = (at) => {
    time = at;
    place(cursor, at);
    if (hover.hidden) read(at);
  };
  figure.setTime(from);
  return figure;
}

/** Calls `update` with the player's times, until the page is replaced. */
export function follow({player, signal}, update) {
  player.addEventListener('time', ({detail}) => update(detail), {signal});
}

// Pictures over time that values can be read off.

import {make, bytesOf, inSeconds} from './store.js';

/** A number as people read it: three significant digits, no trailing zeros. */
export function short(value) {
  return value == null ? '–' : String(Number(value.toPrecision(3)));
}

/** Both units of a span, as everything here has them: `1.25–2.60 s · frames 150–312`. */
export function spanText({start, end, start_s, end_s}) {
  return `${start_s.toFixed(2)}–${inSeconds(end_s)} · frames ${start}–${end}`;
}

/** The root of an SVG text as an element of this page; null if it is none. */
export function adoptSvg(text) {
  const root = new DOMParser().parseFromString(text, 'image/svg+xml').documentElement;
  if (root.localName !== 'svg') return null;
  // Without a viewBox a picture is cut instead of scaled.
  const [width, height] = ['width', 'height'].map((side) => parseFloat(root.getAttribute(side)));
  if (!root.hasAttribute('viewBox') && width && height) root.setAttribute('viewBox', `0 0 ${width} ${height}`);
  return document.importNode(root, true);
}

/** Where a seek or a step leads, or null if the key is none: the arrows, with shift or by page ten at once, Home, End. */
export function steppedBy(event, at, step, from, to) {
  const size = step * (event.key.startsWith('Page') || event.shiftKey ? 10 : 1);
  const target = {ArrowLeft: at - size, ArrowRight: at + size, PageUp: at - size, PageDown: at + size, Home: from, End: to};
  return event.key in target ? Math.min(to, Math.max(from, target[event.key])) : null;
}

function imageAddress({image}) {
  return image.startsWith('<svg') ? `data:image/svg+xml,${encodeURIComponent(image)}` : image;
}

/** What the colours mean, read off the picture itself, so that it agrees with whatever drew it. */
async function fillLegend(host, picture, codes) {
  const {area: [left, top, right, bottom], values: {rows, columns, meanings, unit}} = picture;
  const known = [...new Set(codes)].sort((a, b) => a - b);
  const ends = [known[0], known[known.length >> 1], known.at(-1)];
  const image = new Image();
  image.src = imageAddress(picture);
  await image.decode();
  const pen = make('canvas', {width: picture.width, height: picture.height}).getContext('2d', {willReadFrequently: true});
  pen.drawImage(image, 0, 0, picture.width, picture.height);
  for (const code of meanings.length ? known : new Set(ends)) {
    const place = codes.indexOf(code);
    const x = left + (right - left) * (place % columns + 0.5) / columns;
    const y = top + (bottom - top) * (Math.floor(place / columns) + 0.5) / rows.length;
    const swatch = make('i', {class: 'swatch'});
    swatch.style.background = `rgb(${pen.getImageData(x, y, 1, 1).data.slice(0, 3)})`;
    host.append(make('span', {}, swatch, meanings.length ? meanings[code] ?? String(code) : short(code * unit)));
  }
}

/**
 * A picture that is as wide as its place: a pointer or the arrow keys read values off it, a click or a drag seeks.
 * @param {Picture} picture
 * @param {{onSeek?: (seconds: number) => void, label?: string, rate?: number, legend?: boolean}} [options] `rate`, the
 *   source's frames per second, adds frame numbers
 * @returns {HTMLElement & {setTime(seconds: number): void}}
 */
export function picturePlot(picture, {onSeek, label = 'Picture', rate, legend} = {}) {
  const {width, height, area: [left, top, right, bottom], seconds: [from, to], values} = picture;
  const codes = values.of === 'cells' ? bytesOf(values.codes) : null;
  const columns = Math.max(1, codes ? values.columns : values.y.length);
  const n_rows = codes ? Math.max(1, values.rows.length) : 1;
  const step = (to - from) / columns;
  let time = from;
  let row = 0;

  const drawing = picture.image.startsWith('<svg') ? adoptSvg(picture.image)
    : make('img', {src: picture.image, alt: '', draggable: 'false'});
  const [cursor, hover] = ['plot-cursor', 'plot-hover'].map((name) => make('i', {class: name, hidden: true}));
  const face = make('div', {
    class: 'plot-face', tabindex: 0, role: 'slider', 'aria-label': label, 'aria-valuemin': from, 'aria-valuemax': to,
  }, drawing, cursor, hover);
  const readout = make('span', {class: 'plot-value'});
  const caption = make('figcaption', {}, readout);
  const figure = make('figure', {class: 'plot', 'data-testid': 'plot'}, face, caption);
  if (legend && codes?.length) {
    const list = make('span', {class: 'legend'});
    caption.append(list);
    fillLegend(list, picture, codes).catch(() => list.remove());
  }
  if (codes && left === 0) {
    // The picture has no margin with captions of its own.
    face.append(make('div', {class: 'plot-rows', 'aria-hidden': 'true'}, ...values.rows.map((name) => make('span', {}, name))));
  }
  face.style.aspectRatio = `${width} / ${height}`;
  for (const line of [cursor, hover]) {
    line.style.top = `${top / height * 100}%`;
    line.style.height = `${(bottom - top) / height * 100}%`;
  }

  const place = (line, at) => {
    line.hidden = !(at >= from && at <= to);
    line.style.left = `${(left + (right - left) * (at - from) / (to - from || 1)) / width * 100}%`;
  };
  const read = (at) => {
    const column = Math.min(columns - 1, Math.max(0, Math.floor((at - from) / (step || 1))));
    const code = codes?.[row * columns + column];
    const what = !codes ? `${values.name} ${short(values.y[column])}`
      : `${values.rows[row]}: ${values.meanings[code] ?? short(code == null ? null : code * (values.unit ?? 1))}`;
    const text = [inSeconds(at), rate && `frame ${Math.round(at * rate)}`, what].filter(Boolean).join(' · ');
    readout.textContent = text;
    face.setAttribute('aria-valuenow', at.toFixed(3));
    face.setAttribute('aria-valuetext', text);
  };
  const go = (at) => {
    figure.setTime(at);
    onSeek?.(at);
  };
  const point = (event) => {
    const box = face.getBoundingClientRect();
    const across = ((event.clientX - box.left) / box.width * width - left) / (right - left);
    const down = ((event.clientY - box.top) / box.height * height - top) / (bottom - top);
    row = Math.min(n_rows - 1, Math.max(0, Math.floor(down * n_rows)));
    const at = from + (to - from) * Math.min(1, Math.max(0, across));
    place(hover, at);
    read(at);
    if (event.buttons) go(at);
  };
  face.onpointerdown = (event) => {
    face.setPointerCapture(event.pointerId);
    point(event);
  };
  face.onpointermove = point;
  face.onpointerleave = () => {
    hover.hidden = true;
    read(time);
  };
  face.onkeydown = (event) => {
    const at = steppedBy(event, Math.min(to, Math.max(from, time)), step, from, to);
    const rows = {ArrowUp: -1, ArrowDown: 1}[event.key];
    if (at == null && !(rows && codes)) return;
    // The player has the same keys for the whole page.
    event.stopPropagation();
    event.preventDefault();
    if (rows) row = Math.min(n_rows - 1, Math.max(0, row + rows));
    if (at == null) read(time);
    else go(at);
  };
  figure.setTime = (at) => {
    time = at;
    place(cursor, at);
    if (hover.hidden) read(at);
  };
  figure.setTime(from);
  return figure;
}

/** Calls `update` with each time of the player, as long as the page stands. */
export function follow({player, signal}, update) {
  player.addEventListener('time', ({detail}) => update(detail), {signal});
}

/** Shows and plays; what went wrong stands in `host`. */
export async function playItems({player}, items, options, host) {
  try {
    host.textContent = '';
    await player.show(items, options);
    player.play();
  } catch (error) {
    host.textContent = error.message;
  }
}

import {bytesOf, clamp, inSeconds, make, moment} from './store.js';

/** Pixels, so that the name of a row can be read. */
const ROW_HEIGHT = 14;
/** Among codes that are numbers: what is not known. */
const UNKNOWN = 255;

/** Three significant digits, no trailing zeros. */
export const short = (value) => (value == null ? '–' : String(+value.toPrecision(3)));

/** Such as `1.25–2.60 s · frames 150–312`. */
export const spanText = ({start, end}, {rate}) => `${(start / rate).toFixed(2)}–${inSeconds(end / rate)} · frames ${start}–${end}`;

/** Such as `1 hit`, `2 hits`. */
export const counted = (n, name) => `${n} ${name}${n === 1 ? '' : 's'}`;

export const percent = (share) => `${share * 100}%`;

/** The root of an SVG text as an element of this page. */
export const adoptSvg = (text) => document.importNode(new DOMParser().parseFromString(text, 'image/svg+xml').documentElement, true);

/** Lays an element over its parent, between two shares of its width and two of its height. */
export function lay(element, left, right, top = 0, bottom = 1) {
	Object.assign(element.style, {left: percent(left), width: percent(right - left), top: percent(top), height: percent(bottom - top)});
	return element;
}

/** Where in an element a pointer is, as shares of its width and its height. */
export function pointed({clientX, clientY}, element) {
	const {left, top, width, height} = element.getBoundingClientRect();
	return [clamp((clientX - left) / width, 0, 1), clamp((clientY - top) / height, 0, 1)];
}

/** Where a key leads: the arrows, ten steps by page, Home, End; the key is used up then. Undefined for another key. */
export function stepped(event, at, step, from, to) {
	const target = {ArrowLeft: at - step, ArrowRight: at + step, PageUp: at - 10 * step, PageDown: at + 10 * step, Home: from, End: to}[event.key];
	if (target === undefined) return target;
	event.preventDefault();
	return clamp(target, from, to);
}

/** Four times, each at its place. */
export function timeTicks(from, to, rate) {
	return make('div.ticks', {'aria-hidden': true}, ...[0, 0.25, 0.5, 0.75].map((share) => {
		const at = from + share * (to - from);
		return make('span', inSeconds(at), rate && make('small', ` · ${Math.round(at * rate)}`));
	}));
}

/**
 * A picture over time: a pointer or the arrows read values off it, a click or a drag seeks. A matrix is shown without the
 * picture's own margins, whose letters would be scaled with it; its names and times stand beside.
 * @param {object} picture as `document.rs`
 * @param {{onSeek?: function(number): void, label?: string, rate?: number}} options `rate` adds frames to seconds
 * @returns {HTMLElement & {setTime: function(number): void}}
 */
export function picturePlot(picture, {onSeek, label, rate}) {
	const {image, width, height, area: [left, top, right, bottom], seconds: [from, to], values} = picture;
	const codes = values.codes && bytesOf(values.codes);
	const names = values.rows ?? [values.name];
	const columns = Math.max(1, values.columns ?? values.y.length);
	const step = (to - from) / columns || 1;
	let time = from;
	let row = 0;

	const drawn = codes ? make('img', {src: image, alt: '', draggable: 'false'}) : adoptSvg(image);
	const cursor = make('i.cursor');
	const hover = make('i.cursor.hover', {hidden: true});
	const data = make('div.plot-data', cursor, hover);
	const face = make('div.face', {tabindex: 0, role: 'slider', label, 'aria-valuemin': from, 'aria-valuemax': to, keydown, pointerdown: point, pointermove: point, pointerleave}, drawn, data);
	const readout = make('figcaption');
	const figure = make('figure.plot', {testid: 'plot'}, face, readout);
	if (codes) {
		const [w, h] = [right - left, bottom - top];
		lay(drawn, -left / w, (width - left) / w, -top / h, (height - top) / h);
		face.style.height = `${names.length * ROW_HEIGHT}px`;
		face.after(timeTicks(from, to));
		figure.prepend(make('div.plot-rows', {'aria-hidden': true}, ...names.map((name) => make('span', {title: name}, name))));
		figure.classList.add('cells');
	} else {
		lay(data, left / width, right / width, top / height, bottom / height);
	}

	function place(line, at) {
		const share = (at - from) / (to - from || 1);
		line.hidden = !(share >= 0 && share <= 1);
		lay(line, share, share);
	}
	function valueAt(at) {
		const column = clamp(Math.floor((at - from) / step), 0, columns - 1);
		if (!codes) return short(values.y[column]);
		const code = codes[row * columns + column];
		return values.meanings[code] ?? (code === UNKNOWN ? 'unknown' : short(code * values.unit));
	}
	function read(at) {
		readout.textContent = `${moment(at, rate)} · ${names[row]}: ${valueAt(at)}`;
		face.ariaValueNow = at.toFixed(3);
		face.ariaValueText = readout.textContent;
	}
	function go(at) {
		figure.setTime(at);
		onSeek?.(at);
	}
	function point(event) {
		const [x, y] = pointed(event, data);
		const at = from + x * (to - from);
		row = Math.min(names.length - 1, Math.floor(y * names.length));
		place(hover, at);
		read(at);
		if (event.buttons) go(at);
	}
	function pointerleave() {
		hover.hidden = true;
		read(time);
	}
	function keydown(event) {
		const at = stepped(event, clamp(time, from, to), step, from, to);
		if (at !== undefined) return go(at);
		const by = {ArrowUp: -1, ArrowDown: 1}[event.key];
		if (!by || !names[1]) return;
		event.preventDefault();
		row = clamp(row + by, 0, names.length - 1);
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

/** Calls `update` with the player's times, from now until the page is replaced. */
export function follow({player, signal}, update) {
	if (player.now) update(player.now);
	player.addEventListener('time', ({detail}) => update(detail), {signal});
}

/** Goes to a time of a clip; what plays gives way to the whole clip if it lacks that time. */
export async function seekIn(player, clip, seconds) {
	const [take] = player.takes;
	const frame = Math.round(seconds * clip.rate);
	if (take?.clip.id !== clip.id || frame < take.start || frame > take.end) await player.show([{clip: clip.id}]);
	player.seekFrame(seconds * clip.rate);
}

/** A picture of a clip, with where its playback is. */
export function playedPlot(picture, clip, label, ctx) {
	const plot = picturePlot(picture, {label, rate: clip.rate, onSeek: (seconds) => seekIn(ctx.player, clip, seconds)});
	follow(ctx, ({clip: id, seconds}) => id === clip.id && plot.setTime(seconds));
	return plot;
}

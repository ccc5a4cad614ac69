/**
 * Shapes and units: `document.rs`.
 * @typedef {{points: string[], bones: {from: number, to: number, side: 'left'|'right'|'middle', width: number}[]}} Figure
 * @typedef {{id: number, name: string, label: ?string, rate: number, start: number, end: number, rig: ?string,
 *   figure: number, strip: ?object, motion: ?object}} Clip
 * @typedef {{clip: Clip, figure: Figure, rate: number, frames: number, origin: number[], data: Int16Array,
 *   rest: ?Promise}} Motion what `rest` waits for is missing until then
 */

/** In place of each coordinate of a missing point. */
export const MISSING = -32768;
/** Decoded motions that are kept; a page shows fewer at once. */
const KEPT_MOTIONS = 64;
/** Frames of a motion that are asked for at once. */
const BLOCK_FRAMES = 10000;
/** Attributes by short names. */
const LONG_NAMES = {label: 'aria-label', testid: 'data-testid'};

/** Gives an element attributes; those that are functions are listeners. */
export function equip(node, attributes) {
	for (const [name, value] of Object.entries(attributes)) {
		if (typeof value === 'function') node.addEventListener(name, value);
		else if (value != null && value !== false) node.setAttribute(LONG_NAMES[name] ?? name, value);
	}
}

/** An element, such as `make('p.small', {title: 'x'}, 'text')`; text is never read as HTML, null children are left out. */
export function make(kind, ...children) {
	const [tag, ...classes] = kind.split('.');
	const node = document.createElement(tag);
	node.classList.add(...classes);
	if (children[0]?.constructor === Object) equip(node, children.shift());
	node.append(...children.filter((child) => child != null));
	return node;
}

/** `[{name, value}]`, or values by name, as a list; what is null is left out. */
export function factList(facts) {
	const pairs = Array.isArray(facts) ? facts.map(({name, value}) => [name, value]) : Object.entries(facts);
	return make('dl.facts', ...pairs.map(([name, value]) => (value == null ? null : make('div', make('dt', name), make('dd', value)))));
}

/** A surface with a title. */
export const panel = (title, ...children) => make('section.panel.stack', make('h2', title), ...children);

export const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

/** Such as `3.93 s`. */
export const inSeconds = (seconds) => `${seconds.toFixed(2)} s`;

/** Such as `3.93 s · frame 471`, without a rate `3.93 s`. */
export const moment = (seconds, rate) => inSeconds(seconds) + (rate ? ` · frame ${Math.round(seconds * rate)}` : '');

/** Such as `3.93 s · 472 frames`. */
export const lengthOf = ({start, end, rate}) => `${inSeconds((end - start) / rate)} · ${end - start} frames`;

/** What people call a clip: the end of its path. */
export const shortName = (clip) => clip.name.split(/[\\/]/).pop();

/** @param {string} base64 */
export const bytesOf = (base64) => Uint8Array.from(atob(base64), (char) => char.charCodeAt(0));

/** Everything that pages show; in a live viewer it grows with each answer. */
export class Store {
	#motions = new Map();

	constructor(contents) {
		/** @type {Figure[]} */
		this.figures = [];
		/** @type {Map<number, Clip>} */
		this.clips = new Map();
		this.live = contents.live;
		this.pages = this.merge(contents);
	}

	/** Adds an answer's figures and clips. Returns its pages. */
	merge({figures = [], clips = [], pages = []}) {
		const places = figures.map((figure) => {
			const same = this.figures.findIndex((other) => JSON.stringify(other) === JSON.stringify(figure));
			return same < 0 ? this.figures.push(figure) - 1 : same;
		});
		for (const clip of clips) {
			const {strip, motion} = this.clips.get(clip.id) ?? {};
			this.clips.set(clip.id, {...clip, figure: places[clip.figure], strip: clip.strip ?? strip, motion: clip.motion ?? motion});
		}
		return pages;
	}

	/**
	 * What is played of a clip, at least around a source frame, or null if there is nothing to play.
	 * @returns {Promise<?Motion>}
	 */
	motion(id, frame = 0) {
		const motions = this.#motions;
		if (!motions.has(id)) {
			motions.set(id, this.#load(this.clips.get(id), frame));
			// A failed answer is asked for again.
			motions.get(id).then((motion) => motion?.rest).catch(() => motions.delete(id));
			if (motions.size > KEPT_MOTIONS) motions.delete(motions.keys().next().value);
		}
		return motions.get(id);
	}

	async #load(clip, frame) {
		const figure = this.figures[clip?.figure];
		if (clip?.motion) return {...clip.motion, clip, figure, data: new Int16Array(bytesOf(clip.motion.bytes).buffer)};
		if (!clip || !this.live) return null;
		const size = figure.points.length * 3;
		const bytes = size * 2 * BLOCK_FRAMES;
		const block = (k) => answerTo(`clips/${clip.id}/motion`, {range: `bytes=${k * bytes}-${(k + 1) * bytes - 1}`});
		const first = await block(0);
		const [[rate], [frames], origin] = ['rate', 'frames', 'origin'].map((name) => first.headers.get(`motif-${name}`).split(',').map(Number));
		const motion = {clip, figure, rate, frames, origin, data: new Int16Array(frames * size).fill(MISSING)};
		const fill = async (k, answer) => motion.data.set(new Int16Array(await answer.arrayBuffer()), k * BLOCK_FRAMES * size);
		await fill(0, first);
		// From the block that is wanted on.
		const wanted = Math.floor(((frame - clip.start) * rate) / clip.rate / BLOCK_FRAMES);
		const others = [...Array(Math.ceil(frames / BLOCK_FRAMES)).keys()].slice(1).sort((a, b) => (a < wanted) - (b < wanted));
		const finish = async (n) => {
			for (const k of others.splice(0, n)) await fill(k, await block(k));
		};
		await finish(wanted > 0 ? 1 : 0);
		motion.rest = others.length ? finish(others.length).then(() => { motion.rest = null; }) : null;
		return motion;
	}

	/** Live only: the JSON at `/api/` and a path. Throws an Error whose `detail` is the JSON of the error. */
	async ask(path, params) {
		return (await answerTo(params ? `${path}?${new URLSearchParams(params)}` : path)).json();
	}
}

async function answerTo(path, headers) {
	const answer = await fetch(`/api/${path}`, {headers});
	if (answer.ok) return answer;
	const detail = await answer.json().catch(() => ({error: `the viewer answered ${answer.status}`}));
	throw Object.assign(new Error(detail.error), {detail});
}

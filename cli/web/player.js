import {MISSING, make, inSeconds, shortName} from './store.js';
import {Camera} from './camera.js';
import {Stage} from './stage.js';

const SPEEDS = [0.25, 0.5, 1, 2, 4];
/** A motion whose root goes further than this from its middle, in metres, is followed by the camera. */
const TRAVEL = 0.4;
/** Frames that are looked at to find where a motion goes. */
const LOOKS = 400;
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

/**
 * The one player of the page. Event `time`, detail `{clip, frame, seconds}`: the first item's, in its source.
 * @typedef {{clip: number, start?: number, end?: number}} Item source frames, end exclusive
 */
export class Player extends EventTarget {
	#turn = 0;
	#waiting = false;
	#last = null;
	#held = false;

	constructor(host, store) {
		super();
		Object.assign(this, {store, takes: [], views: [], clock: 0, span: 0, speed: 1, playing: false, following: false});
		this.note = 'Choose a clip to play it.';
		this.#furnish(host);
		const stale = () => this.#stale();
		this.tested = /test/.test(location.search + location.hash);
		this.stage = new Stage(this.canvas, this.tested, stale);
		this.camera = new Camera(this.canvas, stale);
		this.#refresh();
		stale();
	}

	/**
   * Shows items from their beginning; several start together, overlaid ones at the first one's place and heading.
   * @param {Item[]} items
   * @param {{layout?: 'side'|'overlay', path?: number[][], title?: string, play?: boolean, clock?: number}} options a path
   *   links the first two items, `play` begins to play unless less motion is wanted, `clock` is where to begin
   */
	async show(items, options = {}) {
		const turn = ++this.#turn;
		this.note = 'There is no motion to play here.';
		const motions = await Promise.all(items.map(({clip}) => this.store.motion(clip))).catch(({message}) => {
			this.note = message;
			return [];
		});
		if (turn !== this.#turn) return;
		const takes = items.flatMap((item, k) => (motions[k] ? [takeOf(item, motions[k])] : []));
		const [first] = takes;
		const path = options.path && takes.length === items.length && linkOf(options.path, takes);
		Object.assign(this, {takes, path, asked: [items, options], layout: options.layout ?? 'overlay', clock: options.clock ?? 0});
		this.title.textContent = options.title ?? items.map(({clip}) => shortName(this.store.clips.get(clip))).join(' and ');
		this.span = path ? path.clock.at(-1) : Math.max(0, ...takes.map(({start, end, clip}) => (end - 1 - start) / clip.rate));
		this.following = takes.some(({range}) => range > TRAVEL);
		if (first) {
			this.note = '';
			Object.assign(this.scrub, {min: first.start, max: first.start + Math.max(1, Math.round(this.span * first.clip.rate))});
		}
		this.#arrange();
		if (options.play && !matchMedia('(prefers-reduced-motion: reduce)').matches) this.play();
		this.#moved();
	}

	/** What `show` takes to show this again; null before anything was shown. */
	get shown() {
		const {asked, layout, clock} = this;
		return asked ? [asked[0], {...asked[1], layout, clock, play: false}] : null;
	}

	/** @param {number} seconds of the first item's source */
	seek(seconds) {
		if (this.takes.length) this.seekFrame(seconds * this.takes[0].clip.rate);
	}

	/** @param {number} frame of the first item's source */
	seekFrame(frame) {
		const [first] = this.takes;
		if (!first) return;
		const at = clamp(frame, first.start, first.end - 1);
		this.#goTo(this.path ? between(this.path.frames[0], this.path.clock, at) : (at - first.start) / first.clip.rate);
	}

	play() {
		if (!this.takes.length) return;
		if (this.clock >= this.span) this.clock = 0;
		this.playing = true;
		this.#last = null;
		this.#refresh();
		this.#stale();
	}

	pause() {
		this.playing = false;
		this.#refresh();
	}

	/** Does what a key stands for; false if it stands for nothing. */
	key({key, shiftKey, ctrlKey, altKey, metaKey}) {
		const step = (frames) => {
			this.pause();
			this.seekFrame(Math.round(this.#frame(0)) + (shiftKey ? 10 : 1) * frames);
		};
		const faster = (by) => {
			this.speed = SPEEDS[clamp(SPEEDS.indexOf(this.speed) + by, 0, SPEEDS.length - 1)];
			this.#refresh();
		};
		const action = {
			' ': () => this.playButton.click(),
			ArrowLeft: () => step(-1),
			ArrowRight: () => step(1),
			'[': () => faster(-1),
			']': () => faster(1),
			Home: () => this.#goTo(0),
			End: () => this.#goTo(this.span),
			o: () => this.layoutButton.click(),
			r: () => this.camera.reset(),
		}[key];
		if (!action || ctrlKey || altKey || metaKey || !this.takes.length) return false;
		action();
		return true;
	}

	#goTo(clock) {
		this.clock = clamp(clock, 0, this.span);
		this.#moved();
	}

	/** Source frame of an item now, not rounded. */
	#frame(k) {
		if (this.path && k < 2) return between(this.path.clock, this.path.frames[k], this.clock);
		const {start, end, clip} = this.takes[k];
		return clamp(start + this.clock * clip.rate, start, end - 1);
	}

	#furnish(host) {
		const held = (is) => () => { this.#held = is; };
		this.title = make('h2', {class: 'player-title'});
		this.layoutButton = make('button', {type: 'button', title: 'Side by side or overlaid (o)', 'data-testid': 'layout', click: () => {
			this.layout = this.layout === 'side' ? 'overlay' : 'side';
			this.#arrange();
			this.#moved();
		}});
		this.canvas = make('canvas', {role: 'img', 'data-testid': 'canvas3d', 'aria-label': 'Skeleton. Drag to turn, wheel to zoom, double click to reset (r).'});
		this.tags = make('div', {class: 'view-tags'});
		this.message = make('p', {class: 'player-message'});
		this.scrub = make('input', {
			type: 'range', value: 0, class: 'scrub', 'aria-label': 'Frame', 'data-testid': 'scrub',
			input: () => this.#goTo((this.scrub.value - this.scrub.min) / this.takes[0].clip.rate),
			// A hand on the bar holds the time; playback goes on when it lets go.
			pointerdown: held(true), pointerup: held(false), pointercancel: held(false),
		});
		this.playButton = make('button', {class: 'primary', type: 'button', 'data-testid': 'play', click: () => (this.playing ? this.pause() : this.play())});
		this.time = make('output', {class: 'time number', 'aria-live': 'off', 'data-testid': 'time'});
		this.speedList = make('select', {'aria-label': 'Speed', title: 'Speed ([ and ])', 'data-testid': 'speed', change: () => { this.speed = +this.speedList.value; }},
			...SPEEDS.map((value) => make('option', {value}, `${{0.25: '¼', 0.5: '½'}[value] ?? value}×`)));
		host.append(
			make('div', {class: 'bar player-head'}, this.title, this.layoutButton),
			make('div', {class: 'view'}, this.canvas, this.tags, this.message),
			this.scrub,
			make('div', {class: 'bar player-controls'}, this.playButton, this.time, this.speedList));
	}

	/** What changes with buttons alone. */
	#refresh() {
		this.playButton.textContent = this.playing ? 'Pause' : 'Play';
		this.speedList.value = this.speed;
		this.layoutButton.textContent = this.layout === 'side' ? 'Overlay' : 'Side by side';
		this.layoutButton.hidden = this.takes.length !== 2;
		this.scrub.disabled = this.playButton.disabled = !this.takes.length;
	}

	/** Places the items to each other, for the layout. */
	#arrange() {
		const {takes} = this;
		for (const take of takes) {
			const turn = takes[0].heading - take.heading;
			Object.assign(take, {turn: [Math.cos(turn), Math.sin(turn)], shift: [0, 0, 0]});
			const from = placed(take, take.first);
			take.shift = [takes[0].first[0] - from[0], -take.floor, takes[0].first[2] - from[2]];
		}
		this.views = this.layout === 'side' ? takes.map((take) => [take]) : [takes];
		// Who is who is said where two can be mistaken.
		this.tags.replaceChildren(...(takes.length !== 2 ? [] : takes.map(({clip}, k) =>
			make('p', {class: k ? 'tag second' : 'tag', 'data-testid': `tag-${k}`}, make('span', {}, shortName(clip)), make('span')))));
		this.tags.classList.toggle('apart', this.views.length > 1);
		this.#aim();
		this.#refresh();
	}

	/** Frames the bodies, and where they go unless they are followed. */
	#aim() {
		if (!this.takes.length) return;
		const half = {width: 0.4, height: 0.5};
		for (const takes of this.views) {
			// Followed bodies are farthest from each other at the end, about.
			const places = takes.map((take) => placed(take, this.following ? take.last : take.middle));
			const middle = mean(places);
			takes.forEach((take, k) => {
				const apart = Math.hypot(places[k][0] - middle[0], places[k][2] - middle[2]);
				half.width = Math.max(half.width, apart + (this.following ? 0 : take.range) + 0.85 * take.reach);
				half.height = Math.max(half.height, (take.top - take.floor) / 2);
			});
		}
		this.camera.frame(half.width, half.height, this.takes[0].heading + 0.7);
	}

	#target(takes) {
		const [x, , z] = mean(takes.map((take) => {
			// Where the root is missing, the camera waits where it was.
			take.at = take.pose[take.root] ?? take.at;
			return this.following && take.at ? take.at : placed(take, take.middle);
		}));
		return [x, this.camera.height, z];
	}

	#stale() {
		if (this.#waiting) return;
		this.#waiting = true;
		requestAnimationFrame((now) => {
			this.#waiting = false;
			this.#tick(now);
		});
	}

	#tick(now) {
		if (this.playing) {
			// A page that was hidden does not jump.
			const passed = this.#last === null || this.#held ? 0 : Math.min((now - this.#last) / 1000, 0.1);
			this.#last = now;
			this.clock += passed * this.speed;
			if (this.clock >= this.span) this.clock %= this.span || 1;
			this.#moved();
		}
		this.message.textContent = this.stage.failure ?? this.note;
		const {takes} = this;
		takes.forEach((take, k) => {
			setPose(take, this.#frame(k));
			// The second of two is striped and lighter; of many, each a little different.
			take.stripes = takes.length < 3 ? k : (k * 0.618) % 1;
		});
		if (takes.length) this.stage.draw(this.views.map((bodies) => ({bodies, target: this.#target(bodies)})), this.camera);
	}

	/** Says what time it is, and draws. */
	#moved() {
		this.#stale();
		const [first] = this.takes;
		if (!first) return this.time.replaceChildren();
		const times = this.takes.map(({clip}, k) => {
			const frame = Math.round(this.#frame(k));
			return {clip: clip.id, frame, seconds: frame / clip.rate};
		});
		const [{frame, seconds}] = times;
		this.scrub.value = first.start + Math.round(this.clock * first.clip.rate);
		// Two parts that a narrow player sets below each other.
		this.time.replaceChildren(
			make('span', {}, `${inSeconds(seconds)} / ${inSeconds((first.end - 1) / first.clip.rate)}`),
			make('span', {}, `frame ${frame} / ${first.end - 1}`));
		this.scrub.setAttribute('aria-valuetext', `${inSeconds(seconds)}, frame ${frame}`);
		[...this.tags.children].forEach((tag, k) => {
			tag.lastChild.textContent = `${inSeconds(times[k].seconds)} · frame ${times[k].frame}`;
			tag.dataset.frame = times[k].frame;
		});
		this.dispatchEvent(new CustomEvent('time', {detail: times[0]}));
	}
}

/** An item with what is known of its motion: where it stands, looks and goes. Metres, as in the source. */
function takeOf(item, motion) {
	const {clip, figure} = motion;
	const start = clamp(item.start ?? clip.start, clip.start, clip.end - 1);
	const end = clamp(item.end ?? clip.end, start + 1, clip.end);
	const take = {motion, figure, clip, start, end, reach: 0.3, top: -Infinity};
	take.root = Math.max(0, figure.points.indexOf('root'));
	const [from, to] = [start, end - 1].map((frame) => motionFrame(take, frame));
	const [roots, lowest] = [[], []];
	for (let at = from; at <= to; at += Math.max(1, (to - from) / LOOKS)) {
		const root = pointAt(motion, at, take.root);
		if (!root) continue;
		roots.push(root);
		take.heading ??= headingAt(motion, at);
		let low = Infinity;
		figure.points.forEach((_, point) => {
			const place = pointAt(motion, at, point);
			if (!place) return;
			low = Math.min(low, place[1]);
			take.top = Math.max(take.top, place[1]);
			take.reach = Math.max(take.reach, Math.hypot(place[0] - root[0], place[2] - root[2]));
		});
		lowest.push(low);
	}
	if (!roots.length) roots.push([0, 1, 0]);
	take.middle = mean(roots);
	take.range = Math.max(...roots.map(([x, , z]) => Math.hypot(x - take.middle[0], z - take.middle[2])));
	// The floor is where the lowest point often is: neither a jump nor a stray frame moves it.
	const floor = lowest.filter(Number.isFinite).sort((a, b) => a - b)[Math.floor(lowest.length / 4)] ?? 0;
	return Object.assign(take, {heading: take.heading ?? 0, first: roots[0], last: roots.at(-1), floor: floor - 0.03});
}

function motionFrame({clip, motion}, frame) {
	return Math.min(((frame - clip.start) * motion.rate) / clip.rate, motion.frames - 1);
}

/** A point in metres, between two frames if need be; null where it is missing. */
function pointAt({data, figure, origin}, frame, point) {
	const size = figure.points.length * 3;
	const at = Math.floor(frame) * size + point * 3;
	const next = data[at + size] > MISSING ? at + size : at;
	return data[at] === MISSING ? null : origin.map((from, k) => (from + data[at + k] + (data[next + k] - data[at + k]) * (frame % 1)) / 1000);
}

/** Where the hips face, turned about +Y from +Z. */
function headingAt(motion, frame) {
	const places = ['lhip', 'rhip'].map((name) => motion.figure.points.indexOf(name));
	const [left, right] = places.map((place) => (place < 0 ? null : pointAt(motion, frame, place)));
	return left && right ? Math.atan2(right[2] - left[2], left[0] - right[0]) : null;
}

/** A place of an item's source where it is shown. */
function placed({turn: [c, s], shift}, [x, y, z]) {
	return [x * c + z * s + shift[0], y + shift[1], z * c - x * s + shift[2]];
}

/** Fills an item's pose for a source frame, between two frames of its motion if need be. */
function setPose(take, frame) {
	const {motion} = take;
	const at = motionFrame(take, frame);
	take.pose = motion.figure.points.map((_, point) => {
		const place = pointAt(motion, at, point);
		return place && placed(take, place);
	});
}

const mean = (places) => [0, 1, 2].map((k) => places.reduce((sum, place) => sum + place[k], 0) / places.length);

/** A path with a clock: a step takes as long as the slower item needs, so neither jumps while the other waits. */
function linkOf(path, takes) {
	const clock = [0];
	for (let k = 1; k < path.length; k++) {
		clock.push(clock[k - 1] + Math.max(...[0, 1].map((side) => (path[k][side] - path[k - 1][side]) / takes[side].clip.rate)));
	}
	return {clock, frames: [0, 1].map((side) => path.map((pair) => pair[side]))};
}

/** The value at `x` of a line through points with ascending `xs`; where several stand above each other, the first one's. */
function between(xs, ys, x) {
	let [low, high] = [0, xs.length - 1];
	while (low < high) {
		const middle = (low + high) >> 1;
		if (xs[middle] < x) low = middle + 1;
		else high = middle;
	}
	if (low === 0 || xs[low] <= x) return ys[low];
	return ys[low - 1] + ((ys[low] - ys[low - 1]) * (x - xs[low - 1])) / (xs[low] - xs[low - 1]);
}

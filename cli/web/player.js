import {MISSING, clamp, inSeconds, make, moment, shortName} from './store.js';
import {Camera} from './camera.js';
import {Stage} from './stage.js';

const SPEEDS = [[0.25, '¼'], [0.5, '½'], [1, 1], [2, 2], [4, 4]];
/** A motion whose root goes further than this from its middle, in metres, is followed by the camera. */
const TRAVEL = 0.4;
/** Frames that are looked at to find where a motion goes. */
const LOOKS = 400;
const NOTHING_CHOSEN = 'Choose what to play.';

/**
 * The one player of the page. Event `time`, detail `{clip, frame, seconds}`: the first item's, in its source.
 * @typedef {{clip: number, start?: number, end?: number}} Item source frames, end exclusive
 */
export class Player extends EventTarget {
	#turn = 0;
	#waiting = 0;
	#last;

	constructor(host, store) {
		super();
		Object.assign(this, {store, takes: [], views: [], clock: 0, span: 0, playing: false, note: NOTHING_CHOSEN});
		this.#furnish(host);
		const stale = () => this.#stale();
		this.tested = /test/.test(location.search + location.hash);
		this.stage = new Stage(this.canvas, this.tested, stale);
		this.camera = new Camera(this.canvas, stale);
		this.#refresh();
	}

	/**
	 * Shows items from their beginning; several start together, overlaid ones at the first one's place and heading.
	 * @param {Item[]} items
	 * @param {{layout?: 'side'|'overlay', path?: number[][], title?: string, play?: boolean, clock?: number}} options a path
	 *   links the first two items, `play` begins to play unless less motion is wanted, `clock` is where to begin
	 */
	async show(items, options = {}) {
		const turn = ++this.#turn;
		this.note = items.length ? 'There is no motion to play here.' : NOTHING_CHOSEN;
		const failed = ({message}) => {
			this.note = message;
			this.#stale();
			return [];
		};
		const motions = await Promise.all(items.map(({clip, start}) => this.store.motion(clip, start))).catch(failed);
		if (turn !== this.#turn) return;
		const takes = items.flatMap((item, k) => (motions[k] ? [takeOf(item, motions[k])] : []));
		const [first] = takes;
		if (options.path && takes.length === items.length) link(takes, options.path);
		for (const take of takes) take.lead = first;
		Object.assign(this, {takes, asked: [items, options], layout: options.layout ?? 'overlay', clock: options.clock ?? 0});
		this.title.textContent = options.title ?? items.map(({clip}) => shortName(this.store.clips.get(clip))).join(' and ');
		this.span = Math.max(0, ...takes.map(({clock}) => clock.at(-1)));
		this.following = takes.some(({range}) => range > TRAVEL);
		if (first) {
			this.note = '';
			Object.assign(this.scrub, {min: first.start, max: first.start + Math.max(1, Math.round(this.span * first.clip.rate))});
		}
		this.#arrange();
		if (options.play && !matchMedia('(prefers-reduced-motion: reduce)').matches) this.play();
		// Where a motion goes is looked at anew when all of it is there.
		motions.find((motion) => motion?.rest)?.rest.then(() => turn === this.#turn && this.show(...this.shown), failed);
	}

	/** What `show` takes to show this again; null if nothing is shown. */
	get shown() {
		const {asked, layout, clock} = this;
		return asked?.[0].length ? [asked[0], {...asked[1], layout, clock, play: false}] : null;
	}

	/** Goes to a frame of the first item's source. */
	seekFrame(frame) {
		const [first] = this.takes;
		if (first) this.#goTo(between(first.frames, first.clock, frame));
	}

	play() {
		if (!this.takes.length) return;
		if (this.clock >= this.span) this.clock = 0;
		this.playing = true;
		this.#last = undefined;
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
			this.seekFrame(Math.round(this.#frameOf(this.takes[0])) + (shiftKey ? 10 : 1) * frames);
		};
		const faster = (by) => {
			this.speed.selectedIndex = clamp(this.speed.selectedIndex + by, 0, SPEEDS.length - 1);
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
		const does = action && !ctrlKey && !altKey && !metaKey && this.takes.length;
		if (does) action();
		return does;
	}

	#goTo(clock) {
		this.clock = clamp(clock, 0, this.span);
		this.#moved();
	}

	/** Source frame of an item now, not rounded. */
	#frameOf = ({clock, frames}) => between(clock, frames, this.clock);

	#furnish(host) {
		this.title = make('h2');
		this.layoutButton = make('button', {hidden: true, title: 'Side by side or overlaid (o)', click: () => {
			this.layout = this.layout === 'side' ? 'overlay' : 'side';
			this.#arrange();
		}});
		this.canvas = make('canvas', {role: 'img', testid: 'canvas3d', label: 'Skeleton. Drag to turn, wheel to zoom, double click to reset (r).'});
		this.tags = make('div.tags');
		this.message = make('p.muted');
		this.scrub = make('input.scrub', {type: 'range', value: 0, label: 'Frame', testid: 'scrub', input: () =>
			this.#goTo((this.scrub.value - this.scrub.min) / this.takes[0].clip.rate)});
		this.playButton = make('button.primary', {testid: 'play', click: () => (this.playing ? this.pause() : this.play())});
		this.time = make('output.time', {'aria-live': 'off', testid: 'time'});
		this.speed = make('select', {label: 'Speed', title: 'Speed ([ and ])'},
			...SPEEDS.map(([value, name]) => make('option', {value, selected: value === 1}, `${name}×`)));
		host.append(
			make('div.bar', this.title, this.layoutButton),
			make('div.view', this.canvas, this.tags, this.message),
			this.scrub,
			make('div.bar', this.playButton, this.time, this.speed));
	}

	#refresh() {
		this.playButton.textContent = this.playing ? 'Pause' : 'Play';
		this.canvas.hidden = this.scrub.disabled = this.playButton.disabled = !this.takes.length;
	}

	/** Lays the items out and frames them, and where they go unless they are followed. */
	#arrange() {
		const {takes, following} = this;
		this.views = this.layout === 'side' ? takes.map((take) => [take]) : [takes];
		// Who is who is said where two can be mistaken.
		this.tags.replaceChildren(...(takes.length === 2 ? takes : []).map(({clip}, k) =>
			make(k ? 'p.tag.second' : 'p.tag', {testid: `tag-${k}`}, make('span', shortName(clip)), make('span'))));
		this.tags.classList.toggle('apart', this.views.length > 1);
		this.layoutButton.textContent = this.layout === 'side' ? 'Overlay' : 'Side by side';
		this.layoutButton.hidden = takes.length !== 2;
		this.#refresh();
		this.#moved();
		if (!takes.length) return this.pause();
		let [width, height] = [0.4, 0.5];
		for (const bodies of this.views) {
			// Followed bodies are farthest from each other at the end, about.
			const places = bodies.map((take) => placed(take, following ? take.last : take.middle));
			bodies.forEach((take, k) => {
				take.at = places[k];
				width = Math.max(width, apart(places[k], mean(places)) + (following ? 0 : take.range) + 0.85 * take.reach);
				height = Math.max(height, (take.top - take.floor) / 2);
			});
		}
		this.camera.frame(width, height, takes[0].heading + 0.7);
	}

	/** Draws soon, however often it is called until then. */
	#stale() {
		this.#waiting ||= requestAnimationFrame((now) => this.#tick(now));
	}

	#tick(now) {
		this.#waiting = 0;
		if (this.playing) {
			// A hand on the bar holds the time, and a page that was hidden does not jump.
			const passed = this.scrub.matches(':active') ? 0 : Math.min((now - this.#last) / 1000 || 0, 0.1);
			this.#last = now;
			this.clock += passed * this.speed.value;
			if (this.clock >= this.span) this.clock %= this.span || 1;
			this.#moved();
		}
		this.message.textContent = this.stage.failure ?? this.note;
		const {takes} = this;
		takes.forEach((take, k) => {
			take.pose = poseAt(take.motion, this.#frameOf(take)).map((place) => place && placed(take, place));
			// The second of two is striped and lighter; of many, each a little different.
			take.stripes = takes.length < 3 ? k : (k * 0.618) % 1;
			// Where the root is missing, the camera waits where it was.
			if (this.following) take.at = take.pose[take.root] ?? take.at;
		});
		if (takes.length) this.stage.draw(this.views.map((bodies) => ({bodies, target: mean(bodies.map(({at}) => at))})), this.camera);
	}

	#moved() {
		this.#stale();
		const {takes: [first], scrub} = this;
		this.now = null;
		if (!first) return this.time.replaceChildren();
		const times = this.takes.map((take) => {
			const frame = Math.round(this.#frameOf(take));
			return {clip: take.clip.id, frame, seconds: frame / take.clip.rate, rate: take.clip.rate};
		});
		const [{frame, seconds, rate}] = times;
		scrub.value = first.start + Math.round(this.clock * rate);
		scrub.ariaValueText = moment(seconds, rate);
		// Two parts that a narrow player sets below each other.
		this.time.replaceChildren(
			make('span', `${inSeconds(seconds)} / ${inSeconds((first.end - 1) / rate)}`),
			make('span', `frame ${frame} / ${first.end - 1}`));
		[...this.tags.children].forEach((tag, k) => {
			tag.lastChild.textContent = moment(times[k].seconds, times[k].rate);
			tag.dataset.frame = times[k].frame;
		});
		[this.now] = times;
		this.dispatchEvent(new CustomEvent('time', {detail: this.now}));
	}
}

/** An item with what is known of its motion: where it stands, looks and goes. Metres, as in the source. */
function takeOf(item, motion) {
	const {clip, figure} = motion;
	const start = clamp(item.start ?? clip.start, clip.start, clip.end - 1);
	const end = clamp(item.end ?? clip.end, start + 1, clip.end);
	const [root, left, right] = ['root', 'lhip', 'rhip'].map((name) => figure.points.indexOf(name));
	const [clock, frames] = [[0, (end - 1 - start) / clip.rate], [start, end - 1]];
	const take = {motion, figure, clip, start, end, clock, frames, root: Math.max(0, root), reach: 0.3, top: -Infinity};
	const [roots, lowest] = [[], []];
	for (let frame = start; frame < end; frame += Math.max(clip.rate / motion.rate, (end - start) / LOOKS)) {
		const pose = poseAt(motion, frame);
		const middle = pose[take.root];
		if (!middle) continue;
		const known = pose.filter(Boolean);
		const heights = known.map(([, y]) => y);
		roots.push(middle);
		lowest.push(Math.min(...heights));
		take.top = Math.max(take.top, ...heights);
		take.reach = Math.max(take.reach, ...known.map((place) => apart(place, middle)));
		// Where the hips face, turned about +Y from +Z.
		if (pose[left] && pose[right]) take.heading ??= Math.atan2(pose[right][2] - pose[left][2], pose[left][0] - pose[right][0]);
	}
	if (!roots.length) roots.push([0, 1, 0]);
	take.heading ??= 0;
	take.middle = mean(roots);
	take.range = Math.max(...roots.map((place) => apart(place, take.middle)));
	// The floor is where the lowest point often is: neither a jump nor a stray frame moves it.
	const floor = lowest.sort((a, b) => a - b)[Math.floor(lowest.length / 4)] ?? 0;
	return Object.assign(take, {first: roots[0], last: roots.at(-1), floor: floor - 0.03});
}

/** The points at a source frame in metres, between two frames of the motion if need be; null for a missing one. */
function poseAt({data, figure, clip, rate, frames, origin}, frame) {
	const at = Math.min(((frame - clip.start) * rate) / clip.rate, frames - 1);
	const size = figure.points.length * 3;
	return figure.points.map((_, point) => {
		const here = Math.floor(at) * size + point * 3;
		const next = data[here + size] > MISSING ? here + size : here;
		return data[here] === MISSING ? null : origin.map((from, k) => (from + data[here + k] + (data[next + k] - data[here + k]) * (at % 1)) / 1000);
	});
}

/** A place of an item's source where it is shown: all begin at the first item's place and heading. */
function placed({first, heading, floor, lead}, [x, y, z]) {
	const [c, s] = [Math.cos(lead.heading - heading), Math.sin(lead.heading - heading)];
	const [dx, dz] = [x - first[0], z - first[2]];
	return [lead.first[0] + dx * c + dz * s, y - floor, lead.first[2] + dz * c - dx * s];
}

const mean = (places) => [0, 1, 2].map((k) => places.reduce((sum, place) => sum + place[k], 0) / places.length);

/** In metres, seen from above. */
const apart = (a, b) => Math.hypot(a[0] - b[0], a[2] - b[2]);

/** Links two items by a path: a step takes as long as the slower item needs, so neither jumps while the other waits. */
function link(takes, path) {
	const clock = [0];
	path.slice(1).forEach((pair, k) => clock.push(clock[k] + Math.max(...pair.map((frame, side) => (frame - path[k][side]) / takes[side].clip.rate))));
	for (const side of [0, 1]) Object.assign(takes[side], {clock, frames: path.map((pair) => pair[side])});
}

/** The value at `x` of a line through points with ascending `xs`; where several stand above each other, the first one's. */
function between(xs, ys, x) {
	const high = xs.findIndex((other) => other >= x);
	if (high < 1) return ys.at(high);
	return ys[high - 1] + ((ys[high] - ys[high - 1]) * (x - xs[high - 1])) / (xs[high] - xs[high - 1]);
}

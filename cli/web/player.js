import {MISSING, make, inSeconds, shortName} from './store.js';
import {Camera} from './camera.js';
import {Stage} from './stage.js';

const SPEEDS = [0.25, 0.5, 1, 2, 4];
/** A motion that travels further than this is followed, else the camera stands still. Metres. */
const TRAVEL = 1.5;
/** Frames that are looked at to find where a motion goes. */
const LOOKS = 400;
/** The camera follows the mean place of this many seconds before and after. */
const STEADY_S = 0.6;
const ICONS = {
  play: 'M7 4l13 8-13 8z',
  pause: 'M6 4h4v16H6zM14 4h4v16h-4z',
  loop: 'M17 2l4 4-4 4V7H7v4H5V5h12zM7 22l-4-4 4-4v3h10v-4h2v6H7z',
  follow: 'M12 2v4M12 18v4M2 12h4M18 12h4M12 7a5 5 0 100 10 5 5 0 000-10z',
  reset: 'M4 9V4h5M20 9V4h-5M4 15v5h5M20 15v5h-5',
};
const calm = matchMedia('(prefers-reduced-motion: reduce)');

/**
 * The one player of the page. Events: `time`, with detail `{clip, frame, seconds}` of the first item in its source's time.
 * @typedef {{clip: number, start?: number, end?: number, offset_s?: number}} Item source frames, end exclusive
 */
export class Player extends EventTarget {
  #shown = 0;
  #drawing = false;
  #last = null;
  #held = false;

  /**
   * @param {HTMLElement} host
   * @param {import('./store.js').Store} store
   */
  constructor(host, store) {
    super();
    this.store = store;
    this.takes = [];
    this.clock = 0;
    this.span = 0;
    this.speed = 1;
    this.playing = false;
    this.looping = true;
    this.following = false;
    this.layout = 'overlay';
    this.#furnish(host);
    this.stage = new Stage(this.canvas, /test/.test(location.search + location.hash), () => this.#stale());
    this.camera = new Camera(this.canvas, () => this.#stale());
    this.missing = 'Choose a clip to play it.';
    this.#refresh();
    this.#stale();
  }

  /**
   * Shows items from their beginning. More than one start together: overlaid ones at the first one's place and heading.
   * @param {Item[]} items
   * @param {{layout?: 'side'|'overlay', path?: number[][], title?: string, play?: boolean}} options a path links the
   *   first two items, `play` begins to play unless less motion is wanted
   */
  async show(items, options = {}) {
    const turn = ++this.#shown;
    let motions, problem;
    try {
      motions = await Promise.all(items.map((item) => this.store.motion(item.clip)));
    } catch (error) {
      motions = items.map(() => null);
      problem = error.message;
    }
    if (turn !== this.#shown) return;
    this.takes = items.flatMap((item, k) => (motions[k] ? [takeOf(item, motions[k])] : []));
    const [first] = this.takes;
    this.path = options.path && this.takes.length === items.length ? linkOf(options.path, this.takes) : null;
    this.layout = options.layout ?? 'overlay';
    this.clock = 0;
    this.span = this.path ? this.path.clock.at(-1) : Math.max(0, ...this.takes.map((take) => take.offset + (take.end - 1 - take.start) / take.clip.rate));
    this.following = this.takes.some((take) => Math.hypot(take.high[0] - take.low[0], take.high[2] - take.low[2]) > TRAVEL);
    this.title.textContent = options.title ?? items.map((item) => shortName(this.store.clips.get(item.clip) ?? { name: `clip ${item.clip}` })).join(' and ');
    if (first) {
      const low = first.start;
      this.scrub.min = low;
      this.scrub.max = low + Math.max(1, Math.round(this.span * first.clip.rate));
    }
    this.missing = first ? '' : problem ?? 'There is no motion to play here.';
    this.#arrange();
    if (options.play && !calm.matches) this.play();
    this.#moved();
  }

  /** @param {number} seconds of the first item's source */
  seek(seconds) {
    if (this.takes.length) this.seekFrame(seconds * this.takes[0].clip.rate);
  }

  /** @param {number} frame of the first item's source */
  seekFrame(frame) {
    const [first] = this.takes;
    if (!first) return;
    const place = Math.min(Math.max(frame, first.start), first.end - 1);
    this.#goTo(this.path ? between(this.path.frames[0], this.path.clock, place) : first.offset + (place - first.start) / first.clip.rate);
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
  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return false;
    const step = event.shiftKey ? 10 : 1;
    const keys = {
      ' ': () => (this.playing ? this.pause() : this.play()),
      ArrowLeft: () => this.#step(-step),
      ArrowRight: () => this.#step(step),
      '[': () => this.#faster(-1),
      ']': () => this.#faster(1),
      Home: () => this.#goTo(0),
      End: () => this.#goTo(this.span),
      l: () => this.loopButton.click(),
      f: () => this.followButton.click(),
      r: () => this.camera.reset(),
      o: () => this.layoutButton.hidden || this.layoutButton.click(),
      q: () => this.camera.turn(-0.15, 0),
      e: () => this.camera.turn(0.15, 0),
      '+': () => this.camera.zoom(0.9),
      '-': () => this.camera.zoom(1 / 0.9),
    };
    const action = keys[event.key];
    action?.();
    return Boolean(action);
  }

  #step(frames) {
    this.pause();
    if (this.takes.length) this.seekFrame(Math.round(this.#frame(0)) + frames);
  }

  #faster(by) {
    const place = SPEEDS.indexOf(this.speed) + by;
    this.speed = SPEEDS[Math.min(Math.max(place, 0), SPEEDS.length - 1)];
    this.#refresh();
  }

  #goTo(clock) {
    this.clock = Math.min(Math.max(clock, 0), this.span);
    this.#moved();
  }

  /** Source frame of an item now, not rounded. */
  #frame(k) {
    const take = this.takes[k];
    if (this.path && k < 2) return between(this.path.clock, this.path.frames[k], this.clock);
    const frame = take.start + (this.clock - take.offset) * take.clip.rate;
    return Math.min(Math.max(frame, take.start), take.end - 1);
  }

  #furnish(host) {
    const icon = (name) => {
      const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
      const path = document.createElementNS('http://www.w3.org/2000/svg', 'path');
      svg.setAttribute('viewBox', '0 0 24 24');
      svg.setAttribute('aria-hidden', 'true');
      path.setAttribute('d', ICONS[name]);
      if (name === 'follow' || name === 'reset') svg.setAttribute('class', 'outline');
      svg.append(path);
      return svg;
    };
    const button = (name, label, click, testid) =>
      make('button', { class: 'icon', type: 'button', 'aria-label': label, title: label, click, 'data-testid': testid }, icon(name));
    this.title = make('h2', { class: 'player-title' });
    this.layoutButton = make('button', { type: 'button', hidden: true, 'data-testid': 'layout', title: 'Side by side or overlaid (o)', click: () => {
      this.layout = this.layout === 'side' ? 'overlay' : 'side';
      this.#arrange();
      this.#moved();
    } });
    this.canvas = make('canvas', { 'data-testid': 'canvas3d', role: 'img', 'aria-label': 'Skeleton in motion. Drag to turn, wheel to zoom, double click to reset.' });
    this.tags = make('div', { class: 'view-tags' });
    this.message = make('p', { class: 'player-message' });
    this.scrub = make('input', { type: 'range', min: 0, max: 1, step: 1, value: 0, class: 'scrub', 'aria-label': 'Frame', 'data-testid': 'scrub',
      input: () => this.takes.length && this.#goTo((this.scrub.value - this.takes[0].start) / this.takes[0].clip.rate),
      // A hand on the bar holds the time; playback goes on when it lets go.
      pointerdown: () => { this.#held = true; },
      pointerup: () => { this.#held = false; },
      pointercancel: () => { this.#held = false; },
    });
    this.playIcons = [icon('play'), icon('pause')];
    this.playButton = button('play', 'Play (space)', () => (this.playing ? this.pause() : this.play()), 'play');
    this.playButton.classList.add('primary');
    this.time = make('output', { class: 'time number', 'data-testid': 'time', 'aria-live': 'off' });
    this.speedList = make('select', { 'aria-label': 'Speed', title: 'Speed ([ and ])', 'data-testid': 'speed', change: () => {
      this.speed = +this.speedList.value;
    } }, ...SPEEDS.map((speed) => make('option', { value: speed }, `${{ 0.25: '¼', 0.5: '½' }[speed] ?? speed}×`)));
    this.loopButton = button('loop', 'Loop (l)', () => {
      this.looping = !this.looping;
      this.#refresh();
    });
    this.followButton = button('follow', 'Camera follows (f)', () => {
      this.following = !this.following;
      this.#frameCamera();
      this.#refresh();
    });
    host.append(
      make('div', { class: 'bar player-head' }, this.title, this.layoutButton),
      make('div', { class: 'view' }, this.canvas, this.tags, this.message),
      this.scrub,
      make('div', { class: 'bar player-controls' }, this.playButton, this.time, this.speedList, this.loopButton, this.followButton,
        button('reset', 'Reset the camera (r)', () => this.camera.reset())),
    );
  }

  #say(text) {
    this.message.textContent = text;
    this.message.hidden = !text;
  }

  /** What only changes with buttons. */
  #refresh() {
    this.playButton.replaceChildren(this.playIcons[+this.playing]);
    const label = this.playing ? 'Pause (space)' : 'Play (space)';
    this.playButton.title = label;
    this.playButton.setAttribute('aria-label', label);
    this.speedList.value = this.speed;
    this.loopButton.setAttribute('aria-pressed', this.looping);
    this.followButton.setAttribute('aria-pressed', this.following);
    for (const control of [this.scrub, this.playButton, this.speedList]) control.disabled = !this.takes.length;
  }

  /** Places the items to each other, for the layout. */
  #arrange() {
    const [first] = this.takes;
    const several = this.takes.length > 1;
    this.layoutButton.hidden = this.takes.length !== 2;
    this.layoutButton.textContent = this.layout === 'side' ? 'Overlay' : 'Side by side';
    for (const take of this.takes) {
      const turn = first.heading - take.heading;
      take.turn = [Math.cos(turn), Math.sin(turn)];
      take.shift = [0, 0, 0];
      const from = placed(take, take.first);
      const to = several ? [first.first[0], 0, first.first[2]] : [take.first[0], 0, take.first[2]];
      take.shift = [to[0] - from[0], -take.floor, to[2] - from[2]];
    }
    this.views = this.layout === 'side' ? this.takes.map((take) => [take]) : [this.takes];
    // Who is who is said where two can be mistaken.
    this.tags.replaceChildren(...(several && this.takes.length < 3 ? this.takes.map((take, k) =>
      make('p', { class: k ? 'tag second' : 'tag', 'data-testid': `tag-${k}` }, make('span', {}, shortName(take.clip)), make('span'))) : []));
    this.tags.classList.toggle('apart', this.views.length > 1);
    this.#frameCamera();
    this.#refresh();
  }

  #frameCamera() {
    const [first] = this.takes;
    if (!first) return;
    const half = { width: 0.4, height: 0.5 };
    for (const takes of this.views) {
      const [low, high] = bounds(takes);
      const top = Math.max(...takes.map((take) => take.top - take.floor));
      half.height = Math.max(half.height, top / 2);
      const body = Math.max(...takes.map((take) => take.reach));
      const apart = this.following ? this.#apart(takes) : Math.hypot(high[0] - low[0], high[2] - low[2]) / 2;
      half.width = Math.max(half.width, body * 0.85 + apart);
    }
    this.height = half.height;
    this.camera.frame(half, first.heading + 0.7);
  }

  /** How far overlaid items get from their middle, at a few moments. */
  #apart(takes) {
    if (takes.length < 2) return 0;
    const now = this.clock;
    let most = 0;
    for (let k = 0; k <= 16; k++) {
      this.clock = (this.span * k) / 16;
      const [low, high] = corners(takes.map((take) => this.#root(take)));
      most = Math.max(most, Math.hypot(high[0] - low[0], high[2] - low[2]) / 2);
    }
    this.clock = now;
    return Math.min(most, 6);
  }

  /** Where an item's root is about now, placed; steady, so the camera does not shake. */
  #root(take) {
    const { motion } = take;
    const now = motionFrame(take, this.#frame(this.takes.indexOf(take)));
    const reach = STEADY_S * motion.rate;
    const sum = [0, 0, 0];
    let n = 0;
    for (let k = -8; k <= 8; k++) {
      const root = rootAt(motion, Math.min(Math.max(now + (reach * k) / 8, take.from), take.to));
      if (!root) continue;
      sum.forEach((_, axis) => { sum[axis] += root[axis]; });
      n++;
    }
    return placed(take, n ? sum.map((value) => value / n) : take.first);
  }

  #target(takes) {
    let at;
    if (this.following) {
      const [low, high] = corners(takes.map((take) => this.#root(take)));
      at = [(low[0] + high[0]) / 2, 0, (low[2] + high[2]) / 2];
    } else {
      const [low, high] = bounds(takes);
      at = [(low[0] + high[0]) / 2, 0, (low[2] + high[2]) / 2];
    }
    at[1] = this.height;
    return at;
  }

  #stale() {
    if (this.#drawing) return;
    this.#drawing = true;
    requestAnimationFrame((now) => {
      this.#drawing = false;
      this.#tick(now);
    });
  }

  #tick(now) {
    if (this.playing) {
      // A page that was hidden does not jump.
      const passed = this.#last === null || this.#held ? 0 : Math.min((now - this.#last) / 1000, 0.1);
      this.#last = now;
      this.clock += passed * this.speed;
      if (this.clock >= this.span) {
        if (this.looping && this.span > 0) this.clock %= this.span;
        else {
          this.clock = this.span;
          this.pause();
        }
      }
      this.#moved();
    }
    this.#say(this.stage.failure ?? this.missing);
    if (!this.takes.length || !this.views) return;
    for (const [k, take] of this.takes.entries()) posed(take, this.#frame(k));
    this.stage.draw(this.views.map((takes) => ({
      target: this.#target(takes),
      bodies: takes.map((take) => ({ pose: take.pose, figure: take.motion.figure, stripes: this.#faint(take) })),
    })), this.camera);
  }

  /** The second of two is striped and lighter; of many, each a little different. */
  #faint(take) {
    const k = this.takes.indexOf(take);
    return this.takes.length < 3 ? k : (k * 0.618) % 1;
  }

  /** Says what time it is, and draws. */
  #moved() {
    const [first] = this.takes;
    if (!first) {
      this.time.textContent = '';
      this.#refresh();
      this.#stale();
      return;
    }
    const words = this.takes.map((take, k) => {
      const frame = Math.round(this.#frame(k));
      return { frame, seconds: frame / take.clip.rate, text: `${inSeconds(frame / take.clip.rate)} · frame ${frame}` };
    });
    const { frame, seconds, text } = words[0];
    this.scrub.value = first.start + Math.round(this.clock * first.clip.rate);
    this.scrub.setAttribute('aria-valuetext', text);
    // Two parts that a narrow player sets below each other.
    this.time.replaceChildren(...text.split(' · ').map((part, k) =>
      make('span', {}, `${part} / ${k ? first.end - 1 : inSeconds((first.end - 1) / first.clip.rate)}`)));
    [...this.tags.children].forEach((tag, k) => {
      tag.lastChild.textContent = words[k].text;
      tag.dataset.frame = words[k].frame;
    });
    this.dispatchEvent(new CustomEvent('time', { detail: { clip: first.clip.id, frame, seconds } }));
    this.#stale();
  }
}

/** An item with what is known of its motion: where it stands, looks and goes. Metres, as in the source. */
function takeOf(item, motion) {
  const { clip } = motion;
  const start = Math.max(item.start ?? clip.start, clip.start);
  const end = Math.max(start + 1, Math.min(item.end ?? clip.end, clip.end));
  const take = { motion, clip, start, end, offset: item.offset_s ?? 0, pose: new Float32Array(motion.figure.points.length * 3) };
  take.from = motionFrame(take, start);
  take.to = motionFrame(take, end - 1);
  take.low = [Infinity, 0, Infinity];
  take.high = [-Infinity, 0, -Infinity];
  take.reach = 0.3;
  take.top = -Infinity;
  take.turn = [1, 0];
  take.shift = [0, 0, 0];
  const feet = [];
  const step = Math.max(1, (take.to - take.from) / LOOKS);
  for (let at = take.from; at <= take.to; at += step) {
    const root = rootAt(motion, at);
    if (!root) continue;
    take.first ??= root;
    take.heading ??= headingAt(motion, at);
    for (const k of [0, 2]) {
      take.low[k] = Math.min(take.low[k], root[k]);
      take.high[k] = Math.max(take.high[k], root[k]);
    }
    let lowest = Infinity;
    for (let point = 0; point < motion.figure.points.length; point++) {
      const p = pointAt(motion, Math.round(at), point);
      if (!p) continue;
      lowest = Math.min(lowest, p[1]);
      take.top = Math.max(take.top, p[1]);
      take.reach = Math.max(take.reach, Math.hypot(p[0] - root[0], p[2] - root[2]));
    }
    feet.push(lowest);
  }
  if (!take.first) Object.assign(take, { first: [0, 1, 0], low: [0, 0, 0], high: [0, 0, 0], top: 1.8 });
  take.heading ??= 0;
  // The floor is where the lowest points mostly are: a jump does not lift it, one stray frame does not lower it.
  feet.sort((a, b) => a - b);
  take.floor = (feet[Math.floor(feet.length * 0.05)] ?? 0) - 0.03;
  return take;
}

function motionFrame({ clip, motion }, frame) {
  return Math.min(((frame - clip.start) * motion.rate) / clip.rate, motion.frames - 1);
}

/** A point in metres, or null where it is missing. */
function pointAt({ data, figure, origin }, frame, point) {
  const at = (frame * figure.points.length + point) * 3;
  if (data[at] === MISSING) return null;
  return [0, 1, 2].map((k) => (data[at + k] + origin[k]) / 1000);
}

/** The root, or the middle of what is there. */
function rootAt(motion, at) {
  const frame = Math.round(at);
  const named = motion.figure.points.indexOf('root');
  const root = named >= 0 ? pointAt(motion, frame, named) : null;
  if (root) return root;
  const there = motion.figure.points.map((_, point) => pointAt(motion, frame, point)).filter(Boolean);
  return there.length ? [0, 1, 2].map((k) => there.reduce((sum, p) => sum + p[k], 0) / there.length) : null;
}

/** Where the hips face, turned about +Y from +Z. */
function headingAt(motion, at) {
  const [left, right] = ['lhip', 'rhip'].map((name) => {
    const point = motion.figure.points.indexOf(name);
    return point < 0 ? null : pointAt(motion, Math.round(at), point);
  });
  return left && right ? Math.atan2(right[2] - left[2], left[0] - right[0]) : null;
}

function placed({ turn: [c, s], shift }, [x, y, z]) {
  return [x * c + z * s + shift[0], y + shift[1], z * c - x * s + shift[2]];
}

/** Fills an item's pose for a source frame, between two frames of its motion if need be. */
function posed(take, frame) {
  const { motion, pose } = take;
  const at = motionFrame(take, frame);
  const [k, t] = [Math.floor(at), at % 1];
  for (let point = 0; point < motion.figure.points.length; point++) {
    const a = pointAt(motion, k, point);
    const b = a && t > 0 ? pointAt(motion, Math.min(k + 1, motion.frames - 1), point) : null;
    pose.set(a ? placed(take, b ? a.map((value, axis) => value + (b[axis] - value) * t) : a) : [NaN, NaN, NaN], point * 3);
  }
}

function corners(places) {
  return [Math.min, Math.max].map((most) => [0, 1, 2].map((k) => most(...places.map((place) => place[k]))));
}

/** The box that the items' roots stay in, placed. */
function bounds(takes) {
  return corners(takes.flatMap((take) => [[take.low[0], take.low[2]], [take.low[0], take.high[2]], [take.high[0], take.low[2]], [take.high[0], take.high[2]]]
    .map(([x, z]) => placed(take, [x, 0, z]))));
}

/** A path with a clock: each step takes as long as the slower item needs, so neither jumps where the other waits. */
function linkOf(path, [a, b]) {
  const clock = [0];
  for (let k = 1; k < path.length; k++) {
    clock.push(clock[k - 1] + Math.max((path[k][0] - path[k - 1][0]) / a.clip.rate, (path[k][1] - path[k - 1][1]) / b.clip.rate));
  }
  return { clock, frames: [0, 1].map((k) => path.map((pair) => pair[k])) };
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

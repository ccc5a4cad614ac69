/**
 * Shapes and units: `document.rs`.
 * @typedef {{points: string[], bones: {from: number, to: number, side: 'left'|'right'|'middle', width: number}[]}} Figure
 * @typedef {{id: number, name: string, label: ?string, rate: number, start: number, end: number, rig: ?string,
 *   figure: number, strip: ?object, motion: ?object}} Clip
 * @typedef {{clip: Clip, figure: Figure, rate: number, frames: number, origin: number[], data: Int16Array}} Motion
 */

/** In place of each coordinate of a missing point. */
export const MISSING = -32768;
/** Decoded motions that are kept; a page shows fewer at once. */
const KEPT_MOTIONS = 64;

/**
 * An element. Attributes that are functions are listeners; text is never read as HTML; null children are left out.
 * @param {string} tag
 * @param {Object<string, any>} attributes
 * @param {...(Node|string|null)} children
 */
export function make(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function') node.addEventListener(name, value);
    else if (value === true) node.setAttribute(name, '');
    else if (value != null && (value !== false || name.startsWith('aria-'))) node.setAttribute(name, value);
  }
  node.append(...children.filter((child) => child != null));
  return node;
}

/** `[{name, value}]` as a list. */
export function factList(facts) {
  return make('dl', {class: 'facts'}, ...facts.map(({name, value}) => make('div', {}, make('dt', {}, name), make('dd', {}, String(value)))));
}

/** Such as `3.93 s`. */
export function inSeconds(seconds) {
  return `${seconds.toFixed(2)} s`;
}

/** What people call a clip: the end of its path. */
export function shortName(clip) {
  return clip.name.split(/[\\/]/).pop();
}

/** @param {string} base64 */
export function bytesOf(base64) {
  return Uint8Array.from(atob(base64), (char) => char.charCodeAt(0));
}

/** Everything that pages show; in a live viewer it grows with each answer. */
export class Store {
  #motions = new Map();

  /** @param {object} contents a document */
  constructor(contents) {
    /** @type {Figure[]} */
    this.figures = [];
    /** @type {Map<number, Clip>} */
    this.clips = new Map();
    this.live = contents.live;
    this.title = contents.title;
    this.pages = this.merge(contents);
  }

  /** Adds an answer's figures and clips. Returns its pages. */
  merge({figures = [], clips = [], pages = []}) {
    const places = figures.map((figure) => {
      const same = this.figures.findIndex((other) => JSON.stringify(other) === JSON.stringify(figure));
      return same < 0 ? this.figures.push(figure) - 1 : same;
    });
    for (const clip of clips) {
      const {strip = null, motion = null} = this.clips.get(clip.id) ?? {};
      this.clips.set(clip.id, {...clip, figure: places[clip.figure], strip: clip.strip ?? strip, motion: clip.motion ?? motion});
    }
    return pages;
  }

  /**
   * What is played of a clip, or null if there is nothing to play.
   * @returns {Promise<?Motion>}
   */
  motion(id) {
    const motion = this.#motions.get(id) ?? this.#load(id);
    // A failed answer is asked for again the next time.
    motion.catch(() => this.#motions.delete(id));
    // The most recently used stands last.
    this.#motions.delete(id);
    this.#motions.set(id, motion);
    if (this.#motions.size > KEPT_MOTIONS) this.#motions.delete(this.#motions.keys().next().value);
    return motion;
  }

  async #load(id) {
    const clip = this.clips.get(id);
    if (!clip?.motion && !(clip && this.live)) return null;
    const figure = this.figures[clip.figure];
    if (clip.motion) return {...clip.motion, clip, figure, data: new Int16Array(bytesOf(clip.motion.bytes).buffer)};
    const answer = await answerTo(`/api/clips/${id}/motion`);
    const [rate, frames, origin] = ['rate', 'frames', 'origin'].map((name) => answer.headers.get(`motif-${name}`));
    return {clip, figure, rate: +rate, frames: +frames, origin: origin.split(',').map(Number), data: new Int16Array(await answer.arrayBuffer())};
  }

  /** Live only: the JSON at `/api/` and a path. Throws an Error whose `detail` is the JSON of the error. */
  async ask(path, params = {}) {
    const known = Object.entries(params).filter(([, value]) => value != null && value !== '');
    return (await answerTo(`/api/${path}?${new URLSearchParams(known)}`)).json();
  }
}

async function answerTo(address) {
  const answer = await fetch(address);
  if (answer.ok) return answer;
  const detail = await answer.json().catch(() => ({error: `the viewer answered ${answer.status}`}));
  throw Object.assign(new Error(detail.error), {detail});
}

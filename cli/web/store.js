/**
 * @typedef {{points: string[], bones: {from: number, to: number, side: 'left'|'right'|'middle', width: number}[]}} Figure
 * @typedef {{poses: number, bytes: string}} Strip
 * @typedef {{id: number, name: string, label: ?string, rate: number, start: number, end: number, rig: ?string,
 *   figure: number, strip: ?Strip, motion: ?{rate: number, frames: number, origin: number[], bytes: string}}} Clip
 * @typedef {{clip: Clip, figure: Figure, rate: number, frames: number, origin: number[], data: Int16Array}} Motion
 */

/** In place of each coordinate of a missing point. */
export const MISSING = -32768;

/** Decoded motions that are kept; a page shows fewer at once. */
const KEPT_MOTIONS = 64;

/**
 * An element. Attributes that are functions are listeners; text is never read as HTML.
 * @param {string} tag
 * @param {Object<string, any>} attributes
 * @param {...(Node|string|null)} children
 */
export function make(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function') node.addEventListener(name, value);
    else if (value === true) node.setAttribute(name, '');
    else if (value !== false && value != null) node.setAttribute(name, value);
  }
  node.append(...children.filter((child) => child != null));
  return node;
}

/** `[{name, value}]` as a list of facts. */
export function factList(facts) {
  return make('dl', { class: 'facts' }, ...facts.map(({ name, value }) =>
    make('div', {}, make('dt', {}, name), make('dd', {}, String(value)))));
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
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < bytes.length; k++) bytes[k] = text.charCodeAt(k);
  return bytes;
}

/** Everything that pages show; in a live viewer it grows with each answer. */
export class Store {
  #motions = new Map();

  /** @param {object} contents as `document.rs` */
  constructor(contents) {
    /** @type {Figure[]} */
    this.figures = [];
    /** @type {Map<number, Clip>} */
    this.clips = new Map();
    this.live = contents.live;
    this.title = contents.title;
    this.motif = contents.motif;
    this.pages = this.merge(contents);
  }

  /** Adds an answer's figures and clips. Returns its pages. */
  merge({ figures = [], clips = [], pages = [] }) {
    const place = figures.map((figure) => {
      const text = JSON.stringify(figure);
      const known = this.figures.findIndex((other) => JSON.stringify(other) === text);
      return known >= 0 ? known : this.figures.push(figure) - 1;
    });
    for (const clip of clips) {
      const known = this.clips.get(clip.id);
      this.clips.set(clip.id, {
        ...clip,
        figure: place[clip.figure],
        strip: clip.strip ?? known?.strip ?? null,
        motion: clip.motion ?? known?.motion ?? null,
      });
    }
    return pages;
  }

  /**
   * What is played of a clip, or null if there is nothing to play.
   * @returns {Promise<?Motion>}
   */
  motion(id) {
    let motion = this.#motions.get(id);
    if (motion) this.#motions.delete(id);
    else {
      motion = this.#load(id);
      // A failed answer is asked for again the next time.
      motion.catch(() => this.#motions.delete(id));
    }
    // The most recently used stands last.
    this.#motions.set(id, motion);
    if (this.#motions.size > KEPT_MOTIONS) this.#motions.delete(this.#motions.keys().next().value);
    return motion;
  }

  async #load(id) {
    const clip = this.clips.get(id);
    if (!clip) return null;
    const figure = this.figures[clip.figure];
    if (clip.motion) {
      const { rate, frames, origin, bytes } = clip.motion;
      return { clip, figure, rate, frames, origin, data: new Int16Array(bytesOf(bytes).buffer) };
    }
    if (!this.live) return null;
    const answer = await fetch(`/api/clips/${id}/motion`);
    if (answer.status === 404) return null;
    if (!answer.ok) throw await failureOf(answer);
    const header = (name) => answer.headers.get(`motif-${name}`);
    const data = new Int16Array(await answer.arrayBuffer());
    return { clip, figure, rate: +header('rate'), frames: +header('frames'), origin: header('origin').split(',').map(Number), data };
  }

  /** Live only: the JSON at `/api/` and a path. Throws an Error whose `detail` is the JSON of the error. */
  async ask(path, params = {}) {
    const known = Object.entries(params).filter(([, value]) => value != null && value !== '');
    const answer = await fetch(`/api/${path}?${new URLSearchParams(known)}`);
    if (!answer.ok) throw await failureOf(answer);
    return answer.json();
  }
}

async function failureOf(answer) {
  const detail = await answer.json().catch(() => ({ error: `the viewer answered ${answer.status}` }));
  return Object.assign(new Error(detail.error), { detail });
}

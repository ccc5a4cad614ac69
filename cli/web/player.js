import {make, inSeconds, shortName} from './store.js';

/**
 * The one player of the page. Events: `time`, with detail `{clip, frame, seconds}` of the first item in its source's time.
 * @typedef {{clip: number, start?: number, end?: number, offset_s?: number}} Item source frames, end exclusive
 */
export class Player extends EventTarget {
  constructor(host, store) {
    super();
    this.host = host;
    this.store = store;
    this.playing = false;
  }

  /**
   * @param {Item[]} items
   * @param {{layout?: 'side'|'overlay', path?: number[][], title?: string}} options
   */
  async show(items, options = {}) {}

  /** @param {number} seconds of the first item's source */
  seek(seconds) {}

  /** @param {number} frame of the first item's source */
  seekFrame(frame) {}

  play() {}

  pause() {}

  /** Whether the key was one of the player's. */
  key(event) {
    return false;
  }
}

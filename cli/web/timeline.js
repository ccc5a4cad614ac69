// A clip's time as an axis, with labelled spans over it and one that can be dragged.

import {make, inSeconds} from './store.js';
import {steppedBy} from './plot.js';

/** Okabe and Ito's colours that differ for all kinds of colour vision; stripes after that. */
const N_TONES = 7;

/** A pointer that moves less than this many pixels clicks, else it drags. */
const CLICK_SLACK = 4;

/** Class names that colour the label with this number. */
export function toneClass(number) {
  return `tone tone-${number % N_TONES}${Math.floor(number / N_TONES) % 2 ? ' striped' : ''}`;
}

/**
 * Events: `seek` {frame, seconds}; `span` {start, end} in source frames, or null when it is cleared; `pick`, a span of a
 * track. The arrows move the cursor; with shift they extend the span, as text is selected.
 */
export class Timeline extends EventTarget {
  /**
   * @param {{rate: number, start: number, end: number, label: string, select?: boolean,
   *   tracks?: {label: string, spans: {start: number, end: number, title: string}[]}[]}} options source frames
   */
  constructor({rate, start, end, label, select = false, tracks = []}) {
    super();
    Object.assign(this, {rate, start, end, select, frame: start, span: null, anchor: null});
    this.now = make('output', {class: 'tl-now', 'data-testid': 'cursor'});
    this.chosen = make('output', {class: 'tl-chosen', 'aria-live': 'polite'});
    this.ticks = make('div', {class: 'tl-ticks', 'aria-hidden': 'true'});
    this.box = make('div', {class: 'tl-box', hidden: true}, make('i', {class: 'tl-handle'}), make('i', {class: 'tl-handle'}));
    this.cursor = make('i', {class: 'tl-cursor'});
    this.surface = make('div', {
      class: 'tl-surface', tabindex: 0, role: 'slider', 'aria-label': label, 'aria-valuemin': start, 'aria-valuemax': end,
      'data-testid': select ? 'span-drag' : null,
    }, this.ticks, this.box);
    this.body = make('div', {class: 'tl-body'}, this.surface, ...tracks.map((track, number) => this.#lane(track, number)), this.cursor);
    const zoom = (text, name, factor) => make('button', {type: 'button', 'aria-label': name, click: () => this.#zoom(factor)}, text);
    this.scroll = make('div', {class: 'tl-scroll'}, this.body);
    this.element = make('div', {class: `timeline${select ? ' selects' : ''}`, 'data-testid': 'timeline'},
      make('div', {class: 'tl-head'}, this.now, this.chosen, zoom('−', 'Shorter', 0.5), zoom('+', 'Longer', 2)), this.scroll);
    this.zoom = 1;
    this.#listen();
    new ResizeObserver(() => this.#drawTicks()).observe(this.surface);
    this.setTime(start / rate);
  }

  /** Moves the cursor. @param {number} seconds */
  setTime(seconds) {
    this.frame = Math.min(this.end, Math.max(this.start, Math.round(seconds * this.rate)));
    this.cursor.style.left = this.#across(this.frame);
    const text = `${inSeconds(this.frame / this.rate)} · frame ${this.frame}`;
    this.now.textContent = text;
    this.surface.setAttribute('aria-valuenow', this.frame);
    this.surface.setAttribute('aria-valuetext', text);
  }

  /** Chooses source frames, or none, and tells so. @param {number} [a] @param {number} [b] */
  setSpan(a, b) {
    const [start, end] = [Math.min(a, b), Math.max(a, b)];
    this.span = end > start ? {start, end} : null;
    this.box.hidden = !this.span;
    this.chosen.textContent = '';
    if (this.span) {
      this.box.style.left = this.#across(start);
      this.box.style.width = `${(end - start) / (this.end - this.start) * 100}%`;
      this.chosen.textContent = `${(start / this.rate).toFixed(2)}–${inSeconds(end / this.rate)} · frames ${start}–${end}`;
    }
    this.#tell('span', this.span);
  }

  #tell(name, detail) {
    this.dispatchEvent(new CustomEvent(name, {detail}));
  }

  #across(frame) {
    return `${(frame - this.start) / Math.max(1, this.end - this.start) * 100}%`;
  }

  #lane({label, spans}, number) {
    const lane = make('div', {class: 'tl-lane'}, ...spans.map((span) => {
      const button = make('button', {
        type: 'button', class: `tl-span ${toneClass(number)}`, title: span.title, 'data-testid': 'span',
        'aria-label': `${label}, ${span.title}`, click: () => this.#tell('pick', span),
      }, label);
      button.style.left = this.#across(span.start);
      button.style.width = `${(span.end - span.start) / Math.max(1, this.end - this.start) * 100}%`;
      return button;
    }));
    return make('div', {class: 'tl-track', role: 'group', 'aria-label': label, 'data-testid': 'track'},
      make('span', {class: 'tl-name'}, label), lane);
  }

  #seek(frame) {
    this.setTime(frame / this.rate);
    this.#tell('seek', {frame, seconds: frame / this.rate});
  }

  #frameAt(event) {
    const box = this.surface.getBoundingClientRect();
    const share = Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
    return Math.round(this.start + share * (this.end - this.start));
  }

  #listen() {
    const {surface} = this;
    let from = null;
    surface.onpointerdown = (event) => {
      if (event.button) return;
      surface.setPointerCapture(event.pointerId);
      from = event.clientX;
      const handle = [...this.box.children].indexOf(event.target);
      // The end that is not held stays.
      this.anchor = handle < 0 ? this.#frameAt(event) : handle ? this.span.start : this.span.end;
      if (!this.select) this.#seek(this.anchor);
    };
    surface.onpointermove = (event) => {
      if (from == null || !event.buttons) return;
      if (!this.select) this.#seek(this.#frameAt(event));
      else if (Math.abs(event.clientX - from) >= CLICK_SLACK || from === Infinity) {
        from = Infinity;
        const frame = this.#frameAt(event);
        this.setSpan(this.anchor, frame);
        this.#seek(frame);
      }
    };
    surface.onpointerup = (event) => {
      if (from != null && from !== Infinity) this.#seek(this.#frameAt(event));
      from = null;
    };
    surface.onkeydown = (event) => {
      if (event.key === 'Escape' && this.span) this.setSpan();
      const extend = this.select && event.shiftKey;
      const paged = {key: event.key, shiftKey: event.shiftKey && !extend};
      const frame = steppedBy(paged, this.frame, 1, this.start, this.end);
      if (frame == null) return;
      event.stopPropagation();
      event.preventDefault();
      // A span that the cursor is at the end of goes on from there, any other begins at the cursor.
      if (extend) {
        const {span} = this;
        this.setSpan(span?.end === this.frame ? span.start : span?.start === this.frame ? span.end : this.frame, frame);
      }
      this.#seek(frame);
    };
  }

  #zoom(factor) {
    this.zoom = Math.min(32, Math.max(1, this.zoom * factor));
    this.body.style.width = `${this.zoom * 100}%`;
    this.scroll.scrollLeft = (this.frame - this.start) / (this.end - this.start) * this.body.clientWidth - this.scroll.clientWidth / 2;
  }

  /** Ticks at round seconds, as many as have room. */
  #drawTicks() {
    const {rate, start, end, surface} = this;
    const wanted = (end - start) / rate / Math.max(1, surface.clientWidth / 90);
    const power = 10 ** Math.floor(Math.log10(wanted || 1));
    const step = power * [1, 2, 5, 10].find((factor) => factor * power >= wanted);
    const digits = Math.max(0, -Math.floor(Math.log10(step)));
    const ticks = [];
    for (let k = Math.ceil(start / rate / step); k * step <= end / rate; k++) {
      const frame = Math.round(k * step * rate);
      const tick = make('span', {}, `${(k * step).toFixed(digits)} s`, make('small', {}, String(frame)));
      tick.style.left = this.#across(frame);
      ticks.push(tick);
    }
    this.ticks.replaceChildren(...ticks);
  }
}

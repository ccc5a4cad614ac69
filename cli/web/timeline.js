import {make, inSeconds} from './store.js';
import {spanText, stepped} from './plot.js';

/** Colours in the style sheet that differ for every kind of colour vision; stripes after them. */
const N_TONES = 7;
/** A pointer that moves less, in pixels, clicks. */
const SLACK = 4;

/** Classes that colour a label by its place. */
export const toneOf = (k) => `tone tone-${k % N_TONES}${Math.floor(k / N_TONES) % 2 ? ' striped' : ''}`;

/**
 * The time of a clip with tracks of labelled spans, and a span to choose if it `selects`: by a drag, by its handles, or by
 * the arrows with shift, as text is selected. Frames are the source's. Events: `seek` {frame, seconds}; `span` {start, end},
 * or null for none; `pick`, a span of a track.
 */
export class Timeline extends EventTarget {
  /** @param {{clip: Clip, label: string, selects?: boolean, tracks?: {label: string, spans: {start: number, end: number, title: string}[]}[]}} options */
  constructor({clip: {rate, start, end}, label, selects = false, tracks = []}) {
    super();
    Object.assign(this, {rate, start, end, selects, frame: start, span: null});
    this.chosen = make('output', {class: 'number small'});
    this.ticks = make('div', {class: 'tl-ticks', 'aria-hidden': 'true'});
    this.handles = ['tl-handle', 'tl-handle tl-last'].map((name) => make('i', {class: name}));
    this.box = make('div', {class: 'tl-box', hidden: true}, ...this.handles);
    this.cursor = make('i', {class: 'tl-cursor'});
    this.surface = make('div', {
      class: `tl-surface${selects ? ' selects' : ''}`, tabindex: 0, role: 'slider', 'aria-label': label, 'aria-valuemin': start, 'aria-valuemax': end,
      'data-testid': selects ? 'span-drag' : null, keydown: (event) => this.#key(event),
    }, this.ticks, this.box);
    const lanes = tracks.map((track, k) => make('div', {role: 'group', 'aria-label': track.label, 'data-testid': 'track'},
      make('span', {class: 'small muted'}, track.label), make('div', {class: 'tl-lane'}, ...track.spans.map((span) => this.#button(span, track.label, k)))));
    this.element = make('div', {'data-testid': 'timeline'}, make('div', {class: 'timeline'}, this.surface, ...lanes, this.cursor), this.chosen);
    this.#listen();
    new ResizeObserver(() => this.#drawTicks()).observe(this.surface);
    this.setTime(start / rate);
  }

  /** Moves the cursor. @param {number} seconds */
  setTime(seconds) {
    this.frame = Math.min(this.end, Math.max(this.start, Math.round(seconds * this.rate)));
    this.cursor.style.left = this.#across(this.frame);
    this.surface.setAttribute('aria-valuenow', this.frame);
    this.surface.setAttribute('aria-valuetext', `${inSeconds(this.frame / this.rate)}, frame ${this.frame}`);
  }

  /** Chooses the frames between two, or none. */
  setSpan(a, b) {
    const [start, end] = [Math.min(a, b), Math.max(a, b)];
    this.span = end > start ? {start, end} : null;
    this.box.hidden = !this.span;
    this.chosen.textContent = this.span ? spanText({start, end, start_s: start / this.rate, end_s: end / this.rate}) : '';
    if (this.span) this.#lay(this.box, this.span);
    this.#tell('span', this.span);
  }

  #tell(name, detail) {
    this.dispatchEvent(new CustomEvent(name, {detail}));
  }

  #across(frame) {
    return `${((frame - this.start) / Math.max(1, this.end - this.start)) * 100}%`;
  }

  #lay(element, {start, end}) {
    element.style.left = this.#across(start);
    element.style.width = this.#across(this.start + end - start);
  }

  #button(span, label, k) {
    const button = make('button', {type: 'button', class: `tl-span ${toneOf(k)}`, title: span.title, 'data-testid': 'span', click: () => this.#tell('pick', span)}, label);
    this.#lay(button, span);
    return button;
  }

  #seek(frame) {
    const seconds = frame / this.rate;
    this.setTime(seconds);
    this.#tell('seek', {frame, seconds});
  }

  #listen() {
    const {surface} = this;
    let fixed = 0;
    let pressed = null;
    const frameAt = ({clientX}) => {
      const {left, width} = surface.getBoundingClientRect();
      return Math.round(this.start + Math.min(1, Math.max(0, (clientX - left) / width)) * (this.end - this.start));
    };
    surface.onpointerdown = (event) => {
      surface.setPointerCapture(event.pointerId);
      pressed = event.clientX;
      // Of a handle's span the other end stays.
      const handle = this.handles.indexOf(event.target);
      fixed = handle < 0 ? frameAt(event) : handle ? this.span.start : this.span.end;
      if (handle < 0) this.#seek(fixed);
    };
    surface.onpointermove = (event) => {
      if (pressed == null || Math.abs(event.clientX - pressed) < SLACK) return;
      pressed = -Infinity;
      const frame = frameAt(event);
      if (this.selects) this.setSpan(fixed, frame);
      this.#seek(frame);
    };
    surface.onpointerup = surface.onpointercancel = () => { pressed = null; };
  }

  #key(event) {
    const extends_ = this.selects && event.shiftKey;
    if (event.key === 'Escape') this.setSpan();
    const {frame: at, span} = this;
    const frame = stepped(event, at, 1, this.start, this.end, !extends_ && event.shiftKey);
    if (frame == null) return;
    // A span goes on from the end where the cursor is; elsewhere a new one begins.
    if (extends_) this.setSpan(span?.end === at ? span.start : span?.start === at ? span.end : at, frame);
    this.#seek(frame);
  }

  /** Round seconds, as many as have room. */
  #drawTicks() {
    const {rate, start, end} = this;
    const wanted = ((end - start) / rate / Math.max(1, this.surface.clientWidth)) * 90 || 1;
    const power = 10 ** Math.floor(Math.log10(wanted));
    const step = power * [1, 2, 5, 10].find((factor) => factor * power >= wanted);
    const ticks = [];
    for (let k = Math.ceil(start / rate / step); k * step * rate < end; k++) {
      const frame = Math.round(k * step * rate);
      const tick = make('span', {}, `${+(k * step).toFixed(3)} s`, make('small', {}, String(frame)));
      tick.style.left = this.#across(frame);
      ticks.push(tick);
    }
    this.ticks.replaceChildren(...ticks);
  }
}

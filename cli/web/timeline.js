import {clamp, make, moment} from './store.js';
import {lay, pointed, spanText, stepped, timeTicks} from './plot.js';

/** Pixels: a pointer that moves less clicks, and one that is as near to an end of a span moves that end. */
const NEAR = 8;

/**
 * The time of a clip with tracks of labelled spans. With `onSpan` a span can be chosen: by a drag, or by the arrows with
 * shift, as text is selected. Frames are the source's.
 * @typedef {{start: number, end: number, title?: string}} Span
 * @param {{clip: Clip, label: string, onSeek: function(number): void, onSpan?: function(Span): void,
 *   onPick?: function(Span): void, tracks?: {label: string, spans: Span[]}[]}} options
 * @returns {HTMLElement & {setTime: function(number): void}} times in seconds
 */
export function clipTimeline({clip: {rate, start, end}, label, onSeek, onSpan, onPick, tracks = []}) {
	let frame = start;
	let span = null;
	let fixed = start;

	const cursor = make('i.cursor');
	const box = make('div.tl-box', {hidden: true});
	const chosen = make('output.small');
	const face = make('div.face.tl-face', {
		tabindex: 0, role: 'slider', label, 'aria-valuemin': start, 'aria-valuemax': end,
		testid: onSpan ? 'span-drag' : null, keydown, pointerdown, pointermove,
	}, timeTicks(start / rate, end / rate, rate), box);
	const layFrames = (element, from, to) => lay(element, ...[from, to].map((at) => (at - start) / Math.max(1, end - start)));
	const lanes = tracks.map((track) => make('div', {role: 'group', label: track.label},
		make('small', track.label),
		make('div.tl-lane', ...track.spans.map((each) => layFrames(
			make('button', {title: each.title, testid: 'span', click: () => onPick(each)}), each.start, each.end)))));

	function choose(from, to) {
		span = {start: Math.min(from, to), end: Math.max(from, to)};
		box.hidden = from === to;
		layFrames(box, span.start, span.end);
		chosen.textContent = spanText(span, {rate});
		onSpan(span);
	}
	function seek(at) {
		element.setTime(at / rate);
		onSeek(at / rate);
	}
	/** The end of the span that stays if the one near a frame is moved. */
	const otherEnd = (at, near) => (Math.abs(at - span?.end) <= near ? span.start : Math.abs(at - span?.start) <= near ? span.end : at);
	const frameAt = (event) => Math.round(start + pointed(event, face)[0] * (end - start));
	const nearFrames = () => (NEAR / face.clientWidth) * (end - start);
	function pointerdown(event) {
		face.setPointerCapture(event.pointerId);
		const at = frameAt(event);
		fixed = otherEnd(at, nearFrames());
		seek(at);
	}
	function pointermove(event) {
		if (!face.hasPointerCapture(event.pointerId)) return;
		const at = frameAt(event);
		if (onSpan && Math.abs(at - fixed) > nearFrames()) choose(fixed, at);
		seek(at);
	}
	function keydown(event) {
		const at = stepped(event, frame, 1, start, end);
		if (at === undefined) return;
		if (onSpan && event.shiftKey) choose(otherEnd(frame, 0), at);
		seek(at);
	}

	const element = make('div', make('div.timeline', face, ...lanes, cursor), chosen);
	element.setTime = (seconds) => {
		frame = clamp(Math.round(seconds * rate), start, end);
		layFrames(cursor, frame, frame);
		face.ariaValueNow = frame;
		face.ariaValueText = moment(frame / rate, rate);
	};
	element.setTime(start / rate);
	return element;
}

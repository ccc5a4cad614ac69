import {make, factList, shortName, inSeconds} from '../store.js';
import {counted, follow, playedPlot, seekIn, short, spanText} from '../plot.js';
import {clipTimeline} from '../timeline.js';

/** A track per label over playback, and the curve that each label was read off. */
export function renderAnnotationPage(page, ctx) {
	const {store, player} = ctx;
	const clip = store.clips.get(page.clip);
	const {id, rate, start, end} = clip;
	let now = start / rate;

	const timeline = clipTimeline({
		clip, label: 'Time in the clip',
		tracks: page.tracks.map(({label, spans}) => ({
			label, spans: spans.map((span) => ({...span, title: `${label} · ${spanText(span)} · cost ${short(span.cost)}`})),
		})),
		onSeek: (seconds) => seekIn(player, clip, seconds),
		onPick: (span) => player.show([{clip: id, start: span.start, end: span.end}], {title: span.title, play: true}),
	});
	const curves = page.tracks.map(({label, tau, spans, curve}, k) => {
		if (!curve) return null;
		// Drawn when it is looked at: there may be a hundred labels.
		const toggle = ({target}) => {
			if (!target.open || target.children[1]) return;
			const plot = playedPlot(curve, clip, `Δ of ${label}`, ctx);
			plot.setTime(now);
			target.append(plot);
		};
		return make('details', {open: k === 0, toggle}, make('summary', {}, label,
			make('span', {class: 'muted small number'}, ` ${tau == null ? '' : `τ ${short(tau)} · `}${counted(spans.length, 'span')}`)));
	});
	follow(ctx, ({clip: playing, seconds}) => {
		if (playing === id) timeline.setTime(now = seconds);
	});
	return make('section', {class: 'panel stack'},
		make('h2', {}, shortName(clip)),
		factList([
			{name: 'length', value: `${inSeconds((end - start) / rate)} · ${end - start} frames`},
			{name: 'labels', value: page.tracks.length},
			{name: 'spans', value: page.tracks.reduce((sum, {spans}) => sum + spans.length, 0)},
		]),
		timeline, ...curves);
}

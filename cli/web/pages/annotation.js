import {factList, lengthOf, make, panel, shortName} from '../store.js';
import {counted, follow, playedPlot, seekIn, short, spanText} from '../plot.js';
import {clipTimeline} from '../timeline.js';

/** A track per label over playback, and the curve that each label was read off. */
export function renderAnnotationPage({clip: id, tracks}, ctx) {
	const {store, player} = ctx;
	const clip = store.clips.get(id);

	const timeline = clipTimeline({
		clip, label: 'Time in the clip',
		tracks: tracks.map(({label, spans}) => ({
			label, spans: spans.map((span) => ({...span, title: `${label} · ${spanText(span, clip)} · cost ${short(span.cost)}`})),
		})),
		onSeek: (seconds) => seekIn(player, clip, seconds),
		onPick: ({start, end, title}) => player.show([{clip: id, start, end}], {title, play: true}),
	});
	const curves = tracks.map(({label, tau, spans, curve}, k) => {
		if (!curve) return null;
		// Drawn when it is looked at: there may be a hundred labels.
		const toggle = ({target}) => {
			if (target.open && !target.children[1]) target.append(playedPlot(curve, clip, `Δ of ${label}`, ctx));
		};
		return make('details', {open: k === 0, toggle}, make('summary', label,
			make('small', ` ${tau == null ? '' : `τ ${short(tau)} · `}${counted(spans.length, 'span')}`)));
	});
	follow(ctx, ({clip: playing, seconds}) => playing === id && timeline.setTime(seconds));
	return panel(shortName(clip),
		factList({length: lengthOf(clip), labels: tracks.length, spans: tracks.flatMap(({spans}) => spans).length}),
		timeline, ...curves);
}

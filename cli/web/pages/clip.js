import {make, factList, inSeconds, shortName} from '../store.js';
import {drawStrip, onTheme} from '../strip.js';
import {picturePlot} from '../plot.js';

/** Plots of `[label, picture or null]` that seek in a clip and show where its playback is. */
export function plotsOf(clip, pictures, {player, store}) {
	return pictures.filter(([, picture]) => picture).map(([label, picture]) => {
		const plot = picturePlot(picture, {label, rate: store.clips.get(clip).rate, onSeek: (seconds) => player.seek(seconds)});
		player.addEventListener('time', ({detail}) => detail.clip === clip && plot.setTime(detail.seconds));
		return make('section', {class: 'panel stack'}, make('h3', {}, label), plot);
	});
}

/** Plays a clip and goes to its page. */
export async function openClip(id, ctx) {
	const {store} = ctx;
	const its = ({kind, clip}) => kind === 'clip' && clip === id;
	const {hash} = location;
	const page = store.pages.find(its) ?? (ctx.live && store.merge(await store.ask(`clips/${id}`)).find(its));
	// Who went elsewhere meanwhile stays there.
	if (location.hash !== hash) return;
	ctx.open(page || {kind: 'clip', clip: id});
	ctx.player.show([{clip: id}], {play: true});
}

export function renderClipPage(page, ctx) {
	const clip = ctx.store.clips.get(page.clip);
	const frames = clip.end - clip.start;
	const strip = clip.strip && make('canvas', {class: 'strip', role: 'img', 'aria-label': 'Poses'});
	if (strip) {
		const draw = () => strip.clientWidth && drawStrip(strip, clip.strip, ctx.store.figures[clip.figure]);
		new ResizeObserver(draw).observe(strip);
		onTheme(draw);
	}
	const facts = {
		label: clip.label,
		length: inSeconds(frames / clip.rate),
		frames: clip.start ? `${frames}, from ${clip.start} to ${clip.end - 1}` : frames,
		'frames per second': +clip.rate.toFixed(3),
		rig: clip.rig,
	};
	return make('article', {class: 'stack'},
		make('header', {class: 'panel stack'},
			make('h2', {}, shortName(clip)),
			make('p', {class: 'muted small'}, clip.name),
			strip,
			factList(Object.entries(facts).filter(([, value]) => value != null).map(([name, value]) => ({name, value})))),
		...plotsOf(clip.id, [['Features', page.features]], ctx));
}

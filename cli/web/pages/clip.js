import {factList, lengthOf, make, panel, shortName} from '../store.js';
import {onTheme, stripOf} from '../strip.js';
import {playedPlot} from '../plot.js';

/** Plots of a clip's pictures by name, without those that are null. */
export function plotsOf(clip, pictures, ctx) {
	return Object.entries(pictures).map(([name, picture]) => picture && make('section.panel.stack', make('h3', name), playedPlot(picture, clip, name, ctx)));
}

/** Plays a clip and goes to its page. */
export async function openClip(id, ctx) {
	const {store} = ctx;
	const its = ({kind, clip}) => kind === 'clip' && clip === id;
	const {hash} = location;
	const page = store.pages.find(its) ?? (store.live && store.merge(await store.ask(`clips/${id}`)).find(its));
	// Who went elsewhere meanwhile stays there.
	if (location.hash !== hash) return;
	ctx.open(page || {kind: 'clip', clip: id});
	ctx.player.show([{clip: id}], {play: true});
}

export function renderClipPage(page, ctx) {
	const clip = ctx.store.clips.get(page.clip);
	const {name, label, rate, start, rig} = clip;
	const strip = make('div', stripOf(clip, ctx.store));
	onTheme(() => strip.replaceChildren(stripOf(clip, ctx.store)));
	return make('article.stack',
		panel(shortName(clip), make('p.note', name), strip, factList({
			label,
			length: lengthOf(clip),
			'first frame': start || null,
			'frames per second': +rate.toFixed(3),
			rig,
		})),
		...plotsOf(clip, {Features: page.features}, ctx));
}

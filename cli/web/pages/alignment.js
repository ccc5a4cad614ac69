import {make, factList, shortName} from '../store.js';
import {plotsOf} from './clip.js';

export function renderAlignmentPage(page, ctx) {
	const {a, b, path} = page;
	const items = [a, b].map((clip, side) => ({clip, start: path[0][side], end: path.at(-1)[side] + 1}));
	const [first, second] = [a, b].map((id) => shortName(ctx.store.clips.get(id)));
	ctx.player.show(items, {layout: 'side', path});
	return make('article', {class: 'stack'},
		make('header', {class: 'panel stack'},
			make('h2', {}, `${first} aligned with ${second}`),
			make('p', {class: 'muted small'}, 'Both play along the warping path, side by side or overlaid (o).'),
			factList(page.facts)),
		...plotsOf(a, [['Distance along the path', page.cost], ['Distance per body point', page.points]], ctx));
}

import {factList, make, panel, shortName} from '../store.js';
import {plotsOf} from './clip.js';

export function renderAlignmentPage({a, b, path, facts, cost, points}, ctx) {
	const clips = [a, b].map((id) => ctx.store.clips.get(id));
	const items = clips.map(({id}, side) => ({clip: id, start: path[0][side], end: path.at(-1)[side] + 1}));
	ctx.player.show(items, {layout: 'side', path});
	return make('article.stack',
		panel(clips.map(shortName).join(' aligned with '),
			make('p.note', 'Both play along the warping path, side by side or overlaid (o).'),
			factList(facts)),
		...plotsOf(clips[0], {'Distance along the path': cost, 'Distance per body point': points}, ctx));
}

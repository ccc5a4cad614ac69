import {make, factList, shortName} from '../store.js';
import {counted, lay, playedPlot, short, spanText} from '../plot.js';

/** Hits in order; one that is opened plays beside the example and shows where it agrees. */
export function renderSearchPage({title, query, example, n_hits, hits}, ctx) {
	const {store, player} = ctx;
	const entries = hits.map((hit) => {
		const clip = store.clips.get(hit.clip);
		const {start, end, rank, agreement} = hit;
		const share = (frame) => (frame - start) / Math.max(1, end - start);
		const segments = hit.segments.map(([from, to]) => lay(make('i', {title: `frames ${from}–${to}`}), share(from), share(to)));
		const chips = [clip.label, hit.mirrored ? 'mirrored' : null].map((text) => text && make('span', {class: 'chip'}, text));
		function toggle({target}) {
			if (!target.open) return;
			if (agreement && !target.children[1]) target.append(playedPlot(agreement, clip, `Hit ${rank}`, ctx));
			const items = [{clip: clip.id, start, end}];
			const options = {title: `${rank}. ${shortName(clip)}`, play: true};
			if (example) {
				items.push({clip: example.clip, start: example.start, end: example.end});
				// From end to end, so that what corresponds is seen at once however long the two take.
				options.path = [[start, example.start], [end - 1, example.end - 1]];
				options.layout = player.takes.length === 2 ? player.layout : 'side';
				options.title += ' and the example';
			}
			player.show(items, options);
		}
		return make('details', {name: 'hits', toggle}, make('summary', {class: 'hit number', 'data-testid': 'hit', 'data-rank': rank},
			make('span', {class: 'muted'}, String(rank)),
			make('span', {class: 'bar'}, make('strong', {title: clip.name}, shortName(clip)), ...chips),
			make('span', {}, make('small', {class: 'muted'}, 'cost '), short(hit.cost)),
			make('span', {class: 'muted small'}, spanText(hit)), make('span', {class: 'segments', 'aria-hidden': 'true'}, ...segments)));
	});
	const all = counted(n_hits, 'hit');
	const colours = hits.some(({agreement}) => agreement?.values.codes) ? ' · blue agrees, orange does not; what is pale is not compared, what is white is not known' : '';
	return make('section', {class: 'panel stack found'},
		make('h2', {}, title),
		factList(query),
		make('p', {class: 'muted small', role: 'status'}, (hits.length < n_hits ? `The first ${hits.length} of ${all}` : all) + colours),
		make('div', {}, ...entries),
		n_hits ? null : make('p', {class: 'empty'}, 'Nothing was found.'));
}

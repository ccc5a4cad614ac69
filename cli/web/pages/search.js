import {factList, make, panel, shortName} from '../store.js';
import {counted, lay, playedPlot, short, spanText} from '../plot.js';

/** Hits in order; one that is opened plays beside the example and shows where it agrees. */
export function renderSearchPage({title, query, example, n_hits, hits}, ctx) {
	const {store, player} = ctx;
	const entries = hits.map((hit) => {
		const clip = store.clips.get(hit.clip);
		const {start, end, rank, path} = hit;
		const share = (frame) => (frame - start) / Math.max(1, end - start);
		const segments = hit.segments.map(([from, to]) => lay(make('i', {title: `frames ${from}–${to}`}), share(from), share(to)));
		const chips = [clip.label, hit.mirrored ? 'mirrored' : null].map((text) => text && make('span.chip', text));
		const agreement = make('div');
		let asked = false;

		async function agree() {
			if (asked) return;
			asked = true;
			try {
				const picture = hit.agreement ?? (hit.ask && (await store.ask(hit.ask)).agreement);
				if (!picture) return agreement.replaceChildren();
				agreement.replaceChildren(make('div.stack',
					picture.values.codes && make('p.note', example ? 'Blue agrees, orange does not; what is pale is not compared, what is white is not known.'
						: 'Dark blue is on, light blue off, as asked; orange is not as asked.'),
					playedPlot(picture, clip, `Hit ${rank}`, ctx)));
			} catch ({message}) {
				agreement.replaceChildren(make('p.error', {role: 'alert'}, message));
				// The next opening asks again.
				asked = false;
			}
		}
		function toggle({target}) {
			if (!target.open) return;
			agree();
			const items = [{clip: clip.id, start, end}];
			const options = {title: `${rank}. ${shortName(clip)}`, play: true};
			if (example) {
				items.push(example);
				options.path = path;
				options.layout = player.takes.length === 2 ? player.layout : 'side';
				options.title += ' and the example';
			}
			player.show(items, options);
		}
		return make('details', {name: 'hits', toggle},
			make('summary.hit', {testid: 'hit', 'data-rank': rank},
				make('span.muted', rank),
				make('span.bar', make('strong', {title: clip.name}, shortName(clip)), ...chips),
				make('span', make('small', 'cost '), short(hit.cost)),
				make('small', spanText(hit, clip)), make('span.segments', ...segments)),
			agreement);
	});
	const all = n_hits ? counted(n_hits, 'hit') : 'Nothing was found.';
	return panel(title,
		factList(query),
		make('p.note', {role: 'status'}, hits.length < n_hits ? `The first ${hits.length} of ${all}` : all),
		make('div', ...entries));
}

import {factList, inSeconds, lengthOf, make, panel, shortName} from '../store.js';
import {onTheme, stripOf} from '../strip.js';
import {openClip} from './clip.js';

/** Clips asked for at once. */
const BLOCK = 40;

const SORTS = {name: ({name}) => name, label: ({label}) => label ?? '', seconds: ({start, end, rate}) => (end - start) / rate};

function clipCard(clip, ctx) {
	return make('button.stack.card', {testid: 'clip-row', 'data-clip': clip.id, title: clip.name, click: () => openClip(clip.id, ctx)},
		stripOf(clip, ctx.store),
		make('strong', shortName(clip)),
		make('span.bar.note', clip.label && make('span.chip', clip.label), lengthOf(clip), make('span.rig', clip.rig ?? 'no rig')));
}

/** A contact sheet. Only the cards in sight exist, and live only the clips around them are asked for. */
export function renderLibraryPage(page, ctx) {
	const {store, player} = ctx;
	// Of the present query: the clips by place as far as they are known, and the blocks that were asked for.
	let query, clips, asked, failure, places;
	let total = page.n_clips;
	const inSight = new Set();
	const sight = new IntersectionObserver((changes) => {
		for (const {target, isIntersecting} of changes) {
			if (isIntersecting && places.has(target)) inSight.add(target);
			else if (!target.contains(document.activeElement) && inSight.delete(target)) target.replaceChildren();
		}
		fill();
	});
	const sheet = make('div.sheet');
	const count = make('p.note', {role: 'status'});
	const filter = make('input', {type: 'search', placeholder: 'Filter by name', testid: 'filter', input: choose});
	const list = (label, options) => make('select', {label, change: choose}, ...options.map(([value, text]) => make('option', {value}, text)));
	const label = list('Label', [['', 'All labels'], ...page.labels.map((name) => [name, name])]);
	const sort = list('Sort by', Object.keys(SORTS).map((name) => [name, `by ${name}`]));
	const down = make('button', {'aria-pressed': 'false', label: 'Descending', title: 'Descending', click() {
		down.ariaPressed = down.ariaPressed !== 'true';
		choose();
	}}, '↓');

	function choose() {
		query = {sort: sort.value, down: +(down.ariaPressed === 'true'), label: label.value, text: filter.value};
		[clips, asked] = [[], new Set()];
		if (store.live) return fetchBlock(0);
		const value = SORTS[query.sort];
		const sign = query.down ? -1 : 1;
		clips = [...store.clips.values()]
			.filter((clip) => clip.strip && (!query.label || clip.label === query.label) && clip.name.toLowerCase().includes(query.text.toLowerCase()))
			.sort((a, b) => (value(a) < value(b) ? -sign : value(a) > value(b) ? sign : a.id - b.id));
		total = clips.length;
		layOut();
	}

	async function fetchBlock(from) {
		const present = query;
		asked.add(from);
		const answer = await store.ask('clips', {from, n: BLOCK, ...query}).catch(({message}) => ({total: 0, clips: [], failure: message}));
		store.merge(answer);
		if (present !== query) return;
		({total, failure} = answer);
		answer.clips.forEach(({id}, k) => { clips[from + k] = store.clips.get(id); });
		if (from && !failure) fill();
		else layOut();
	}

	function layOut() {
		sight.disconnect();
		inSight.clear();
		places = new Map(Array.from({length: total}, (_, k) => [make('div'), k]));
		sheet.replaceChildren(...places.keys());
		for (const place of places.keys()) sight.observe(place);
		count.textContent = failure ?? `${total === page.n_clips ? '' : `${total} of `}${page.n_clips} clips`;
	}

	function fill() {
		for (const place of inSight) {
			const k = places.get(place);
			const block = k - (k % BLOCK);
			if (store.live && !asked.has(block)) fetchBlock(block);
			const clip = clips[k];
			if (clip && !place.firstChild) place.append(clipCard(clip, ctx));
		}
		// An empty player invites less than a first clip.
		if (!player.shown && clips[0]) player.show([{clip: clips[0].id}]);
	}

	onTheme(layOut);
	choose();
	return make('article.stack',
		panel('Library',
			make('p.note', page.path),
			factList({
				clips: page.n_clips,
				length: page.seconds < 600 ? inSeconds(page.seconds) : `${(page.seconds / 60).toFixed(1)} min`,
				'feature set': page.set,
				'words per second': page.rate,
			}),
			page.note && make('p.small', page.note),
			make('div.bar', filter, label, sort, down, count)),
		sheet);
}

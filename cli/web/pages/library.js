import {make, factList, inSeconds, shortName} from '../store.js';
import {drawStrip, onTheme} from '../strip.js';
import {openClip} from './clip.js';

/** Pixels of a card with its margin. */
const CARD_HEIGHT = 150;
const CARD_WIDTH = 270;
/** Clips asked for at once. */
const BLOCK = 40;

const secondsOf = (clip) => (clip.end - clip.start) / clip.rate;
const SORTS = {name: (clip) => clip.name, label: (clip) => clip.label ?? '', seconds: secondsOf};

function clipCard(clip, ctx) {
	return make('button', {class: 'card', type: 'button', 'data-testid': 'clip-row', 'data-clip': clip.id, title: clip.name, click: () => openClip(clip.id, ctx)},
		make('canvas', {class: 'strip', 'aria-hidden': true}),
		make('strong', {}, shortName(clip)),
		make('span', {class: 'bar small muted number'},
			clip.label && make('span', {class: 'chip'}, clip.label),
			`${inSeconds(secondsOf(clip))} · ${clip.end - clip.start} frames`,
			make('span', {class: 'rig'}, clip.rig ?? 'no rig')));
}

/** A contact sheet. Only the cards in sight exist, and live only the clips around them are asked for. */
export function renderLibraryPage(page, ctx) {
	const {store, player} = ctx;
	// Of the present query: the clips by place as far as they are known, and the blocks that were asked for.
	let query, clips, asked, total, failure;
	const cards = new Map();
	const space = make('div', {class: 'sheet'});
	const count = make('p', {class: 'muted small', role: 'status'});
	const filter = make('input', {type: 'search', placeholder: 'Filter by name', 'aria-label': 'Filter by name', 'data-testid': 'filter', input: choose});
	const list = (name, testid, options) => make('select', {'aria-label': name, 'data-testid': testid, change: choose},
		...options.map(([value, text]) => make('option', {value}, text)));
	const label = list('Label', 'label-filter', [['', 'All labels'], ...page.labels.map((name) => [name, name])]);
	const sort = list('Sort by', 'sort', Object.keys(SORTS).map((name) => [name, `by ${name}`]));
	const down = make('button', {type: 'button', 'aria-pressed': false, 'aria-label': 'Descending', title: 'Descending', click() {
		down.ariaPressed = down.ariaPressed !== 'true';
		choose();
	}}, '↓');

	function choose() {
		query = {sort: sort.value, down: +(down.ariaPressed === 'true'), label: label.value, text: filter.value};
		[clips, asked, total, failure] = [[], new Set(), page.n_clips, null];
		if (!ctx.live) {
			const value = SORTS[query.sort];
			const sign = query.down ? -1 : 1;
			clips = [...store.clips.values()]
				.filter((clip) => clip.strip && (!query.label || clip.label === query.label) && clip.name.toLowerCase().includes(query.text.toLowerCase()))
				.sort((a, b) => (value(a) < value(b) ? -sign : value(a) > value(b) ? sign : a.id - b.id));
			total = clips.length;
		}
		again();
	}

	async function fetchBlock(from) {
		const present = query;
		asked.add(from);
		const answer = await store.ask('clips', {from, n: BLOCK, ...query}).catch(({message}) => ({total: 0, clips: [], failure: message}));
		store.merge(answer);
		if (present !== query) return;
		({total, failure} = answer);
		answer.clips.forEach(({id}, k) => { clips[from + k] = store.clips.get(id); });
		layOut();
	}

	function again() {
		cards.clear();
		space.replaceChildren();
		layOut();
	}

	function layOut() {
		if (!space.isConnected) return;
		const {top, width} = space.getBoundingClientRect();
		const columns = Math.max(1, Math.floor(width / CARD_WIDTH));
		const first = Math.max(0, Math.floor(-top / CARD_HEIGHT)) * columns;
		const end = Math.min(total, Math.ceil((innerHeight - top) / CARD_HEIGHT) * columns);
		for (const [k, card] of cards) {
			if ((k >= first && k < end) || card === document.activeElement) continue;
			card.remove();
			cards.delete(k);
		}
		// From the last one, so that keys and readers go through the cards in their order.
		for (let k = end - 1, next = null; k >= first; k--) {
			const block = k - (k % BLOCK);
			if (ctx.live && !asked.has(block)) fetchBlock(block);
			const clip = clips[k];
			if (!clip) continue;
			const card = cards.get(k) ?? clipCard(clip, ctx);
			if (!cards.has(k)) {
				space.insertBefore(card, next);
				cards.set(k, card);
				Object.assign(card.style, {width: `calc(${100 / columns}% - 10px)`, left: `${((k % columns) * 100) / columns}%`, top: `${Math.floor(k / columns) * CARD_HEIGHT}px`});
				if (clip.strip) drawStrip(card.firstChild, clip.strip, store.figures[clip.figure]);
			}
			next = card;
		}
		space.style.height = `${Math.ceil(total / columns) * CARD_HEIGHT}px`;
		count.textContent = failure ?? `${total === page.n_clips ? '' : `${total} of `}${page.n_clips} clips`;
		// An empty player invites less than a first clip.
		if (!player.shown && clips[0]) player.show([{clip: clips[0].id}]);
	}

	let wide = 0;
	new ResizeObserver(([{contentRect: {width}}]) => {
		if (width !== wide) again();
		wide = width;
	}).observe(space);
	for (const name of ['scroll', 'resize']) addEventListener(name, layOut, {passive: true});
	onTheme(again);
	choose();
	return make('article', {class: 'stack'},
		make('header', {class: 'panel stack'},
			make('h2', {}, 'Library'),
			make('p', {class: 'muted small'}, page.path),
			factList([
				{name: 'clips', value: page.n_clips},
				{name: 'length', value: page.seconds < 600 ? inSeconds(page.seconds) : `${(page.seconds / 60).toFixed(1)} min`},
				{name: 'feature set', value: page.set},
				{name: 'words per second', value: page.rate},
			]),
			page.note && make('p', {class: 'small'}, page.note),
			make('div', {class: 'bar'}, filter, label, sort, down, count)),
		space);
}

import {factList, inSeconds, lengthOf, make, panel, shortName} from '../store.js';
import {drawStrip, onTheme} from '../strip.js';
import {percent} from '../plot.js';
import {openClip} from './clip.js';

/** Pixels of a card with its margin. */
const CARD_HEIGHT = 150;
const CARD_WIDTH = 270;
/** Clips asked for at once. */
const BLOCK = 40;

const SORTS = {name: ({name}) => name, label: ({label}) => label ?? '', seconds: ({start, end, rate}) => (end - start) / rate};

function clipCard(clip, ctx) {
	return make('button.stack.card', {testid: 'clip-row', 'data-clip': clip.id, title: clip.name, click: () => openClip(clip.id, ctx)},
		make('canvas.strip', {'aria-hidden': true}),
		make('strong', shortName(clip)),
		make('span.bar.small.muted', clip.label && make('span.chip', clip.label), lengthOf(clip), make('span.rig', clip.rig ?? 'no rig')));
}

/** A contact sheet. Only the cards in sight exist, and live only the clips around them are asked for. */
export function renderLibraryPage(page, ctx) {
	const {store, player} = ctx;
	// Of the present query: the clips by place as far as they are known, and the blocks that were asked for.
	let query, clips, asked, total, failure;
	const cards = new Map();
	const space = make('div.sheet');
	const count = make('p.muted.small', {role: 'status'});
	const filter = make('input', {type: 'search', placeholder: 'Filter by name', label: 'Filter by name', testid: 'filter', input: choose});
	const list = (label, testid, options) => make('select', {label, testid, change: choose}, ...options.map(([value, text]) => make('option', {value}, text)));
	const label = list('Label', 'label-filter', [['', 'All labels'], ...page.labels.map((name) => [name, name])]);
	const sort = list('Sort by', 'sort', Object.keys(SORTS).map((name) => [name, `by ${name}`]));
	const down = make('button', {'aria-pressed': false, label: 'Descending', title: 'Descending', click() {
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
				Object.assign(card.style, {width: `calc(${100 / columns}% - 10px)`, left: percent((k % columns) / columns), top: `${Math.floor(k / columns) * CARD_HEIGHT}px`});
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
	return make('article.stack',
		panel('Library',
			make('p.muted.small', page.path),
			factList({
				clips: page.n_clips,
				length: page.seconds < 600 ? inSeconds(page.seconds) : `${(page.seconds / 60).toFixed(1)} min`,
				'feature set': page.set,
				'words per second': page.rate,
			}),
			page.note && make('p.small', page.note),
			make('div.bar', filter, label, sort, down, count)),
		space);
}

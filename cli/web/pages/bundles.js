import {equip, factList, lengthOf, make, moment, panel} from '../store.js';
import {adoptSvg, counted, follow, percent, seekIn, short} from '../plot.js';

/** More submotions at once could not be told apart. */
const MOST_PLAYED = 12;
/** Of the width that fits. */
const MOST_ZOOM = 8;

const tellBundle = ({id, height, mean_frames, volume, next}) =>
	`${id}: ${counted(height, 'submotion')}, ${short(mean_frames)} frames on average, volume ${short(volume)}, ${next.length ? `then ${next.join(', ')}` : 'a dead end'}`;

/** A graph of what follows what, whose nodes play, and walks through it. */
export function renderBundlesPage(page, ctx) {
	const {store, player} = ctx;
	const told = make('p.told', {role: 'status'}, 'A bundle plays its submotions together.');
	const graph = adoptSvg(page.svg);
	const view = make('div.graph', graph);
	let scale = 1;
	const zoom = make('input', {type: 'range', min: 1, max: MOST_ZOOM, step: 0.1, value: 1, label: 'Zoom', input() {
		const times = zoom.value / scale;
		scale = zoom.value;
		const [x, y] = [(view.scrollLeft + view.clientWidth / 2) * times, (view.scrollTop + view.clientHeight / 2) * times];
		graph.style.width = percent(scale);
		view.scrollTo(x - view.clientWidth / 2, y - view.clientHeight / 2);
	}});

	const elements = new Map([...graph.querySelectorAll('[data-bundle]')].map((element) => [element.dataset.bundle, element]));
	function mark(id) {
		for (const [bundle, {classList}] of elements) classList.toggle('current', bundle === id);
	}
	for (const node of page.nodes) {
		const element = elements.get(node.id);
		if (!element) continue;
		const tell = () => { told.textContent = tellBundle(node); };
		const play = () => {
			mark(node.id);
			const items = node.spans.slice(0, MOST_PLAYED);
			player.show(items, {play: true, title: `Bundle ${node.id}: ${items.length} of ${counted(node.spans.length, 'submotion')}`});
		};
		equip(element, {tabindex: 0, role: 'button', label: tellBundle(node), testid: 'node', pointerenter: tell, focus: tell, click: play, keydown(event) {
			if (event.key !== 'Enter' && event.key !== ' ') return;
			event.preventDefault();
			play();
		}});
	}

	const walks = page.walks.map(({title, clip: id, path}) => {
		const clip = store.clips.get(id);
		const start = async (seconds) => {
			await seekIn(player, clip, seconds);
			player.play();
		};
		const steps = path.map(({bundle, start_s}) => make('button', {click: () => start(start_s)},
			bundle, make('span.small', ` ${moment(start_s, clip.rate)}`)));
		let current = -1;
		follow(ctx, (time) => {
			const at = time.clip === id ? path.findLastIndex(({start_s}) => start_s <= time.seconds) : -1;
			if (at === current) return;
			current = at;
			steps.forEach((step, k) => { step.ariaCurrent = k === at ? 'step' : null; });
			if (at >= 0) mark(path[at].bundle);
		});
		return make('section.stack',
			make('div.bar', make('button.primary', {click: () => start(0)}, `▶ ${title}`), make('small', lengthOf(clip))),
			make('div.bar', ...steps));
	});
	return panel('Motion bundles', factList(page.facts), told, make('label.bar.small', 'Zoom', zoom), view,
		walks.length ? make('h3', 'Walks') : null, ...walks);
}

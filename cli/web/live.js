import {lengthOf, make, shortName} from './store.js';
import {counted, follow, seekIn, short} from './plot.js';
import {clipTimeline} from './timeline.js';
import {sceneEditor} from './scene.js';
import {renderSearchPage} from './pages/search.js';
import {renderTemplatePage} from './pages/template.js';

/** Milliseconds without a change before it is asked for. */
const PATIENCE = 200;
const LISTED_CLIPS = 40;
const LISTED_HITS = 20;

/** Search by an example, a scene or a template; each change is answered at once, below. */
export function renderSearchPanel(_, ctx) {
	const {store} = ctx;
	const forms = make('section.panel.stack');
	const status = make('p.error', {role: 'status'});
	const results = make('div.stack');
	let question = new AbortController();

	/** An answer is dropped if something was asked after it; what went wrong is `refused`, or stands below. */
	function ask(path, params, refused) {
		question.abort();
		question = new AbortController();
		const {signal} = question;
		setTimeout(async () => {
			if (signal.aborted) return;
			const answer = await store.ask(path, {...params, top: LISTED_HITS}).catch((error) => ({error}));
			if (signal.aborted) return;
			const {error} = answer;
			const told = error?.detail && refused;
			told?.(error.detail);
			status.textContent = error && !told ? error.message : '';
			// The hits of a template stand above its matrix, which is long.
			results.replaceChildren(...store.merge(answer).reverse().map((page) => (page.kind === 'template' ? renderTemplatePage : renderSearchPage)(page, {...ctx, signal})));
		}, PATIENCE);
	}

	const fold = (name, open, form) => make('details', {name: 'search-by', open}, make('summary', `Search by ${name}`), form);
	store.ask('vocabulary').then((words) => {
		const scene = sceneEditor(words, (text) => {
			if (text.replace(/#.*/g, '').trim()) ask('scene', {text}, scene.showError);
		});
		forms.append(fold('example', true, exampleForm(words, ctx, ask)), fold('scene', false, scene), templateForm(words, ask));
	}).catch(({message}) => { status.textContent = message; });
	return make('div.stack', {testid: 'search-panel'}, forms, status, results);
}

/** Which clip, which of its frames, and what is compared. */
function exampleForm({features}, {store, player}, ask) {
	let clip = null;
	let span = null;
	let timeline = null;

	const find = make('input', {type: 'search', placeholder: 'Find a clip', input: list});
	const clips = make('select', {label: 'Clip', change() {
		if (!clips.value) return;
		pick(+clips.value);
		player.show([{clip: clip.id}]);
	}});
	const place = make('div');
	async function list() {
		const text = find.value;
		const answer = await store.ask('clips', {n: LISTED_CLIPS, text}).catch(({message}) => ({clips: [], message}));
		if (text !== find.value) return;
		store.merge(answer);
		const {total, message = `${counted(total, 'clip')}${total > LISTED_CLIPS ? `, ${LISTED_CLIPS} listed` : ''}`} = answer;
		clips.replaceChildren(make('option', {value: ''}, message), ...answer.clips.map((each) =>
			make('option', {value: each.id}, [shortName(each), each.label, lengthOf(each)].filter(Boolean).join(' · '))));
	}
	function pick(id) {
		clip = store.clips.get(id);
		span = null;
		timeline = clipTimeline({
			clip, label: `Time in ${clip.name}; arrows with shift choose a span`,
			onSeek: (seconds) => seekIn(player, clip, seconds),
			onSpan(chosen) {
				span = chosen;
				search();
			},
		});
		place.replaceChildren(make('p.small', 'Drag over what to look for in ', make('strong', shortName(clip))), timeline);
	}
	follow({player}, ({clip: id, seconds}) => {
		if (!clip) pick(id);
		if (id === clip.id) timeline.setTime(seconds);
	});

	const mode = make('select', {label: 'What counts as the same'}, ...['adaptive', 'fuzzy', 'exact'].map((name) => make('option', name)));
	const mismatches = make('input', {type: 'number', min: 0, max: 9, value: 0});
	const mirror = make('input', {type: 'checkbox'});
	const boxes = features.map(({name}) => make('input', {type: 'checkbox', value: name, checked: true, testid: 'feature-check'}));
	const tickAll = (to) => make('button', {click() {
		for (const box of boxes) box.checked = to;
		search();
	}}, to ? 'All' : 'None');
	const count = make('small');
	function search() {
		const ticked = boxes.filter(({checked}) => checked).map(({value}) => value);
		count.textContent = `${ticked.length} of ${boxes.length}`;
		if (!span || !ticked.length) return;
		ask('search', {
			clip: clip.id, ...span, features: ticked.length < boxes.length ? ticked.join() : '',
			mode: mode.value, mismatches: mismatches.value || 0, mirror: +mirror.checked,
		});
	}
	list();
	search();
	return make('div.stack',
		make('div.bar', find, clips, make('button', {click: () => player.now && pick(player.now.clip)}, 'Take what is playing')), place,
		make('div.stack', {change: search},
			make('div.bar', mode, make('label.check', 'mismatches', mismatches), make('label.check', mirror, 'mirrored as well')),
			make('details', make('summary', 'Features to compare ', count), make('div.bar', tickAll(true), tickAll(false)),
				...[...new Set(features.map(({part}) => part))].map((label) => make('div.features.small', {role: 'group', label}, make('h3', label),
					...features.map(({name, number, description, part}, k) => (part === label ? make('label.check', {title: `F${number}: ${description}`}, boxes[k], name) : null)))))));
}

function templateForm({templates}, ask) {
	const select = make('select', {label: 'Template', testid: 'template-select', change() {
		tau.value = templates.find(({name}) => name === select.value)?.tau ?? tau.value;
		search();
	}}, make('option', {value: ''}, templates.length ? 'Choose one' : 'None was given'), ...templates.map(({name}) => make('option', name)));
	const tau = make('input', {type: 'range', min: 0, max: 0.3, step: 0.005, value: 0.06, label: 'τ, the most that a hit may cost', testid: 'tau', input: search});
	const told = make('output', 'τ 0.06');
	function search() {
		told.textContent = `τ ${short(tau.valueAsNumber)}`;
		if (select.value) ask('template', {name: select.value, tau: tau.value});
	}
	return make('div.bar', make('strong', 'Search by template'), select, tau, told);
}

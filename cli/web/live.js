import {make, inSeconds, shortName} from './store.js';
import {drawStrip} from './strip.js';
import {follow, short, counted} from './plot.js';
import {Timeline} from './timeline.js';
import {sceneEditor} from './scene.js';
import {renderSearchPage} from './pages/search.js';
import {renderTemplatePage} from './pages/template.js';

/** Milliseconds without a change before it is asked for. */
const PATIENCE = 200;
const LISTED_CLIPS = 30;
const LISTED_HITS = 20;

const check = (type, attributes, ...text) => make('label', {class: 'check'}, make('input', {type, ...attributes}), ...text);

/** Search by an example, a scene or a template; each change is answered at once, below. */
export function renderSearchPanel(ctx) {
  const {store} = ctx;
  const status = make('p', {class: 'small', role: 'status'});
  const results = make('div', {class: 'stack'});
  let timer;
  let asked = 0;
  let standing = new AbortController();

  /** An answer is dropped if something was asked after it; what went wrong is `refused`, or stands below. */
  function ask(path, params, refused) {
    const question = ++asked;
    clearTimeout(timer);
    timer = setTimeout(async () => {
      try {
        const pages = store.merge(await store.ask(path, {...params, top: LISTED_HITS}));
        if (question !== asked) return;
        standing.abort();
        standing = new AbortController();
        const inner = {...ctx, signal: standing.signal};
        // The hits of a template stand above its matrix, which is long.
        results.replaceChildren(...pages.reverse().map((page) => (page.kind === 'template' ? renderTemplatePage : renderSearchPage)(page, inner)));
        const {n_hits} = pages[0];
        // The example finds itself.
        const hint = path === 'search' && n_hits < 2 ? ' Fewer features find more. ' : ' ';
        status.replaceChildren(counted(n_hits, 'hit'), hint, make('button', {type: 'button', click: () => pages.forEach(ctx.open)}, 'Keep in a tab'));
      } catch (error) {
        if (question !== asked) return;
        const told = refused && error.detail;
        if (told) refused(error.detail);
        status.replaceChildren(make('span', {class: 'error'}, told ? '' : error.message));
      }
    }, PATIENCE);
  }

  const forms = {example: exampleForm(ctx, ask), scene: make('div'), template: make('div')};
  store.ask('vocabulary').then((vocabulary) => {
    forms.example.setFeatures(vocabulary.features);
    const editor = sceneEditor(vocabulary, (text) => {
      if (text.replace(/#.*/g, '').trim()) ask('scene', {text}, editor.showError);
    });
    forms.scene.append(editor);
    forms.template.append(templateForm(vocabulary, ask));
  }).catch((error) => status.append(error.message));
  const choose = (name) => Object.entries(forms).forEach(([other, form]) => { form.hidden = other !== name; });
  choose('example');
  return make('div', {class: 'stack', 'data-testid': 'search-panel'},
    make('section', {class: 'panel stack'},
      make('div', {class: 'bar', role: 'radiogroup', 'aria-label': 'Search by'}, make('h2', {}, 'Search by'),
        ...Object.keys(forms).map((name) => check('radio', {name: 'search-by', checked: name === 'example', change: () => choose(name)}, name))),
      ...Object.values(forms), status), results);
}

/** Which clip, which of its frames, and what is compared. */
function exampleForm({store, player}, ask) {
  let clip = null;
  let timeline = null;
  let following = new AbortController();
  let listed = 0;

  const clips = make('div', {class: 'clip-list', role: 'group', 'aria-label': 'Clips'});
  const place = make('div', {class: 'stack'});
  const trouble = make('p', {class: 'error', role: 'status'});
  async function list() {
    const question = ++listed;
    const answer = await store.ask('clips', {n: LISTED_CLIPS, text: find.value}).catch(({message}) => ({total: 0, clips: [], message}));
    if (question !== listed) return;
    trouble.textContent = answer.message ?? '';
    store.merge(answer);
    const more = answer.total - answer.clips.length;
    clips.replaceChildren(...answer.clips.map((each) => make('button', {type: 'button', title: each.name, 'data-clip': each.id, 'aria-pressed': each.id === clip?.id, click: () => pick(each.id)},
      shortName(each), make('small', {class: 'muted'}, ` ${each.label ?? ''} ${inSeconds((each.end - each.start) / each.rate)}`))), more > 0 ? `and ${more} more` : '');
  }
  function pick(id) {
    clip = store.clips.get(id);
    for (const button of clips.children) button.ariaPressed = Number(button.dataset.clip) === id;
    timeline = new Timeline({clip, selects: true, label: `Time in ${clip.name}; arrows with shift choose a span`});
    timeline.addEventListener('seek', ({detail}) => player.seek(detail.seconds));
    timeline.addEventListener('span', search);
    following.abort();
    following = new AbortController();
    follow({player, signal: following.signal}, (time) => time.clip === id && timeline.setTime(time.seconds));
    place.replaceChildren(make('p', {class: 'small'}, 'Drag over what to look for in ', make('strong', {}, shortName(clip))), timeline.element);
    if (clip.strip) {
      const canvas = make('canvas', {class: 'tl-strip', 'aria-hidden': 'true'});
      timeline.surface.prepend(canvas);
      drawStrip(canvas, clip.strip, store.figures[clip.figure]);
    }
    player.show([{clip: id}]);
  }

  const find = make('input', {type: 'search', placeholder: 'Find a clip', 'aria-label': 'Find a clip', input: list});
  const playing = make('button', {type: 'button', click: () => player.shown && pick(player.shown[0][0].clip)}, 'Take what is playing');
  const mode = make('select', {'aria-label': 'What counts as the same'}, ...['adaptive', 'fuzzy', 'exact'].map((name) => make('option', {}, name)));
  const mismatches = make('input', {type: 'number', min: 0, max: 9, value: 0, input: search});
  const mirror = make('input', {type: 'checkbox'});
  const boxes = make('div', {class: 'feature-boxes'});
  const filter = make('input', {type: 'search', placeholder: 'Filter features', 'aria-label': 'Filter features', input: () => {
    for (const label of boxes.querySelectorAll('label')) label.hidden = !label.textContent.includes(filter.value.toLowerCase());
  }});
  const tick = (to) => make('button', {type: 'button', click: () => {
    for (const box of boxes.querySelectorAll('label:not([hidden]) input')) box.checked = to;
    search();
  }}, to ? 'All' : 'None');
  const count = make('span', {class: 'muted small'});

  function search() {
    const all = [...boxes.querySelectorAll('input')];
    const ticked = all.filter(({checked}) => checked).map(({value}) => value);
    count.textContent = `${ticked.length} of ${all.length}`;
    trouble.textContent = ticked.length || !all.length ? '' : 'Tick a feature to compare.';
    if (timeline?.span && ticked.length) {
      ask('search', {clip: clip.id, ...timeline.span, features: ticked.length < all.length ? ticked.join() : '', mode: mode.value, mismatches: mismatches.value || 0, mirror: +mirror.checked});
    }
  }
  const form = make('div', {class: 'stack', change: search},
    make('div', {class: 'bar'}, find, playing), clips, place,
    make('div', {class: 'bar'}, mode, make('label', {class: 'check'}, 'mismatches', mismatches), make('label', {class: 'check'}, mirror, 'mirrored as well')),
    make('fieldset', {class: 'stack'}, make('legend', {}, 'Features to compare ', count), make('div', {class: 'bar'}, filter, tick(true), tick(false)), boxes), trouble);
  form.setFeatures = (features) => {
    for (const part of new Set(features.map((feature) => feature.part))) {
      boxes.append(make('div', {role: 'group', 'aria-label': part}, make('h3', {}, part),
        ...features.filter((feature) => feature.part === part).map(({name, number, description}) => {
          const label = check('checkbox', {value: name, checked: true, 'data-testid': 'feature-check'}, name, make('small', {class: 'muted'}, `F${number}`));
          label.title = description;
          return label;
        })));
    }
    search();
  };
  list();
  return form;
}

function templateForm({templates}, ask) {
  if (!templates.length) return make('p', {class: 'empty'}, 'The viewer was given no templates.');
  const select = make('select', {'aria-label': 'Template', 'data-testid': 'template-select', change: () => {
    tau.value = templates.find(({name}) => name === select.value)?.tau ?? tau.value;
    search();
  }}, make('option', {value: ''}, 'Choose a template'), ...templates.map(({name}) => make('option', {}, name)));
  const tau = make('input', {type: 'range', min: 0, max: 0.3, step: 0.005, value: 0.06, 'aria-label': 'τ, the most that a hit may cost', 'data-testid': 'tau', input: search});
  const told = make('output', {class: 'number'}, 'τ 0.06');
  function search() {
    told.textContent = `τ ${short(tau.valueAsNumber)}`;
    if (select.value) ask('template', {name: select.value, tau: tau.value});
  }
  return make('div', {class: 'bar'}, select, tau, told);
}

// Search in a live viewer: by an example, by a scene or by a template; each change is answered at once.

import {make, inSeconds, shortName} from './store.js';
import {drawStrip} from './strip.js';
import {follow, playItems, short} from './plot.js';
import {Timeline} from './timeline.js';
import {sceneEditor} from './scene.js';
import {renderSearchPage} from './pages/search.js';
import {renderTemplatePage} from './pages/template.js';

/** Milliseconds without a change before it is asked for. */
const PATIENCE = 200;

/** Clips that the list has at once. */
const LISTED_CLIPS = 30;

/** @returns {HTMLElement & {pick(clip: number): Promise<void>}} */
export function renderSearchPanel(ctx) {
  const {store, player} = ctx;
  const status = make('p', {class: 'muted small', role: 'status'});
  const results = make('div', {class: 'results'});
  let timer;
  let asked = 0;
  let standing = new AbortController();

  /** Asks when nothing has changed for a while; an answer is dropped if there was another question after it. */
  const ask = (path, params, onError) => {
    clearTimeout(timer);
    const question = ++asked;
    timer = setTimeout(async () => {
      results.setAttribute('aria-busy', 'true');
      try {
        const pages = store.merge(await store.ask(path, params));
        if (question !== asked) return;
        onError?.(null);
        standing.abort();
        standing = new AbortController();
        const inner = {...ctx, signal: standing.signal};
        results.replaceChildren(...pages.map((page) => (page.kind === 'template' ? renderTemplatePage : renderSearchPage)(page, inner)));
        const {title, n_hits} = pages.find(({kind}) => kind === 'search');
        status.replaceChildren(`${title}: ${n_hits} ${n_hits === 1 ? 'hit' : 'hits'} `,
          make('button', {type: 'button', click: () => pages.forEach((page) => ctx.open(page))}, 'Keep in a tab'));
      } catch (error) {
        if (question !== asked) return;
        if (onError && error.detail) onError(error.detail);
        status.replaceChildren(make('span', {class: 'error'}, onError && error.detail?.line ? '' : error.message));
      } finally {
        if (question === asked) results.removeAttribute('aria-busy');
      }
    }, PATIENCE);
  };
  const check = (type, attributes, ...text) => make('label', {class: 'check'}, make('input', {type, ...attributes}), ...text);

  const example = exampleForm(ctx, ask, check);
  const forms = {Example: example, Scene: make('div', {}), Template: make('div', {})};
  store.ask('vocabulary').then((vocabulary) => {
    example.setFeatures(vocabulary.features);
    forms.Scene.append(sceneForm(vocabulary, ask));
    forms.Template.append(templateForm(vocabulary, ask));
  }, (error) => status.replaceChildren(make('span', {class: 'error'}, error.message)));
  const choose = (name) => {
    for (const [each, form] of Object.entries(forms)) form.hidden = each !== name;
  };
  choose('Example');
  const root = make('div', {class: 'search-panel', 'data-testid': 'search-panel'},
    make('section', {class: 'panel', 'aria-label': 'Search'},
      make('div', {class: 'bar', role: 'radiogroup', 'aria-label': 'Search by'}, make('h2', {}, 'Search by'),
        ...Object.keys(forms).map((name) => check('radio', {name: 'search-by', checked: name === 'Example', change: () => choose(name)}, name.toLowerCase()))),
      ...Object.values(forms), status), results);
  root.pick = (clip) => {
    root.querySelector('[name=search-by]').click();
    return example.pick(clip);
  };
  return root;
}

/** Which clip, which of its frames, and what is compared. */
function exampleForm(ctx, ask, check) {
  const {store, player} = ctx;
  const trouble = make('p', {class: 'error', role: 'status'});
  const clips = make('div', {class: 'clip-list', role: 'group', 'aria-label': 'Clips'});
  const place = make('div', {});
  let clip = null;
  let timeline = null;
  let following = new AbortController();

  const filter = make('input', {type: 'search', placeholder: 'Find a clip', 'aria-label': 'Find a clip', input: () => list()});
  let listed = 0;
  async function list() {
    const question = ++listed;
    const answer = await store.ask('clips', {n: LISTED_CLIPS, text: filter.value}).catch((error) => ({error}));
    if (question !== listed) return;
    if (answer.error) {
      trouble.textContent = answer.error.message;
      return;
    }
    store.merge(answer);
    clips.replaceChildren(...answer.clips.map((each) => make('button', {
      type: 'button', title: each.name, 'aria-pressed': String(each.id === clip?.id), 'data-clip': each.id, click: () => form.pick(each.id),
    }, shortName(each), make('small', {class: 'muted number'}, ` ${each.label ?? ''} ${inSeconds((each.end - each.start) / each.rate)}`))),
    answer.total > answer.clips.length ? make('span', {class: 'muted small'}, `and ${answer.total - answer.clips.length} more`) : '');
  }

  const mode = make('select', {'aria-label': 'What counts as the same'}, ...['adaptive', 'fuzzy', 'exact'].map((name) => make('option', {}, name)));
  const mismatches = make('input', {type: 'number', min: 0, max: 9, value: 0});
  const mirrorBox = check('checkbox', {}, 'mirrored too');
  const find = make('input', {type: 'search', placeholder: 'Filter features', 'aria-label': 'Filter features', input() {
    for (const label of boxes.querySelectorAll('label')) label.hidden = !label.textContent.toLowerCase().includes(find.value.toLowerCase());
  }});
  const boxes = make('div', {class: 'feature-boxes'});
  const tick = (to) => make('button', {type: 'button', click() {
    for (const box of boxes.querySelectorAll('label:not([hidden]) input')) box.checked = to;
    search();
  }}, to ? 'all' : 'none');
  const count = make('span', {class: 'muted small number'});

  function search() {
    const all = [...boxes.querySelectorAll('input')];
    const ticked = all.filter((box) => box.checked).map((box) => box.value);
    count.textContent = `${ticked.length} of ${all.length}`;
    trouble.textContent = all.length && !ticked.length ? 'Tick the features to compare.' : '';
    if (!timeline?.span || trouble.textContent) return;
    ask('search', {
      clip: clip.id, ...timeline.span, features: ticked.length < all.length ? ticked.join() : '', mode: mode.value,
      mismatches: mismatches.value, mirror: Number(mirrorBox.firstChild.checked), top: 20,
    });
  }

  const form = make('div', {class: 'form', change: search}, make('div', {class: 'bar'}, filter), clips, place,
    make('div', {class: 'bar'}, mode, make('label', {}, 'mismatches ', mismatches), mirrorBox),
    make('fieldset', {}, make('legend', {}, 'Features to compare ', count), make('div', {class: 'bar'}, find, tick(true), tick(false)), boxes), trouble);
  mismatches.addEventListener('input', search);

  form.setFeatures = (features) => {
    const parts = Map.groupBy ? Map.groupBy(features, ({part}) => part) : new Map([['features', features]]);
    boxes.replaceChildren(...[...parts].map(([part, some]) => make('div', {role: 'group', 'aria-label': part}, make('h3', {}, part),
      ...some.map(({name, number, description, pair}) => {
        const label = check('checkbox', {value: name, checked: true, 'data-testid': 'feature-check'}, name, make('small', {class: 'muted'}, ` F${number}`));
        label.title = [description, pair && `0: ${pair[0]}, 1: ${pair[1]}`].filter(Boolean).join('\n');
        return label;
      }))));
    search();
  };
  form.pick = async (id) => {
    if (!store.clips.has(id)) store.merge(await store.ask(`clips/${id}`));
    clip = store.clips.get(id);
    for (const button of clips.querySelectorAll('button')) button.setAttribute('aria-pressed', String(Number(button.dataset.clip) === id));
    timeline = new Timeline({rate: clip.rate, start: clip.start, end: clip.end, select: true, label: `Time in ${shortName(clip)}; shift and arrows choose a span`});
    timeline.addEventListener('seek', ({detail}) => player.seek(detail.seconds));
    timeline.addEventListener('span', search);
    following.abort();
    following = new AbortController();
    follow({player, signal: following.signal}, (time) => time.clip === id && timeline.setTime(time.seconds));
    if (clip.strip) {
      const canvas = make('canvas', {class: 'tl-strip'});
      timeline.surface.prepend(canvas);
      drawStrip(canvas, clip.strip, store.figures[clip.figure]);
    }
    place.replaceChildren(make('p', {class: 'small muted'}, 'Drag over what you are looking for.'), timeline.element);
    await playItems(ctx, [{clip: id}], {title: shortName(clip)}, trouble);
  };
  list();
  return form;
}

function sceneForm(vocabulary, ask) {
  const editor = sceneEditor(vocabulary);
  editor.addEventListener('input', () => {
    if (editor.text.trim()) ask('scene', {text: editor.text, top: 20}, editor.showError);
  });
  return editor;
}

function templateForm({templates}, ask) {
  if (!templates.length) return make('p', {class: 'empty'}, 'The viewer was started without templates.');
  const select = make('select', {'aria-label': 'Template', 'data-testid': 'template-select'}, make('option', {value: ''}, 'choose a template'),
    ...templates.map(({name}) => make('option', {}, name)));
  const tau = make('input', {type: 'range', min: 0, max: 0.3, step: 0.005, 'aria-label': 'τ, the most that a hit may cost', 'data-testid': 'tau'});
  const told = make('output', {class: 'number'});
  const search = () => {
    told.textContent = `τ ${short(tau.valueAsNumber)}`;
    if (select.value) ask('template', {name: select.value, tau: tau.value, top: 20});
  };
  select.addEventListener('change', () => {
    const learned = templates.find(({name}) => name === select.value)?.tau;
    if (learned != null) tau.value = learned;
    search();
  });
  tau.addEventListener('input', search);
  search();
  return make('div', {class: 'bar'}, select, tau, told);
}

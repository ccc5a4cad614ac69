import {make} from './store.js';

/** More names at once are no help. */
const MOST_NAMES = 8;
const SCENE_EXAMPLE = 'rfoot_raised : 0 1 0\nrknee_bent : 0 1 0 1 0\noverlap rfoot_raised[2] rknee_bent[3]\nwithin 5s';

/**
 * A scene description being written: names are completed, an error is shown where it is.
 * @param {{features: {name: string, description: string}[], keywords: string[]}} vocabulary
 * @param {function(string): void} changed called with the text
 * @returns {HTMLElement & {showError: function(?object): void}}
 */
export function sceneEditor({features, keywords}, changed) {
  const known = [...keywords.map((name) => ({name, description: 'keyword'})), ...features];
  const text = make('textarea', {
    rows: 7, spellcheck: 'false', autocapitalize: 'off', placeholder: SCENE_EXAMPLE, 'data-testid': 'scene-input', 'aria-label': 'Scene description',
    'aria-autocomplete': 'list', 'aria-controls': 'scene-names', 'aria-describedby': 'scene-error', input, keydown, blur: close,
  });
  // The same text behind it has the marks, and tells where on the screen a place in the text is.
  const behind = make('pre', {'aria-hidden': 'true'});
  const list = make('ul', {class: 'scene-names', id: 'scene-names', role: 'listbox', 'aria-label': 'Names', hidden: true});
  const message = make('button', {type: 'button', class: 'error', id: 'scene-error', 'data-testid': 'scene-error', hidden: true, click: () => {
    text.focus();
    text.setSelectionRange(wrong, wrong);
  }});
  let wrong = 0;
  let found = [];
  let active = 0;

  function marked(tag, from, to) {
    const part = make(tag, {}, text.value.slice(from, to) || '\u200b');
    behind.replaceChildren(text.value.slice(0, from), part, `${text.value.slice(to)}\n`);
    return part;
  }
  function hide() {
    list.hidden = true;
    text.removeAttribute('aria-activedescendant');
  }
  function close() {
    if (list.hidden) return;
    hide();
    changed(text.value);
  }
  function activate(k) {
    active = (k + found.length) % found.length;
    [...list.children].forEach((option, at) => option.setAttribute('aria-selected', at === active));
    text.setAttribute('aria-activedescendant', `scene-name-${active}`);
  }
  const begun = () => text.value.slice(0, text.selectionStart).match(/\w*$/)[0];
  function accept(event) {
    event.preventDefault();
    text.setRangeText(found[active].name, text.selectionStart - begun().length, text.selectionStart, 'end');
    input();
  }
  function input() {
    editor.showError(null);
    hide();
    const word = begun().toLowerCase();
    const from = text.selectionStart - word.length;
    const where = ({name}) => name.toLowerCase().indexOf(word);
    // Not for a number, nor in a comment.
    const open = /^[a-z_]/.test(word) && !/#.*$/.test(text.value.slice(0, from));
    found = known.filter((each) => open && where(each) >= 0).sort((a, b) => (where(a) > 0) - (where(b) > 0)).slice(0, MOST_NAMES);
    // A name that is being chosen is not yet wrong.
    if (!found.length || found[0].name === word) return changed(text.value);
    list.replaceChildren(...found.map(({name, description}, k) => make('li', {role: 'option', id: `scene-name-${k}`, mousedown: (event) => {
      active = k;
      accept(event);
    }}, name, make('small', {}, description))));
    const place = marked('i', from, from);
    list.style.left = `${Math.max(0, Math.min(place.offsetLeft, text.clientWidth - 280))}px`;
    list.style.top = `${place.offsetTop + place.offsetHeight - text.scrollTop}px`;
    list.hidden = false;
    return activate(0);
  }
  function keydown(event) {
    const by = {ArrowDown: 1, ArrowUp: -1}[event.key];
    if (list.hidden) return;
    if (event.key === 'Enter' || event.key === 'Tab') accept(event);
    else if (event.key === 'Escape') close();
    else if (by) {
      event.preventDefault();
      activate(active + by);
    }
  }
  text.onscroll = () => { behind.scrollTop = text.scrollTop; };

  const editor = make('div', {class: 'stack'}, make('div', {class: 'scene'}, behind, text, list), message);
  editor.showError = (detail) => {
    message.hidden = !detail;
    text.setAttribute('aria-invalid', !!detail);
    if (!detail?.line) behind.replaceChildren();
    if (!detail) return;
    const {line, column, error} = detail;
    message.textContent = line ? `Line ${line}, column ${column}: ${error}` : error;
    if (!line) return;
    Object.assign(message.dataset, {line, column});
    const before = text.value.split('\n').slice(0, line - 1);
    wrong = before.reduce((sum, {length}) => sum + length + 1, column - 1);
    marked('mark', wrong, wrong + text.value.slice(wrong).match(/^(\w+|.?)/)[0].length);
  };
  return editor;
}

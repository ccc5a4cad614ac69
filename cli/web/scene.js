// A scene description being written: names are completed, an error is shown where it is.

import {make} from './store.js';

/** More names than this are no help. */
const MOST_NAMES = 8;

/** Example of the language, for whoever has not seen it. */
const PLACEHOLDER = 'rfoot_raised : 0 1 0\nrknee_bent : 0 1 0 1 0\noverlap rfoot_raised[2] rknee_bent[3]\nwithin 5s';

/**
 * Events: `input` when the text is another one.
 * @param {{features: {name: string, description: string}[], keywords: string[]}} vocabulary
 * @returns {HTMLElement & {text: string, showError(detail: ?object): void}}
 */
export function sceneEditor({features, keywords}) {
  const known = [...keywords.map((name) => ({name, description: 'keyword'})), ...features];
  const text = make('textarea', {
    class: 'scene-text', rows: 6, spellcheck: 'false', autocapitalize: 'off', autocomplete: 'off', placeholder: PLACEHOLDER,
    'aria-label': 'Scene description', 'aria-autocomplete': 'list', 'aria-controls': 'scene-names', 'aria-describedby': 'scene-error', 'data-testid': 'scene-input',
  });
  // The same text behind the one that is typed into: it carries the marks, and tells where the caret is.
  const behind = make('pre', {class: 'scene-text', 'aria-hidden': 'true'});
  const names = make('ul', {class: 'scene-names', id: 'scene-names', role: 'listbox', 'aria-label': 'Names', hidden: true});
  const message = make('button', {type: 'button', class: 'scene-error', id: 'scene-error', 'data-testid': 'scene-error', hidden: true, click() {
    text.focus();
    text.setSelectionRange(wrong, wrong);
  }});
  let wrong = 0;
  let found = [];
  let active = 0;

  /** Shows `from..to` of the text in `tag`, and what is before and after it as it is. */
  const split = (from, to, tag) => {
    const {value} = text;
    const part = make(tag, {}, value.slice(from, to) || '\u200b');
    behind.replaceChildren(value.slice(0, from), part, `${value.slice(to)}\n`);
    return part;
  };
  const close = () => {
    names.hidden = true;
    found = [];
    text.removeAttribute('aria-activedescendant');
  };
  const activate = (k) => {
    active = (k + found.length) % found.length;
    [...names.children].forEach((option, at) => option.setAttribute('aria-selected', String(at === active)));
    text.setAttribute('aria-activedescendant', `scene-name-${active}`);
  };
  const wordStart = () => text.value.slice(0, text.selectionStart).search(/[\p{L}_][\p{L}\d_]*$/u);
  const complete = () => {
    close();
    const from = wordStart();
    const word = text.value.slice(from, text.selectionStart).toLowerCase();
    // Not in a comment, and not where nothing was begun.
    if (from < 0 || /#[^\n]*$/.test(text.value.slice(0, from))) return;
    const rank = ({name}) => name.toLowerCase().indexOf(word);
    found = known.filter((each) => rank(each) >= 0 && each.name !== word).sort((a, b) => (rank(a) > 0) - (rank(b) > 0)).slice(0, MOST_NAMES);
    if (!found.length) return;
    names.replaceChildren(...found.map(({name, description}, k) => make('li', {
      role: 'option', id: `scene-name-${k}`, mousedown: (event) => accept(event, k),
    }, name, make('small', {}, description))));
    const mark = split(from, from, 'i');
    names.style.left = `${Math.min(mark.offsetLeft, Math.max(0, text.clientWidth - 260))}px`;
    names.style.top = `${mark.offsetTop + mark.offsetHeight}px`;
    names.hidden = false;
    activate(0);
  };
  const accept = (event, k) => {
    event.preventDefault();
    text.setRangeText(found[k].name, wordStart(), text.selectionStart, 'end');
    close();
    text.dispatchEvent(new InputEvent('input', {bubbles: true, inputType: 'insertReplacementText'}));
  };
  text.addEventListener('input', (event) => {
    text.rows = Math.max(6, text.value.split('\n').length + 1);
    element.showError(null);
    if (event.inputType === 'insertReplacementText') close();
    else complete();
  });
  text.addEventListener('blur', close);
  text.addEventListener('keydown', (event) => {
    event.stopPropagation();
    if (names.hidden) return;
    const to = {ArrowDown: active + 1, ArrowUp: active - 1}[event.key];
    if (to != null) {
      event.preventDefault();
      activate(to);
    } else if (event.key === 'Enter' || event.key === 'Tab') accept(event, active);
    else if (event.key === 'Escape') close();
  });

  const element = make('div', {class: 'scene'}, make('div', {class: 'scene-box'}, behind, text, names), message);
  Object.defineProperty(element, 'text', {get: () => text.value});
  element.showError = (detail) => {
    message.hidden = !detail;
    text.setAttribute('aria-invalid', String(!!detail));
    if (!detail) return behind.replaceChildren();
    const {line, column, error} = detail;
    message.textContent = line ? `Line ${line}, column ${column}: ${error}` : error;
    if (!line) return undefined;
    message.dataset.line = line;
    message.dataset.column = column;
    const lines = text.value.split('\n').slice(0, line - 1);
    wrong = Math.min(text.value.length, lines.reduce((sum, each) => sum + each.length + 1, column - 1));
    // The word that begins there, or the place where one is lacking.
    const length = text.value.slice(wrong).match(/^[^\s:[\];]+|^[^\n]?/)[0].length;
    split(wrong, wrong + length, 'mark');
    return undefined;
  };
  return element;
}

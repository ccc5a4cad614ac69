import {make} from './store.js';

/** More names at once are no help. */
const MOST_NAMES = 6;
const SCENE_EXAMPLE = 'rfoot_raised : 0 1 0\nrknee_bent : 0 1 0 1 0\noverlap rfoot_raised[2] rknee_bent[3]\nwithin 5s';

/**
 * A scene description being written: the tabulator completes a name at the caret, an error is shown where it is.
 * @param {{features: {name: string, description: string}[], keywords: string[]}} vocabulary
 * @param {function(string): void} changed called with the text
 * @returns {HTMLElement & {showError: function(?object): void}}
 */
export function sceneEditor({features, keywords}, changed) {
	const known = [...keywords.map((name) => ({name, description: 'keyword'})), ...features];
	const text = make('textarea', {
		spellcheck: 'false', autocapitalize: 'off', placeholder: SCENE_EXAMPLE, testid: 'scene-input', label: 'Scene description',
		'aria-describedby': 'scene-names scene-error', input, keydown, scroll: () => { behind.scrollTop = text.scrollTop; },
	});
	// The same text stands behind it, tells where the caret is and has the mark.
	const behind = make('pre', {'aria-hidden': 'true'});
	const names = make('div.bar.names', {id: 'scene-names', 'aria-live': 'polite'});
	const caret = make('i');
	const message = make('p.error', {id: 'scene-error', testid: 'scene-error', role: 'status', hidden: true});

	const before = () => text.value.slice(0, text.selectionStart);
	const begun = () => before().match(/\w*$/)[0];
	function accept(name) {
		const {selectionStart: at} = text;
		text.setRangeText(name, at - begun().length, at, 'end');
		text.focus();
		input();
	}
	function input() {
		editor.showError(null);
		const word = begun().toLowerCase();
		const where = ({name}) => name.toLowerCase().indexOf(word);
		// Not for a number, nor in a comment.
		const open = /^[a-z_]/.test(word) && !/#.*$/.test(before());
		const found = known.filter((each) => open && where(each) >= 0).sort((a, b) => (where(a) > 0) - (where(b) > 0)).slice(0, MOST_NAMES);
		const done = !found.length || found[0].name === word;
		names.replaceChildren(...(done ? [] : found.map(({name, description}) => make('button.small', {title: description, click: () => accept(name)}, name))));
		behind.replaceChildren(before(), caret);
		Object.assign(names.style, {left: `${Math.min(caret.offsetLeft, text.clientWidth / 2)}px`, top: `${caret.offsetTop - text.scrollTop + 22}px`});
		// A name that is being chosen is not yet wrong.
		if (done) changed(text.value);
	}
	function keydown(event) {
		const [first] = names.children;
		if (!first || !['Tab', 'Escape'].includes(event.key) || event.shiftKey) return;
		event.preventDefault();
		if (event.key === 'Tab') return first.click();
		names.replaceChildren();
		changed(text.value);
	}

	const editor = make('div.stack', make('div.scene', behind, text, names), message);
	editor.showError = (detail) => {
		const {line, column, error} = detail ?? {};
		message.hidden = !detail;
		text.ariaInvalid = !!detail;
		behind.replaceChildren();
		message.textContent = line ? `Line ${line}, column ${column}: ${error}` : error;
		if (!line) return;
		Object.assign(message.dataset, {line, column});
		const at = [...text.value.split('\n').slice(0, line - 1), ''].join('\n').length + column - 1;
		const rest = text.value.slice(at);
		const wrong = rest.match(/^(\w+|.?)/)[0];
		behind.append(text.value.slice(0, at), make('mark', wrong || '\u200b'), `${rest.slice(wrong.length)}\n`);
	};
	return editor;
}

import {Store, make, shortName} from './store.js';
import {Player} from './player.js';
import {renderClipPage} from './pages/clip.js';
import {renderLibraryPage} from './pages/library.js';
import {renderSearchPage} from './pages/search.js';
import {renderAnnotationPage} from './pages/annotation.js';
import {renderTemplatePage} from './pages/template.js';
import {renderAlignmentPage} from './pages/alignment.js';
import {renderBundlesPage} from './pages/bundles.js';
import {renderSearchPanel} from './live.js';

/** With a library, clip pages beyond this number get a tab only when they are opened. */
const CLIP_TABS = 6;

const [documentText, playerHost, pageHost, tabHost, titleHost] = ['document', 'player', 'page', 'tabs', 'title'].map((id) => document.getElementById(id));
const contents = JSON.parse(documentText.textContent);
const store = new Store(contents);
const player = new Player(playerHost, store);
const ctx = {store, player, open};
const clipName = (id) => shortName(store.clips.get(id));

/** How a kind of page is drawn and what its tab is called. */
const KINDS = {
	library: [renderLibraryPage, () => 'Library'],
	live: [renderSearchPanel, () => 'Search'],
	clip: [renderClipPage, ({clip}) => clipName(clip)],
	search: [renderSearchPage, ({title}) => title],
	annotation: [renderAnnotationPage, ({clip}) => `Labels: ${clipName(clip)}`],
	template: [renderTemplatePage, ({name}) => `Template: ${name}`],
	alignment: [renderAlignmentPage, ({a, b}) => `${clipName(a)} ↔ ${clipName(b)}`],
	bundles: [renderBundlesPage, () => 'Bundles'],
};

/** `{key, page, button, node, scroll, shown, passing}`; a passing tab gives way to the next clip. */
const tabs = [];
let current;

function addTab(page, passing) {
	const key = `${page.kind}-${tabs.filter((tab) => tab.page.kind === page.kind).length}`;
	const button = make('button', {role: 'tab', id: `tab-${key}`, testid: `tab-${key}`, 'aria-controls': 'page', click({detail}) {
		location.hash = key;
		// After a click of a mouse the keys are the player's; whoever came by keys goes on along the tabs.
		if (detail) pageHost.focus({preventScroll: true});
	}});
	tabHost.append(button);
	tabs.push(fill({key, button, passing}, page));
	return tabs.at(-1);
}

function fill(tab, page) {
	tab.button.textContent = tab.button.title = KINDS[page.kind][1](page);
	return Object.assign(tab, {page, node: null, scroll: 0, shown: null});
}

/** Shows a clip's page in its tab, or in one that is made for it. */
function open(page) {
	let tab = tabs.find(({page: {kind, clip}}) => kind === 'clip' && clip === page.clip);
	if (!tab) {
		tab = tabs.find(({passing}) => passing);
		if (tab === current) current = null;
		tab = tab ? fill(tab, page) : addTab(page, true);
	}
	goTo(tab);
	location.hash = tab.key;
}

/** Shows a tab's page, and in the player what it left there, or at first what it is about. */
function goTo(tab) {
	if (tab === current) return;
	if (current) Object.assign(current, {scroll: scrollY, shown: player.shown});
	current = tab;
	for (const {button} of tabs) Object.assign(button, {ariaSelected: button === tab.button, tabIndex: button === tab.button ? 0 : -1});
	tab.button.scrollIntoView({block: 'nearest', inline: 'nearest'});
	const {page, shown} = tab;
	const place = page.clip === undefined ? page.example ?? page.hits?.[0] : page;
	// The tabs of a library and of its searches go on with what plays.
	if (shown) player.show(...shown);
	else if (place || !['library', 'live'].includes(page.kind)) player.show(place ? [place] : []);
	playerHost.hidden = page.kind === 'template';
	tab.node ??= rendered(page);
	pageHost.setAttribute('aria-labelledby', tab.button.id);
	pageHost.replaceChildren(tab.node);
	scrollTo(0, tab.scroll);
}

/** A page that cannot be drawn says so and leaves the others alone. */
function rendered(page) {
	try {
		return KINDS[page.kind][0](page, ctx);
	} catch (error) {
		console.error(error);
		return make('p.panel.error', `This page cannot be shown: ${error.message}`);
	}
}

function followHash() {
	const [key] = location.hash.slice(1).split('&');
	goTo(tabs.find((tab) => tab.key === key) ?? (current && key ? current : tabs[0]));
}

function pressed(event) {
	const {target, key} = event;
	// What the focused control needs itself.
	if (event.defaultPrevented || target.matches('textarea, select, input:not(.scrub)')) return;
	if (key === ' ' && target.matches('button:not([role=tab]), a, summary, [role=button]')) return;
	const at = tabs.findIndex(({button}) => button === target);
	const along = at >= 0 && {ArrowLeft: -1, ArrowRight: 1}[key];
	if (along) {
		const next = tabs[(at + along + tabs.length) % tabs.length].button;
		next.focus();
		next.click();
	} else if (!player.key(event)) return;
	event.preventDefault();
}

titleHost.textContent = contents.title;
const count = (wanted) => store.pages.filter(({kind}) => kind === wanted).length;
const crowded = count('library') && count('clip') > CLIP_TABS;
for (const page of store.pages) {
	if (!crowded || page.kind !== 'clip') addTab(page);
	if (page.kind === 'library' && store.live) addTab({kind: 'live'});
}
addEventListener('keydown', pressed);
addEventListener('hashchange', followHash);
if (player.tested) window.motif = {store, player};
followHash();

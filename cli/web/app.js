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

const RENDER = {
  library: renderLibraryPage,
  clip: renderClipPage,
  search: renderSearchPage,
  annotation: renderAnnotationPage,
  template: renderTemplatePage,
  alignment: renderAlignmentPage,
  bundles: renderBundlesPage,
  live: (page, ctx) => renderSearchPanel(ctx),
};

const store = new Store(JSON.parse(document.getElementById('document').textContent));
const player = new Player(document.getElementById('player'), store);
const ctx = { store, player, live: store.live, open };
const tabList = document.getElementById('tabs');
const pageHost = document.getElementById('page');
/** `{key, page, node, button, scroll, passing}`; a passing tab gives way to the next one of its kind. */
const tabs = [];
let current = null;

function titleOf(page) {
  const name = (id) => shortName(store.clips.get(id) ?? { name: `clip ${id}` });
  return {
    library: () => 'Library',
    live: () => 'Search',
    clip: () => name(page.clip),
    search: () => page.title,
    annotation: () => `Labels: ${name(page.clip)}`,
    template: () => `Template: ${page.name}`,
    alignment: () => `${name(page.a)} ↔ ${name(page.b)}`,
    bundles: () => 'Bundles',
  }[page.kind]();
}

function addTab(page, passing) {
  const n = tabs.filter((tab) => tab.page.kind === page.kind).length;
  const key = `${page.kind}-${n}`;
  const button = make('button', { type: 'button', role: 'tab', id: `tab-${key}`, 'data-testid': `tab-${key}`, 'aria-controls': 'page', title: titleOf(page), click: ({ detail }) => {
    location.hash = key;
    // After a click of a mouse the keys are the player's; whoever came by keys goes on along the tabs.
    if (detail) pageHost.focus({ preventScroll: true });
  } }, titleOf(page));
  const tab = { key, page, button, passing, node: null, scroll: 0 };
  tabs.push(tab);
  tabList.append(button);
  return tab;
}

/** Shows a page in a tab, its own or one that is made for it. */
function open(page) {
  const same = (tab) => tab.page === page || (page.kind === 'clip' && tab.page.kind === 'clip' && tab.page.clip === page.clip);
  let tab = tabs.find(same);
  if (!tab) {
    tab = tabs.find((other) => other.passing && other.page.kind === page.kind);
    if (tab) {
      Object.assign(tab, { page, node: null, scroll: 0 });
      tab.button.textContent = tab.button.title = titleOf(page);
      if (current === tab) current = null;
    } else tab = addTab(page, true);
  }
  goTo(tab);
  location.hash = tab.key;
}

/** The element of a page hears `open` whenever it is shown: time to put its motion into the player. */
function goTo(tab) {
  if (tab === current) return;
  if (current) current.scroll = scrollY;
  current = tab;
  for (const other of tabs) {
    other.button.setAttribute('aria-selected', other === tab);
    other.button.tabIndex = other === tab ? 0 : -1;
  }
  tab.button.scrollIntoView({ block: 'nearest', inline: 'nearest' });
  pageHost.setAttribute('aria-labelledby', tab.button.id);
  tab.node ??= rendered(tab.page);
  pageHost.replaceChildren(tab.node);
  scrollTo(0, tab.scroll);
  tab.node.dispatchEvent(new Event('open'));
}

/** A page that cannot be drawn says so and leaves the others alone. */
function rendered(page) {
  try {
    return RENDER[page.kind](page, ctx);
  } catch (error) {
    console.error(error);
    return make('p', { class: 'panel error' }, `This page cannot be shown: ${error.message}`);
  }
}

function follow() {
  const key = location.hash.slice(1).split('&')[0];
  const tab = tabs.find((other) => other.key === key) ?? (current ? null : tabs[0]);
  if (tab) goTo(tab);
}

function pressed(event) {
  if (event.defaultPrevented) return;
  const { target } = event;
  const tab = tabs.findIndex(({ button }) => button === target);
  const along = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
  if (tab >= 0 && along) {
    const next = tabs[(tab + along + tabs.length) % tabs.length].button;
    next.focus();
    next.click();
    event.preventDefault();
    return;
  }
  // Keys that the focused control needs itself.
  if (target.matches('textarea, select, input:not(.scrub)') || (event.key === ' ' && target.matches('button:not([role=tab]), a, summary, [role=button]'))) return;
  if (player.key(event)) event.preventDefault();
}

document.getElementById('title').textContent = store.title;
const hasLibrary = store.pages.some(({ kind }) => kind === 'library');
const crowded = hasLibrary && store.pages.filter(({ kind }) => kind === 'clip').length > CLIP_TABS;
for (const page of store.pages) {
  if (!(crowded && page.kind === 'clip')) addTab(page, false);
  if (page.kind === 'library' && store.live) addTab({ kind: 'live' }, false);
}
document.addEventListener('keydown', pressed);
addEventListener('hashchange', follow);
if (/test/.test(location.search + location.hash)) window.motif = { store, player, stage: player.stage };
if (tabs.length) follow();
else pageHost.append(make('p', { class: 'empty' }, 'There is nothing in this report.'));

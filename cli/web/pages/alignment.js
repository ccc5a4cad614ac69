import {make, factList, shortName} from '../store.js';
import {plotsOf} from './clip.js';

export function renderAlignmentPage(page, ctx) {
  const names = [page.a, page.b].map((id) => shortName(ctx.store.clips.get(id)));
  const items = [page.a, page.b].map((clip, k) => ({ clip, start: page.path[0][k], end: page.path.at(-1)[k] + 1 }));
  const show = () => ctx.player.show(items, { layout: 'side', path: page.path, title: names.join(' and ') });
  return make('article', { class: 'stack', open: show },
    make('header', { class: 'panel stack' },
      make('h2', {}, `${names[0]} aligned with ${names[1]}`),
      make('p', { class: 'muted small' }, 'Both play along the warping path: where one waits, the other goes on. The player lays them side by side or over each other.'),
      factList(page.facts)),
    ...plotsOf(page.a, [['Distance along the path', page.cost], ['Distance per body point', page.points]], ctx));
}

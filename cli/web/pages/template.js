// A motion template: what a class of motions has in common, feature by feature.

import {make, factList, inSeconds} from '../store.js';
import {picturePlot, short} from '../plot.js';

/** @returns {HTMLElement} */
export function renderTemplatePage(page, ctx) {
  const {matrix} = page;
  const facts = [
    ['features', page.set],
    ['length', `${inSeconds(matrix.seconds[1] - matrix.seconds[0])} · ${matrix.values.columns} columns`],
    ['rate', `${short(page.rate)} columns per second`],
    page.examples == null ? null : ['learned from', `${page.examples} ${page.examples === 1 ? 'motion' : 'motions'}`],
    ['τ', page.tau == null ? 'not learned' : short(page.tau)],
  ];
  return make('section', {class: 'panel template-page'},
    make('h2', {}, page.name),
    factList(facts.filter(Boolean).map(([name, value]) => ({name, value}))),
    picturePlot(matrix, {label: `Template ${page.name}`, rate: page.rate, unit: 'column', legend: true}),
    make('p', {class: 'muted small'}, 'A row is a feature: 1 where all motions of the class have it, 0 where none has, * where it does not matter.'));
}

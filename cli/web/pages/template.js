import {factList, inSeconds, make, panel} from '../store.js';
import {counted, picturePlot, short} from '../plot.js';

/** What the motions of a class have in common, feature by feature. */
export function renderTemplatePage({name, set, rate, tau, examples, matrix}) {
	return panel(name,
		factList({
			'feature set': set,
			length: `${inSeconds(matrix.seconds[1] - matrix.seconds[0])} · ${matrix.values.columns} columns`,
			'columns per second': short(rate),
			'learned from': examples == null ? 'nothing: by hand' : counted(examples, 'motion'),
			'τ': tau == null ? 'not learned' : short(tau),
		}),
		picturePlot(matrix, {label: `Template ${name}`}),
		make('p.note', 'A row is a feature: 1 where all motions have it, 0 where none has, pale (*) where it does not matter.'));
}

import {bytesOf, make} from './store.js';

/** The style sheet's colours that are drawn with, of the present theme, each as `read` has it. */
export function palette(read = String) {
	const style = getComputedStyle(document.documentElement);
	return Object.fromEntries(['left', 'right', 'middle', 'grid', 'ground', 'line'].map((name) => [name, read(style.getPropertyValue(`--${name}`).trim())]));
}

/** Calls back whenever the theme changes. */
export const onTheme = (callback) => matchMedia('(prefers-color-scheme: dark)').addEventListener('change', callback);

/** A canvas with a clip's poses, if it has any, which are drawn anew for each size. */
export function stripOf({strip, figure}, {figures}) {
	const canvas = make('canvas.strip', {'aria-hidden': true});
	if (strip) new ResizeObserver(() => drawStrip(canvas, strip, figures[figure])).observe(canvas);
	return canvas;
}

/** Draws poses side by side in one scale, over a line for the floor. The canvas is as large as its style says. */
function drawStrip(canvas, strip, figure) {
	const {clientWidth: width, clientHeight: height} = canvas;
	const sharp = Math.min(devicePixelRatio, 2);
	Object.assign(canvas, {width: width * sharp, height: height * sharp});
	const bytes = bytesOf(strip.bytes);
	// Centimetres; 255 twice is a missing point.
	const points = Array.from({length: bytes.length / 2}, (_, k) => (bytes[2 * k] + bytes[2 * k + 1] < 510 ? [bytes[2 * k] - 128, bytes[2 * k + 1]] : null));
	const known = points.filter(Boolean);
	const [room, floor] = [width / strip.poses, height - 5];
	// A pose may reach into its neighbours' room a little, else one wide pose makes all of them tiny.
	const scale = Math.min((floor - 5) / Math.max(170, ...known.map(([, y]) => y)), (room * 0.8) / Math.max(30, ...known.map(([x]) => Math.abs(x))));
	const pen = canvas.getContext('2d');
	const colours = palette();
	pen.scale(sharp, sharp);
	Object.assign(pen, {lineCap: 'round', fillStyle: colours.line});
	pen.fillRect(0, floor + 2, width, 1);
	for (let pose = 0; pose < strip.poses; pose++) {
		for (const bone of figure.bones) {
			const ends = [bone.from, bone.to].map((k) => points[pose * figure.points.length + k]);
			if (!ends[0] || !ends[1]) continue;
			Object.assign(pen, {strokeStyle: colours[bone.side], lineWidth: Math.max(1.6, (bone.width / 10) * scale)});
			pen.beginPath();
			for (const [x, y] of ends) pen.lineTo(room * (pose + 0.5) + x * scale, floor - y * scale);
			pen.stroke();
		}
	}
}

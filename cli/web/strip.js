import {bytesOf} from './store.js';

/** The style sheet's colours that are drawn with, of the present theme. */
export function palette() {
	const style = getComputedStyle(document.documentElement);
	return Object.fromEntries(['left', 'right', 'middle', 'grid', 'ground', 'line'].map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

/** Calls back whenever the theme changes. */
export const onTheme = (callback) => matchMedia('(prefers-color-scheme: dark)').addEventListener('change', callback);

/** Draws a clip's poses side by side in one scale, over a line for the floor. The canvas is as large as its style says. */
export function drawStrip(canvas, {strip, figure: number}, {figures}) {
	const figure = figures[number];
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
	pen.lineCap = 'round';
	const stroke = (colour, lineWidth, from, to) => {
		Object.assign(pen, {strokeStyle: colours[colour], lineWidth});
		pen.beginPath();
		pen.moveTo(...from);
		pen.lineTo(...to);
		pen.stroke();
	};
	stroke('line', 1, [0, floor + 2.5], [width, floor + 2.5]);
	for (let pose = 0; pose < strip.poses; pose++) {
		const place = ([x, y]) => [room * (pose + 0.5) + x * scale, floor - y * scale];
		for (const bone of figure.bones) {
			const [from, to] = [bone.from, bone.to].map((k) => points[pose * figure.points.length + k]);
			if (from && to) stroke(bone.side, Math.max(1.6, (bone.width / 10) * scale), place(from), place(to));
		}
	}
}

import {bytesOf} from './store.js';

const NAMES_OF_COLOURS = ['left', 'right', 'middle', 'grid', 'ground', 'line'];
const dark = matchMedia('(prefers-color-scheme: dark)');
let colours = null;

/** The style sheet's colours that are drawn with, of the present theme. */
export function palette() {
  if (!colours) {
    const style = getComputedStyle(document.documentElement);
    colours = Object.fromEntries(NAMES_OF_COLOURS.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
  }
  return colours;
}

/** Calls back whenever the theme changes. */
export function onTheme(callback) {
  dark.addEventListener('change', () => {
    colours = null;
    callback();
  });
}

/** Millimetres a byte of a strip stands for. */
const MM_PER_UNIT = 10;
const NO_POINT = 255;

/**
 * Draws a clip's poses side by side, all in one scale, over a line for the floor.
 * @param {HTMLCanvasElement} canvas as large as its style says
 * @param {import('./store.js').Strip} strip
 * @param {import('./store.js').Figure} figure
 */
export function drawStrip(canvas, strip, figure) {
  const sharp = Math.min(devicePixelRatio || 1, 2);
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  canvas.width = Math.round(width * sharp);
  canvas.height = Math.round(height * sharp);
  const at = bytesOf(strip.bytes);
  const points = figure.points.length;
  let top = 170;
  let side = 30;
  for (let k = 0; k < at.length; k += 2) {
    if (at[k] === NO_POINT && at[k + 1] === NO_POINT) continue;
    side = Math.max(side, Math.abs(at[k] - 128));
    top = Math.max(top, at[k + 1]);
  }
  const room = width / strip.poses;
  const floor = height - 5;
  // A pose may reach into its neighbours' room a little, else one wide pose makes all of them tiny.
  const scale = Math.min((floor - 5) / top, (room * 0.72) / side);
  const pen = canvas.getContext('2d');
  const hue = palette();
  pen.scale(sharp, sharp);
  pen.lineCap = 'round';
  pen.strokeStyle = hue.line;
  pen.beginPath();
  pen.moveTo(0, floor + 2.5);
  pen.lineTo(width, floor + 2.5);
  pen.stroke();
  for (let pose = 0; pose < strip.poses; pose++) {
    const middle = room * (pose + 0.5);
    const from = pose * points;
    for (const bone of figure.bones) {
      const [a, b] = [2 * (from + bone.from), 2 * (from + bone.to)];
      if ((at[a] === NO_POINT && at[a + 1] === NO_POINT) || (at[b] === NO_POINT && at[b + 1] === NO_POINT)) continue;
      pen.strokeStyle = hue[bone.side];
      pen.lineWidth = Math.max(1.6, (bone.width / MM_PER_UNIT) * scale);
      pen.beginPath();
      pen.moveTo(middle + (at[a] - 128) * scale, floor - at[a + 1] * scale);
      pen.lineTo(middle + (at[b] - 128) * scale, floor - at[b + 1] * scale);
      pen.stroke();
    }
  }
}

import {clamp} from './store.js';

const HALF_VIEW = Math.tan(Math.PI / 12);

/** A camera that circles a target: drag turns, wheel or pinch zooms. Metres, +Y up; at `yaw` 0 it looks from +Z. */
export class Camera {
	constructor(canvas, changed) {
		this.changed = changed;
		this.frame(1, 1, 0);
		const hands = new Map();
		const apart = () => {
			const [a, b] = hands.values();
			return Math.max(Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY), 1);
		};
		canvas.onpointerdown = (event) => {
			canvas.setPointerCapture(event.pointerId);
			hands.set(event.pointerId, event);
		};
		canvas.onpointermove = (event) => {
			const before = hands.get(event.pointerId);
			if (!before) return;
			const pinch = hands.size > 1 && apart();
			hands.set(event.pointerId, event);
			if (pinch) return this.#zoom(pinch / apart());
			this.yaw += (before.clientX - event.clientX) * 0.008;
			// Above the floor, and never quite from above, where left and right are lost.
			this.pitch = clamp(this.pitch + (event.clientY - before.clientY) * 0.008, 0.02, 1.5);
			changed();
		};
		canvas.onpointerup = canvas.onpointercancel = ({pointerId}) => hands.delete(pointerId);
		canvas.ondblclick = () => this.reset();
		canvas.onwheel = (event) => {
			event.preventDefault();
			this.#zoom(Math.exp(event.deltaY * (event.deltaMode ? 0.04 : 0.0015)));
		};
	}

	/** Fits a box of half a width and height around the target, seen from `yaw`. */
	frame(width, height, yaw) {
		Object.assign(this, {width, height, home: yaw});
		this.reset();
	}

	reset() {
		Object.assign(this, {yaw: this.home, pitch: 0.2, scale: 1});
		this.changed();
	}

	#zoom(factor) {
		this.scale = clamp(this.scale * factor, 0.15, 8);
		this.changed();
	}

	/** Column-major projection times view, the eye, and how far it is, for a target on the floor and a view's width / height. */
	look([x, , z], aspect) {
		const {yaw, pitch, width, height, scale: zoom} = this;
		const [sy, cy, sp, cp] = [Math.sin(yaw), Math.cos(yaw), Math.sin(pitch), Math.cos(pitch)];
		const far = zoom * ((Math.max(height, width / aspect) / HALF_VIEW) * 1.1 + width);
		const back = [sy * cp, sp, cy * cp];
		const eye = [x, height, z].map((at, k) => at + back[k] * far);
		const row = (axis, scale) => [...axis.map((v) => v * scale), -scale * axis.reduce((sum, v, k) => sum + v * eye[k], 0)];
		const [near, end] = [far * 0.05, far * 12 + 20];
		const depth = row(back, (end + near) / (near - end));
		depth[3] += (2 * end * near) / (near - end);
		const rows = [row([cy, 0, -sy], 1 / (HALF_VIEW * aspect)), row([-sy * sp, cp, -cy * sp], 1 / HALF_VIEW), depth, row(back, -1)];
		return {matrix: Float32Array.from({length: 16}, (_, k) => rows[k % 4][k >> 2]), eye, far};
	}
}

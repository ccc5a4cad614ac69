const HALF_VIEW = Math.tan(Math.PI / 12);

/** A camera that circles a target: drag turns, wheel or pinch zooms. Metres, +Y up; at `yaw` 0 it looks from +Z. */
export class Camera {
  constructor(canvas, changed) {
    this.changed = changed;
    this.frame({width: 1, height: 1}, 0);
    const hands = new Map();
    const apart = () => {
      const [a, b] = hands.values();
      return Math.max(Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY), 1);
    };
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      hands.set(event.pointerId, event);
    });
    canvas.addEventListener('pointermove', (event) => {
      const before = hands.get(event.pointerId);
      if (!before) return;
      const pinch = hands.size > 1 && apart();
      hands.set(event.pointerId, event);
      if (pinch) this.zoom(pinch / apart());
      else this.turn((before.clientX - event.clientX) * 0.008, (event.clientY - before.clientY) * 0.008);
    });
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, ({pointerId}) => hands.delete(pointerId));
    canvas.addEventListener('dblclick', () => this.reset());
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.zoom(Math.exp(event.deltaY * (event.deltaMode ? 0.04 : 0.0015)));
    }, {passive: false});
  }

  /** Fits a box around the target, seen from `yaw`. */
  frame(half, yaw) {
    Object.assign(this, {half, home: yaw});
    this.reset();
  }

  reset() {
    Object.assign(this, {yaw: this.home, pitch: 0.2, scale: 1});
    this.changed();
  }

  turn(yaw, pitch) {
    this.yaw += yaw;
    // Above the floor, and never quite from above, where left and right are lost.
    this.pitch = Math.min(Math.max(this.pitch + pitch, 0.02), 1.5);
    this.changed();
  }

  zoom(factor) {
    this.scale = Math.min(Math.max(this.scale * factor, 0.15), 8);
    this.changed();
  }

  /** Column-major projection times view, the eye, and how far it is, for a target and a view's width / height. */
  look(target, aspect) {
    const [sy, cy, sp, cp] = [Math.sin(this.yaw), Math.cos(this.yaw), Math.sin(this.pitch), Math.cos(this.pitch)];
    const {width, height} = this.half;
    const far = this.scale * ((Math.max(height, width / aspect) / HALF_VIEW) * 1.1 + width);
    const [right, up, back] = [[cy, 0, -sy], [-sy * sp, cp, -cy * sp], [sy * cp, sp, cy * cp]];
    const eye = target.map((at, k) => at + back[k] * far);
    const row = (axis, scale) => [...axis.map((v) => v * scale), -scale * axis.reduce((sum, v, k) => sum + v * eye[k], 0)];
    const [near, end] = [far * 0.05, far * 12 + 20];
    const depth = row(back, (end + near) / (near - end));
    depth[3] += (2 * end * near) / (near - end);
    const rows = [row(right, 1 / (HALF_VIEW * aspect)), row(up, 1 / HALF_VIEW), depth, row(back, -1)];
    return {matrix: Float32Array.from({length: 16}, (_, k) => rows[k % 4][k >> 2]), eye, far};
  }
}

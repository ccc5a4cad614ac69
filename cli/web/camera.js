const HALF_VIEW = Math.tan((15 * Math.PI) / 180);
const LOWEST = 0.02;
const HIGHEST = 1.5;

/**
 * A camera that circles a target: drag turns, shift-drag or two fingers move, wheel or pinch zooms.
 * Metres, +Y up; `yaw` 0 looks from +Z.
 */
export class Camera {
  #hands = new Map();

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {function(): void} changed
   */
  constructor(canvas, changed) {
    this.changed = changed;
    this.home = 0;
    this.half = { width: 1, height: 1 };
    this.reset();
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.#hands.set(event.pointerId, [event.clientX, event.clientY]);
    });
    for (const name of ['pointerup', 'pointercancel']) {
      canvas.addEventListener(name, (event) => this.#hands.delete(event.pointerId));
    }
    canvas.addEventListener('pointermove', (event) => this.#drag(event, canvas.clientHeight));
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('dblclick', () => this.reset());
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.zoom(Math.exp(event.deltaY * (event.deltaMode ? 0.04 : 0.0015)));
    }, { passive: false });
  }

  /** Fits a box around the target, seen from `yaw`. */
  frame(half, yaw) {
    this.half = half;
    this.home = yaw;
    this.reset();
  }

  reset() {
    this.yaw = this.home;
    this.pitch = 0.2;
    this.scale = 1;
    this.shift = [0, 0];
    this.changed();
  }

  turn(yaw, pitch) {
    this.yaw += yaw;
    this.pitch = Math.min(Math.max(this.pitch + pitch, LOWEST), HIGHEST);
    this.changed();
  }

  zoom(factor) {
    this.scale = Math.min(Math.max(this.scale * factor, 0.15), 8);
    this.changed();
  }

  #drag(event, height) {
    const before = this.#hands.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    const [x, y] = [now[0] - before[0], now[1] - before[1]];
    const other = [...this.#hands].find(([id]) => id !== event.pointerId)?.[1];
    this.#hands.set(event.pointerId, now);
    if (other) {
      const apart = (hand) => Math.max(Math.hypot(hand[0] - other[0], hand[1] - other[1]), 1);
      this.#move(x / 2, y / 2, height);
      this.zoom(apart(before) / apart(now));
    } else if (event.shiftKey || event.buttons & 2) this.#move(x, y, height);
    else this.turn(-x * 0.008, y * 0.008);
  }

  #move(x, y, height) {
    const metres = (2 * HALF_VIEW * this.#distance(1)) / height;
    this.shift = [this.shift[0] - x * metres, this.shift[1] + y * metres];
    this.changed();
  }

  #distance(aspect) {
    const { width, height } = this.half;
    return this.scale * (Math.max(height, width / aspect) / HALF_VIEW * 1.1 + width);
  }

  /** Column-major projection times view, the eye, and how far it is, for a target and a view's width / height. */
  look(target, aspect) {
    const [sy, cy, sp, cp] = [Math.sin(this.yaw), Math.cos(this.yaw), Math.sin(this.pitch), Math.cos(this.pitch)];
    const back = [sy * cp, sp, cy * cp];
    const right = [cy, 0, -sy];
    const up = [-sy * sp, cp, -cy * sp];
    const far = this.#distance(aspect);
    const middle = target.map((at, k) => at + right[k] * this.shift[0] + up[k] * this.shift[1]);
    const eye = middle.map((at, k) => at + back[k] * far);
    // Above the floor, else the grid hides the body.
    eye[1] = Math.max(eye[1], 0.05);
    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const [near, end] = [far * 0.05, far * 12 + 20];
    const [fx, fy] = [1 / (HALF_VIEW * aspect), 1 / HALF_VIEW];
    const [depth, offset] = [(end + near) / (near - end), (2 * end * near) / (near - end)];
    const z = -dot(back, eye);
    const rows = [
      [...right.map((v) => v * fx), -dot(right, eye) * fx],
      [...up.map((v) => v * fy), -dot(up, eye) * fy],
      [...back.map((v) => v * depth), z * depth + offset],
      [...back.map((v) => -v), -z],
    ];
    return { matrix: Float32Array.from({ length: 16 }, (_, k) => rows[k % 4][k >> 2]), eye, far };
  }
}

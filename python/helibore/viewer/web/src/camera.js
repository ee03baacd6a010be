// A camera in perspective: where it is, its axes (right, up, back), what it sees. Matrices are stored column by column.

import { cross, dot, length, minus, normalised, plus, scaled } from './vectors.js';

export class Camera {
  position = [0, 0, 1];
  axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  aspect = 1;
  near = 0.1;
  far = 1e5;
  /** @type {{ x: number, y: number, width: number, height: number } | null} */
  pixel = null;

  /** @param {number} fieldOfView */
  constructor(fieldOfView) {
    this.tangent = Math.tan((fieldOfView * Math.PI) / 360); // of half the field of view
  }

  // Look from the camera's position at a point, `up` upwards on the picture.
  /** @param {Vector} point @param {Vector} [up] */
  lookAt(point, up = [0, 0, 1]) {
    const back = normalised(minus(this.position, point));
    const side = cross(up, back);
    const right = length(side) > 1e-9 ? normalised(side) : [1, 0, 0];
    this.axes = [right, cross(back, right), back];
  }

  // Turn the camera without moving it: `left` and `raised` are radians to the left and upwards.
  /** @param {number} left @param {number} raised */
  turn(left, raised) {
    let [right, up, back] = this.axes;
    [right, back] = [plus(scaled(right, Math.cos(left)), back, -Math.sin(left)), plus(scaled(back, Math.cos(left)), right, Math.sin(left))];
    [up, back] = [plus(scaled(up, Math.cos(raised)), back, Math.sin(raised)), plus(scaled(back, Math.cos(raised)), up, -Math.sin(raised))];
    this.axes = [right, up, back];
  }

  // Return a direction in the axes of the camera: right, up, towards the eye.
  /** @param {Vector} direction */
  facing(direction) {
    return this.axes.map((axis) => dot(axis, direction));
  }

  // Return the model-view matrix of a body with these axes at this place.
  modelView(place = [0, 0, 0], axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]) {
    return [...axes.flatMap((axis) => [...this.facing(axis), 0]), ...this.facing(minus(place, this.position)), 1];
  }

  // The projection matrix. With `pixel` {x, y, width, height}, this one pixel of the picture fills the whole picture.
  get projection() {
    const { near, far, tangent, aspect, pixel } = this;
    const { x, y, width, height } = pixel ?? { x: 0, y: 0, width: 1, height: 1 };
    const [toLeft, down] = [width - 2 * x - 1, 2 * y + 1 - height];
    return [width / (tangent * aspect), 0, 0, 0, 0, height / tangent, 0, 0, -toLeft, -down, (near + far) / (near - far), -1, 0, 0, (2 * near * far) / (near - far), 0];
  }

  // Return where a place is on the picture, -1 to 1; null if the place is behind the eye or out of reach.
  /** @param {Vector} place */
  project(place) {
    const [x, y, back] = this.facing(minus(place, this.position));
    if (-back < this.near || -back > this.far) return null;
    return [x / (-back * this.tangent * this.aspect), y / (-back * this.tangent)];
  }
}

const FAREST = 50000;
const NEAREST = 0.5;

// Moves a camera around a point: a drag turns, a drag with the right button (or two fingers) shifts, the wheel brings it nearer.
export class Orbit {
  target = [0, 0, 0];
  enabled = true;
  /** @type {Map<number, Pair>} */
  fingers = new Map();

  /** @param {HTMLElement} pane @param {Camera} camera @param {() => void} changed */
  constructor(pane, camera, changed) {
    this.pane = pane;
    this.camera = camera;
    this.changed = changed;
    pane.addEventListener('contextmenu', (event) => event.preventDefault());
    pane.addEventListener('pointerdown', (event) => {
      pane.setPointerCapture(event.pointerId);
      this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    for (const end of /** @type {const} */ (['pointerup', 'pointercancel'])) pane.addEventListener(end, ({ pointerId }) => this.fingers.delete(pointerId));
    pane.addEventListener('pointermove', (event) => this.move(event));
    pane.addEventListener('wheel', (event) => {
      if (!this.enabled) return;
      event.preventDefault();
      this.nearer(0.95 ** (-event.deltaY / (event.deltaMode === 1 ? 3 : 100)));
    }, { passive: false });
  }

  /** @param {PointerEvent} pointerEvent */
  move({ pointerId, clientX: x, clientY: y, buttons, shiftKey }) {
    const before = this.fingers.get(pointerId);
    if (!before || !this.enabled) return;
    const apart = () => {
      const [a, b] = [...this.fingers.values()];
      return Math.hypot(a[0] - b[0], a[1] - b[1]) + 1;
    };
    const was = this.fingers.size > 1 ? apart() : 1;
    this.fingers.set(pointerId, [x, y]);
    const [dx, dy] = [x - before[0], y - before[1]];
    if (this.fingers.size > 1) {
      this.shift(dx / 2, dy / 2);
      this.nearer(was / apart());
    } else if (buttons & 2 || shiftKey) this.shift(dx, dy);
    else this.turn(dx, dy);
  }

  /** @param {number} dx @param {number} dy */
  turn(dx, dy) {
    const [x, y, z] = minus(this.camera.position, this.target);
    const far = Math.hypot(x, y, z);
    const scale = (0.7 * 2 * Math.PI) / this.pane.clientHeight;
    const around = Math.atan2(y, x) - scale * dx;
    const fromTop = Math.min(Math.PI - 1e-3, Math.max(1e-3, Math.acos(z / far) - scale * dy));
    this.look([Math.sin(fromTop) * Math.cos(around), Math.sin(fromTop) * Math.sin(around), Math.cos(fromTop)], far);
  }

  /** @param {number} dx @param {number} dy */
  shift(dx, dy) {
    const { camera } = this;
    const perPixel = (2 * length(minus(camera.position, this.target)) * camera.tangent) / this.pane.clientHeight;
    const step = plus(scaled(camera.axes[0], -dx * perPixel), camera.axes[1], dy * perPixel);
    [this.target, camera.position] = [plus(this.target, step), plus(camera.position, step)];
    this.changed();
  }

  /** @param {number} factor */
  nearer(factor) {
    const from = minus(this.camera.position, this.target);
    this.look(normalised(from), Math.min(FAREST, Math.max(NEAREST, length(from) * factor)));
  }

  // Look at the target from a direction and a distance.
  /** @param {Vector} direction @param {number} far */
  look(direction, far) {
    this.camera.position = plus(this.target, direction, far);
    this.camera.lookAt(this.target);
    this.changed();
  }
}

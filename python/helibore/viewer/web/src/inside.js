// The borehole camera: the eye is on the hole's axis, before the held cursor or else at one end of the section, and looks along
// the axis. The top of the picture is up or, in a vertical hole, toolface 0. A drag turns the head. The eye moves along the path
// like a train on rails, and the section with it: by wheel, arrow keys or two fingers, or by itself (V).

import { riseOf } from './dips.js';
import { byId } from './dom.js';
import { eastNorthUp, minus, plus } from './vectors.js';

export const WIDE = 62; // degrees of view across the narrower side of the picture
const FARTHEST = 1.2; // radians that the head turns at most

/** @param {Camera} camera @param {Gpu} gpu @param {Look} look */
export function placeInside(camera, gpu, look) {
  const { path, view, store, wallRect } = look;
  const down = view.camera === 'down';
  const frame = path.at(eyeDepth(look));
  const along = eastNorthUp(frame.tangent);
  camera.position = gpu.position(frame);
  camera.lookAt((down ? plus : minus)(camera.position, along), Math.abs(along[2]) > 0.9998 ? eastNorthUp(frame.high) : [0, 0, 1]);
  camera.turn(...view.head);
  camera.aspect = wallRect.width / Math.max(1, wallRect.height);
  camera.tangent = Math.tan((WIDE * Math.PI) / 360) / Math.min(1, camera.aspect); // in a narrow pane, too, the ring of a plane is seen whole
  Object.assign(camera, { near: 0.02 * store.bitRadius, far: 2 * view.length + 20 * store.bitRadius });
}

const BEFORE = 2.3; // radii of the hole from the eye to the nearest point of the held plane: it then fills 3/4 of the picture

// Return the depth of the eye: before the held plane, or before the cursor, if it is held in the section, else at the end of the
// section, or where the eye was when the cursor was held no longer.
/** @param {Pick<Look, 'view' | 'store' | 'held'>} of */
export function eyeDepth({ view, store, held }) {
  const { cursor, pinned, top, bottom } = view;
  const back = view.camera === 'down' ? -1 : 1;
  /** @param {number} depth */
  const within = (depth) => Math.min(bottom, Math.max(top, depth));
  if (!pinned || !cursor || cursor.depth < top || cursor.depth > bottom) return within(endOf(view) + view.ahead);
  const depth = held ? held.depth + back * riseOf(held) : cursor.depth;
  return within(depth + back * BEFORE * store.bitRadius);
}

// Return the end of the section that is behind the eye.
/** @param {View} view */
export const endOf = ({ camera, top, bottom }) => (camera === 'down' ? top : bottom);

/** @param {Pair} head @param {number} dx @param {number} dy */
export function turnHead(head, dx, dy) {
  /** @param {number} angle */
  const within = (angle) => Math.min(FARTHEST, Math.max(-FARTHEST, angle));
  head[0] = within(head[0] + 0.004 * dx);
  head[1] = within(head[1] + 0.004 * dy);
}

const SPEED = 8; // steps in a second
const STEP = { section: 0.025, radii: 1.5 }; // by a key or a notch of the wheel: of the section, and at most so many radii of the hole

// Return how far a step goes, in metres.
/** @param {View} view @param {Store} store */
export const stepOf = (view, store) => Math.min(STEP.section * view.length, STEP.radii * store.bitRadius);

// Hold the cursor no longer, and keep the eye and the section where they are.
/** @param {App} app @param {Cursor | null} cursor */
export function unhold(app, cursor) {
  const { view, renderer } = app;
  if (view.pinned && isInside(view)) view.ahead = eyeDepth(renderer.look()) - endOf(view);
  view.point(cursor, false);
}

// Move the eye, and the section with it, by `steps` in its direction of view; return whether it moved. The cursor is no longer held.
/** @param {App} app @param {number} steps */
export function fly({ view, store, renderer }, steps) {
  const top = view.top + eyeDepth(renderer.look()) - endOf(view);
  view.ahead = 0;
  view.release();
  view.show(top + (view.camera === 'up' ? -1 : 1) * steps * stepOf(view, store), view.length, store);
  return view.top !== top;
}

// Fly until the end of the wall, or until this is called again; then call `landed`.
/** @param {App} app @param {() => void} [landed] */
export function toggleFlight(app, landed = () => {}) {
  const button = byId('fly');
  const on = button.classList.toggle('on');
  button.textContent = on ? 'Stop' : 'Fly';
  let before = performance.now();
  const next = () => {
    const now = performance.now();
    const seconds = Math.min(0.25, (now - before) / 1000);
    before = now;
    if (!button.classList.contains('on')) return landed();
    if (isInside(app.view) && (seconds === 0 || fly(app, SPEED * seconds))) return requestAnimationFrame(next);
    toggleFlight(app);
    return landed();
  };
  if (on) requestAnimationFrame(next);
}

/** @param {View} view */
export const isInside = ({ camera }) => camera === 'down' || camera === 'up';

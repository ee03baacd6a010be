// Several wells in one scene: their walls as tubes along their paths, tops as discs that are joined from well to well, picked
// planes as discs, a grid with depths, north and scale.

import { Orbit } from './camera.js';
import { wallPoint } from './dips.js';
import { Flat } from './flat.js';
import { BOLD, label, PALETTES, SMALL, SMALL_BOLD } from './layout.js';
import { niceStep } from './lod.js';
import { byId } from './dom.js';
import { depthNumber, LENGTHS } from './units.js';
import { cross, eastNorthUp, length, minus, normalised, plus, scaled } from './vectors.js';
import { compass } from './wall_ink.js';

const STEPS = 24; // of the strip of a bed from its top to its base
const NEAR = 16; // pixels from the axis of a well within which it is under the pointer
const [ACROSS, UPWARDS] = [0.62, 0.6]; // shares of the picture that the wells fill at most
const FROM = normalised([-0.5, -1, 0.35]); // direction from which the scene is seen at first

export class Scene {
  fitted = false;
  changed = true; // the flat shapes are to be made anew
  key = '';
  usualTube = 1;
  origin = [0, 0, 0];
  low = [0, 0, 0];
  high = [1, 1, 1];
  areas = new Flat();
  lines = new Flat();
  rect = { left: 0, top: 0, width: 1, height: 1 };

  /** @param {import('./wells.js').Wells} wells */
  constructor(wells) {
    this.wells = wells;
    this.orbit = new Orbit(byId('ink'), wells.gpu.outside, () => wells.mode === 'scene' && wells.moved());
  }

  // Where the eye is, from the point that it looks at.
  get from() {
    return minus(this.wells.gpu.outside.position, this.orbit.target);
  }

  /** @param {Vector} from @param {Vector} target */
  restore(from, target) {
    this.orbit.target = target;
    this.fitted = true;
    this.orbit.look(normalised(from), length(from));
  }

  // Return points along the axis of a well, in the axes of the scene.
  /** @param {import('./well.js').Well} well @param {number} depth */
  at({ path }, depth) {
    return minus(eastNorthUp(path.at(depth).centre), this.origin);
  }

  // Measure the scene: the box around all wells, its middle, and an exaggeration with which the holes are seen.
  measure() {
    const { drawn, wells: all } = this.wells;
    const points = drawn.flatMap((well) => along(well.store.span, STEPS).map((depth) => eastNorthUp(well.path.at(depth).centre)));
    /** @param {(...of: number[]) => number} best */
    const corner = (best) => [0, 1, 2].map((i) => best(...points.map((point) => point[i])));
    const [low, high] = [corner(Math.min), corner(Math.max)];
    const size = length(minus(high, low));
    if (!this.fitted || !all.length) this.origin = scaled(plus(low, high), 0.5);
    const margin = 0.08 * size;
    [this.low, this.high] = [low, high].map((point, i) => plus(minus(point, this.origin), [1, 1, 0.25], i ? margin : -margin));
    const radius = Math.max(...drawn.map(({ store }) => store.bitRadius));
    const wanted = size / 80 / (2 * radius);
    this.usualTube = wanted <= 1 ? 1 : niceStep(0.6 * wanted);
  }

  fit() {
    const { low, high, orbit, rect } = this;
    const { outside: camera } = this.wells.gpu;
    const points = this.wells.drawn.flatMap((well) => along(well.store.span, STEPS).map((depth) => this.at(well, depth)));
    let far = length(minus(high, low)) / camera.tangent;
    Object.assign(camera, { aspect: rect.width / rect.height, near: far / 1e4, far: 10 * far });
    orbit.target = scaled(plus(low, high), 0.5);
    for (let i = 0; i < 20; i++) { // nearer and to the side, until the wells fill the picture
      orbit.look(FROM, far);
      const seen = points.map((point) => camera.project(point)).filter((at) => at !== null);
      const [[left, right], [lower, upper]] = [0, 1].map((axis) => seen.map((at) => at[axis])).map((places) => [Math.min(...places), Math.max(...places)]);
      orbit.target = plus(plus(orbit.target, camera.axes[0], ((left + right) / 2) * far * camera.tangent * camera.aspect), camera.axes[1], ((lower + upper) / 2) * far * camera.tangent);
      far *= Math.max((right - left) / 2 / ACROSS, (upper - lower) / 2 / UPWARDS, 0.5) ** 0.7;
    }
    this.fitted = true;
    orbit.look(FROM, far);
  }

  /** @param {import('./well.js').Well} well @param {number} [depth] */
  lookAt(well, depth) {
    const [top, bottom] = well.store.span;
    const from = this.from;
    this.orbit.target = this.at(well, depth ?? (top + bottom) / 2);
    const far = depth === undefined ? (0.7 * (bottom - top)) / this.wells.gpu.outside.tangent : Math.max(0.4 * length(from), 40 * well.store.bitRadius * this.wells.tube);
    this.orbit.look(normalised(from), far);
  }

  /** @param {Ink} ink @param {Rect} rect @returns {Look[]} */
  draw(ink, rect) {
    const { wells } = this;
    const { gpu, drawn, view } = wells;
    this.rect = rect;
    this.orbit.enabled = true;
    const key = [drawn.map(({ name, path }) => name + path.version).join(), view.theme, wells.tube].join();
    if (this.changed || key !== this.key) {
      this.key = key;
      this.changed = false;
      const before = this.origin;
      this.measure();
      if (this.fitted) this.origin = before;
      this.shapes();
    }
    if (!this.fitted) {
      this.fit();
      this.shapes();
    }
    const far = length(this.from);
    const size = length(minus(this.high, this.low));
    gpu.camera = gpu.outside;
    gpu.origin = this.origin;
    Object.assign(gpu.camera, { aspect: rect.width / rect.height, near: Math.max(0.05, far / 800), far: far + 3 * size });
    gpu.begin(rect);
    const looks = drawn.map((well) => {
      const [top, bottom] = well.store.span;
      well.ask(top, bottom);
      const shown = Object.create(wells.viewOf(top, bottom - top), { tube: { value: wells.tube } });
      const look = wells.look(well, shown, { image: { ...rect, width: 0 }, wall: rect });
      gpu.wall(look, 'wall');
      return look;
    });
    if (wells.shown.box) this.lines.draw(gpu.context, gpu.camera, true);
    this.areas.draw(gpu.context, gpu.camera, false);
    this.letter(ink, rect);
    return looks;
  }

  // Make beds between the wells, discs and the grid.
  shapes() {
    const { areas, lines, wells } = this;
    const { drawn, tops, shown, hidden } = wells;
    areas.clear();
    lines.clear();
    const palette = PALETTES[wells.view.theme];
    const visible = tops.filter(({ name }) => !hidden.has(name));
    const size = length(minus(this.high, this.low));
    for (const { name, colour } of visible) {
      drawn.slice(0, -1).forEach((well, i) => {
        const next = drawn[i + 1];
        const [a, b] = [well, next].map((one) => bed(one, name));
        if (!a || !b) return;
        const rows = [[well, a], [next, b]].map(([one, ends]) => along(/** @type {Pair} */ (ends), STEPS).map((depth) => this.at(/** @type {import('./well.js').Well} */ (one), depth)));
        const [top, base] = [0, 1].map((end) => [well, next].every((one) => drilled(one, name)[end]));
        if (shown.fence && base) areas.strip(rows[0], rows[1], colour, 0.32);
        if (!top) return;
        const joined = [a[0], b[0]].map((depth, j) => this.at(j ? next : well, depth));
        areas.strip(joined, joined.map((point) => plus(point, [0, 0, -0.0022 * size])), colour, 0.95);
      });
      if (!shown.discs) continue;
      for (const well of drawn) {
        const ends = bed(well, name);
        if (ends && ends[0] > well.store.span[0] - 1e-6) areas.fan(this.at(well, ends[0]), this.disc(well, ends[0], 2.4), colour, 0.85);
      }
    }
    if (shown.planes) {
      for (const well of drawn) {
        for (const plane of well.planes) areas.fan(this.at(well, plane.depth), this.plane(well, plane), palette.picks[plane.kind], 0.75);
      }
    }
    for (const [a, b] of this.grid()) lines.add([a, b], palette.soft, 0.5);
  }

  // Return the edge of a disc across a hole, so many radii of the drawn hole wide.
  /** @param {import('./well.js').Well} well @param {number} depth @param {number} wide */
  disc({ path, store }, depth, wide) {
    const radius = wide * store.bitRadius * this.wells.tube;
    return around((toolface) => minus(eastNorthUp(wallPoint(path, { depth, toolface, radius })), this.origin));
  }

  // Return the edge of a disc in a plane that was picked, wider than the hole also where the plane runs along it.
  /** @param {import('./well.js').Well} well @param {Plane} plane */
  plane({ store }, { frame, a, b }) {
    const { centre, high, right, tangent } = frame;
    const normal = normalised(eastNorthUp(tangent.map((t, i) => t - a * high[i] - b * right[i])));
    const side = normalised(cross(normal, Math.abs(normal[2]) > 0.9 ? [1, 0, 0] : [0, 0, 1]));
    const other = cross(normal, side);
    const radius = Math.min(5, 1.6 * Math.hypot(1, a, b)) * store.bitRadius * this.wells.tube;
    const middle = minus(eastNorthUp(centre), this.origin);
    return around((angle) => plus(plus(middle, side, radius * Math.cos((angle * Math.PI) / 180)), other, radius * Math.sin((angle * Math.PI) / 180)));
  }

  // Round places along east, north and up in the box: how far apart, and where, in metres of the scene.
  ticks() {
    const { low, high, origin } = this;
    const [level, upright] = [Math.max(high[0] - low[0], high[1] - low[1]) / 8, (high[2] - low[2]) / 6].map(niceStep);
    return [level, level, upright].map((step, i) => {
      const first = Math.ceil((low[i] + origin[i]) / step - 1e-9);
      const count = Math.floor((high[i] + origin[i]) / step + 1e-9) - first + 1;
      return Array.from({ length: Math.max(0, count) }, (_, n) => (first + n) * step).map((place) => ({ place, at: place - origin[i] }));
    });
  }

  // Return the lines of the floor and of the two walls that are behind.
  grid() {
    const { low, high } = this;
    const [east, north, up] = this.ticks();
    /** @type {[Vector, Vector][]} */
    const lines = [];
    for (const { at } of east) lines.push([[at, low[1], low[2]], [at, high[1], low[2]]]);
    for (const { at } of north) lines.push([[low[0], at, low[2]], [high[0], at, low[2]]]);
    for (const { at } of up) lines.push([[low[0], high[1], at], [high[0], high[1], at]], [[low[0], low[1], at], [low[0], high[1], at]]);
    for (const x of [low[0], high[0]]) for (const y of [low[1], high[1]]) if (y === high[1] || x === low[0]) lines.push([[x, y, low[2]], [x, y, high[2]]]);
    const floor = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]];
    floor.forEach(([x, y], i) => lines.push([[x, y, low[2]], [floor[(i + 1) % 4][0], floor[(i + 1) % 4][1], low[2]]]));
    return lines;
  }

  /** @param {Vector} place @param {Rect} rect @returns {Pair | null} */
  project(place, rect) {
    const seen = this.wells.gpu.camera.project(place);
    return seen && [rect.left + ((seen[0] + 1) / 2) * rect.width, rect.top + ((1 - seen[1]) / 2) * rect.height];
  }

  /** @param {Ink} ink @param {Rect} rect */
  letter(ink, rect) {
    const { wells } = this;
    const { gpu, drawn, view, tops } = wells;
    const palette = PALETTES[view.theme];
    /** @type {Pair[]} */
    const near = [[0, 0], [0, -15], [0, 15], [0, -30], [0, 30]];
    for (const well of drawn) {
      const at = this.project(plus(this.at(well, well.store.span[0]), [0, 0, 2.5 * well.store.bitRadius * wells.tube]), rect);
      if (at) label(ink, well.name, at[0], at[1] - 12, { colour: palette.ink, halo: palette.paper, align: 'center', font: BOLD });
    }
    const colours = new Map(tops.map(({ name, colour }) => [name, colour]));
    drawn.forEach((well, i) => {
      for (const [name, start] of well.store.intervals) {
        const same = drawn.findLastIndex(({ store }) => store.intervals.some(([one]) => one === name)) === i;
        if (wells.hidden.has(name) || !same || start < well.store.span[0] || start > well.store.span[1]) continue; // named once, at the last well that has it
        const at = this.project(this.at(well, start), rect);
        const edge = this.disc(well, start, 2.4).map((point) => this.project(point, rect)?.[0] ?? -Infinity);
        if (!at) continue;
        const x = Math.max(...edge, at[0]) + 8;
        ink.fillStyle = colours.get(name) ?? palette.ink;
        label(ink, name, x, at[1], { colour: palette.ink, halo: palette.paper, font: SMALL_BOLD, near, yields: true });
      }
    });
    if (wells.shown.box) this.letterBox(ink, rect, palette);
    compass(ink, gpu, rect, palette);
    label(ink, [`tube × ${wells.tube}`, wells.note ? 'places not stated' : ''].filter(Boolean).join('   '), rect.left + rect.width - 10, rect.height - 14, { colour: palette.ink, halo: palette.paper, align: 'right' });
  }

  // Write true depths at an upright edge of the box, and east and north along the floor.
  /** @param {Ink} ink @param {Rect} rect @param {Palette} palette */
  letterBox(ink, rect, palette) {
    const { low, high } = this;
    const { units } = this.wells.view;
    const [east, north, up] = this.ticks();
    const { unit } = LENGTHS[units].depth;
    /** @param {Vector} place @param {string} text @param {CanvasTextAlign} align @param {number} dx @param {number} dy */
    const at = (place, text, align, dx, dy) => {
      const seen = this.project(place, rect);
      if (seen) label(ink, text, seen[0] + dx, seen[1] + dy, { colour: palette.soft, halo: palette.paper, align, font: SMALL, yields: true, margin: 3 });
    };
    for (const tick of up) at([low[0], low[1], tick.at], depthNumber(-tick.place, units, 0), 'right', -6, 0);
    at([low[0], low[1], high[2]], `true depth [${unit}]`, 'right', -6, -14);
    for (const tick of east) at([tick.at, low[1], low[2]], `E ${depthNumber(tick.place, units, 0)}`, 'center', 0, 12);
    for (const tick of north) at([high[0], tick.at, low[2]], `N ${depthNumber(tick.place, units, 0)}`, 'left', 8, 6);
  }

  // Return the well whose axis is nearest to a place of the picture, and the depth there.
  /** @param {number} x @param {number} y */
  found(x, y) {
    /** @type {{ well: import('./well.js').Well, depth: number, away: number } | null} */
    let best = null;
    for (const well of this.wells.drawn) {
      for (const depth of along(well.store.span, 200)) {
        const at = this.project(this.at(well, depth), this.rect);
        const away = at ? Math.hypot(at[0] - x, at[1] - y) : Infinity;
        if (away < (best?.away ?? NEAR)) best = { well, depth, away };
      }
    }
    return best;
  }
}

/** @param {(angle: number) => Vector} point */
const around = (point) => Array.from({ length: 36 }, (_, i) => point(10 * i));
/** @param {Vector} ends @param {number} steps */
const along = ([start, stop], steps) => Array.from({ length: steps + 1 }, (_, i) => start + ((stop - start) * i) / steps);

// Return whether top and base of a bed lie in the measured hole of the well: only those are joined with another well's.
/** @param {import('./well.js').Well} well @param {string} name */
export function drilled({ store }, name) {
  const [, start, stop] = store.intervals.find(([one]) => one === name) ?? ['', NaN, NaN];
  return [start >= store.span[0] - 1e-6, (stop ?? Infinity) < store.span[1] - Math.abs(store.levels[0].pitch)];
}

// Return the part of a bed that lies in the well, null if there is none.
/** @param {import('./well.js').Well} well @param {string} name @returns {Pair | null} */
export function bed({ store }, name) {
  const found = store.intervals.find(([one]) => one === name);
  if (!found) return null;
  const [top, bottom] = store.span;
  const ends = /** @type {Pair} */ ([Math.max(found[1], top), Math.min(found[2] ?? Infinity, bottom)]);
  return ends[1] > ends[0] ? ends : null;
}


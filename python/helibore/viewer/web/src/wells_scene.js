// Several wells in one scene: their walls as tubes along their paths, tops as discs that are joined from well to well, picked
// planes as discs, a grid with depths, north and scale.

import { Orbit } from './camera.js';
import { wallPoint } from './dips.js';
import { Flat } from './flat.js';
import { BOLD, label, PALETTES, SMALL, SMALL_BOLD } from './layout.js';
import { niceStep } from './lod.js';
import { edgeOf } from './plane_rings.js';
import { byId } from './dom.js';
import { depthNumber, LENGTHS } from './units.js';
import { cross, dot, eastNorthUp, length, minus, normalised, plus, scaled } from './vectors.js';
import { compass } from './wall_ink.js';

const STEPS = 24; // of the strip of a bed from its top to its base
const NEAR = 16; // pixels from the axis of a well within which it is under the pointer
const [ACROSS, UPWARDS] = [0.86, 0.84]; // shares of the picture that the box around the wells fills at most, with its letters beside it
const FROM = [-0.5, -1, 0.35]; // direction from which the scene is seen at first, if another does not show wells and picks better

export class Scene {
  fitted = false;
  seen = Infinity; // wells that it was fitted to
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
    const points = [0, 1, 2, 3, 4, 5, 6, 7].map((corner) => [0, 1, 2].map((axis) => ((corner >> axis) & 1 ? high : low)[axis]));
    const from = this.facing();
    let far = length(minus(high, low)) / camera.tangent;
    Object.assign(camera, { aspect: rect.width / rect.height, near: far / 1e4, far: 10 * far });
    orbit.target = scaled(plus(low, high), 0.5);
    for (let i = 0; i < 20; i++) { // nearer and to the side, until the wells fill the picture
      orbit.look(from, far);
      const seen = points.map((point) => camera.project(point)).filter((at) => at !== null);
      const [[left, right], [lower, upper]] = [0, 1].map((axis) => seen.map((at) => at[axis])).map((places) => [Math.min(...places), Math.max(...places)]);
      orbit.target = plus(plus(orbit.target, camera.axes[0], ((left + right) / 2) * far * camera.tangent * camera.aspect), camera.axes[1], ((lower + upper) / 2) * far * camera.tangent);
      far *= Math.max((right - left) / 2 / ACROSS, (upper - lower) / 2 / UPWARDS, 0.5) ** 0.7;
    }
    this.fitted = true;
    this.seen = this.wells.drawn.length;
    orbit.look(from, far);
  }

  // Return the direction from which the wells stand apart and the picked planes are seen as discs rather than as edges.
  facing() {
    const { drawn, shown } = this.wells;
    const planes = shown.planes ? drawn.flatMap((well) => well.planes.filter(({ kind }) => kind !== 'bed').map(normalOf)) : [];
    const middles = drawn.map((well) => this.at(well, (well.store.span[0] + well.store.span[1]) / 2));
    const apart = middles.slice(1).map((middle) => normalised(minus(middle, middles[0])));
    /** @param {Vector[]} of @param {(one: Vector) => number} share */
    const mean = (of, share) => (of.length ? of.reduce((sum, one) => sum + share(one), 0) / of.length : 0);
    const [best] = Array.from({ length: 12 }, (_, i) => {
      const [c, s] = [Math.cos((i * Math.PI) / 6), Math.sin((i * Math.PI) / 6)];
      const from = normalised([c * FROM[0] - s * FROM[1], s * FROM[0] + c * FROM[1], FROM[2]]);
      return { from, worth: mean(apart, (one) => length(cross(one, from))) + (planes.length ? 1.5 * mean(planes, (normal) => Math.abs(dot(normal, from))) : -0.1 * Math.min(i, 12 - i)) };
    }).sort((one, other) => other.worth - one.worth);
    return best.from;
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
    const key = [drawn.map(({ name, path }) => name + path.version).join(), view.theme, wells.tube, ...this.from.slice(0, 2).map(Math.sign)].join();
    if (drawn.length > this.seen) this.fitted = false; // another well has come
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
        const { a, b, top, base } = joined(well, next, name);
        if (!a || !b) return;
        const rows = [[well, a], [next, b]].map(([one, ends]) => along(/** @type {Pair} */ (ends), STEPS).map((depth) => this.at(/** @type {import('./well.js').Well} */ (one), depth)));
        if (shown.fence && base) areas.strip(rows[0], rows[1], colour, 0.32);
        if (!top) return;
        const upper = [a[0], b[0]].map((depth, j) => this.at(j ? next : well, depth));
        areas.strip(upper, upper.map((point) => plus(point, [0, 0, -0.0022 * size])), colour, 0.95);
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

  // Return the edge of a disc in a plane that was picked.
  /** @param {import('./well.js').Well} well @param {Plane} plane */
  plane({ store }, plane) {
    return edgeOf(plane, store.bitRadius * this.wells.tube, false).map((point) => minus(eastNorthUp(point), this.origin));
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

  // Return where the two walls of the box are that stand behind the wells, east and north, and where their opposite sides.
  sides() {
    const { low, high, from } = this;
    const back = [0, 1].map((axis) => (from[axis] > 0 ? low : high)[axis]);
    return { back, front: [0, 1].map((axis) => low[axis] + high[axis] - back[axis]) };
  }

  // Return the lines of the floor and of the two walls that are behind.
  grid() {
    const { low, high } = this;
    const [east, north, up] = this.ticks();
    const { back: [x, y], front } = this.sides();
    /** @type {[Vector, Vector][]} */
    const lines = [];
    for (const at of [...east.map((tick) => tick.at), low[0], high[0]]) lines.push([[at, low[1], low[2]], [at, high[1], low[2]]]);
    for (const at of [...north.map((tick) => tick.at), low[1], high[1]]) lines.push([[low[0], at, low[2]], [high[0], at, low[2]]]);
    for (const at of [...up.map((tick) => tick.at), high[2]]) lines.push([[low[0], y, at], [high[0], y, at]], [[x, low[1], at], [x, high[1], at]]);
    for (const [across, along] of [[x, y], [x, front[1]], [front[0], y]]) lines.push([[across, along, low[2]], [across, along, high[2]]]);
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
    const { gpu, drawn, view } = wells;
    const palette = PALETTES[view.theme];
    for (const well of drawn) {
      const at = this.project(plus(this.at(well, well.store.span[0]), [0, 0, 2.5 * well.store.bitRadius * wells.tube]), rect);
      if (at) label(ink, well.name, at[0], at[1] - 12, { colour: palette.ink, halo: palette.paper, align: 'center', font: BOLD });
    }
    for (const well of drawn) {
      const [top, bottom] = well.store.span;
      const seen = well.store.intervals.filter(([name, start]) => !wells.hidden.has(name) && start >= top && start <= bottom)
        .map(([name, start]) => ({ name, start, at: this.project(this.at(well, start), rect) })).sort((one, other) => (one.at?.[1] ?? 0) - (other.at?.[1] ?? 0));
      let lowest = -Infinity; // no name stands above that of a top that is higher on the picture
      for (const { name, start, at } of seen) {
        if (!at) continue;
        const edge = this.disc(well, start, 2.4).map((point) => this.project(point, rect)?.[0] ?? -Infinity);
        const near = /** @type {Pair[]} */ ([0, -15, 15, -30, 30].map((dy) => [0, dy])).filter(([, dy]) => at[1] + dy > lowest);
        const place = near.length ? label(ink, name, Math.max(...edge, at[0]) + 8, at[1], { colour: palette.ink, halo: palette.paper, font: SMALL_BOLD, near, yields: true }) : undefined;
        lowest = place ? at[1] + place[1] : lowest;
      }
    }
    if (wells.shown.box) this.letterBox(ink, rect, palette);
    compass(ink, gpu, rect, palette);
    const flatter = wells.tube > 1 && wells.shown.planes && drawn.some(({ planes }) => planes.length) ? ': traces on it look flatter; discs of picks have their true dip, as wide as the tube' : '';
    label(ink, [`tube × ${wells.tube}${flatter}`, wells.note ? 'places not stated' : ''].filter(Boolean).join('   '), rect.left + rect.width - 10, rect.height - 14, { colour: palette.ink, halo: palette.paper, align: 'right' });
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
    const { back: [x, y], front } = this.sides();
    const ends = [[x, front[1]], [front[0], y]].map(([across, along]) => [across, along, high[2]]);
    const [edge] = ends.sort((a, b) => (this.project(a, rect)?.[0] ?? 0) - (this.project(b, rect)?.[0] ?? 0)); // the left one
    for (const tick of up) at([edge[0], edge[1], tick.at], depthNumber(-tick.place, units, 0), 'right', -6, 0);
    at(edge, `true depth of the surveys [${unit}]`, 'left', -50, -14);
    const right = (this.project([front[0], y, low[2]], rect)?.[0] ?? 0) > (this.project([x, front[1], low[2]], rect)?.[0] ?? 0); // whether the north edge is at the right
    for (const tick of east) at([tick.at, front[1], low[2]], `E ${depthNumber(tick.place, units, 0)}`, right ? 'right' : 'left', right ? -2 : 2, 12);
    for (const tick of north) at([front[0], tick.at, low[2]], `N ${depthNumber(tick.place, units, 0)}`, right ? 'left' : 'right', right ? 6 : -6, 10);
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

/** @param {Plane} plane @returns {Vector} */
const normalOf = ({ a, b, frame: { high, right, tangent } }) => normalised(eastNorthUp(tangent.map((t, i) => t - a * high[i] - b * right[i])));
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

// Return a bed in two neighbours (`a`, `b`), and whether its top and its base lie in the measured hole of both.
/** @param {import('./well.js').Well} one @param {import('./well.js').Well} next @param {string} name */
export function joined(one, next, name) {
  const [a, b] = [bed(one, name) ?? contact(next, one, name), bed(next, name) ?? contact(one, next, name)];
  const [top, base] = [0, 1].map((end) => a?.[0] === a?.[1] || drilled(one, name)[end]).map((is, end) => is && (b?.[0] === b?.[1] || drilled(next, name)[end]));
  return { a, b, top, base };
}

// Return where a bed that a well lacks wedges out in it: where the beds above and below it in another well meet; null if they do not.
/** @param {import('./well.js').Well} other @param {import('./well.js').Well} well @param {string} name @returns {Pair | null} */
function contact({ store: { intervals: others } }, { store: { intervals, span } }, name) {
  const i = others.findIndex(([one]) => one === name);
  if (i < 0 || intervals.some(([one]) => one === name)) return null;
  const [above, below] = [others[i - 1], others[i + 1]].map((beside) => intervals.find(([one]) => one === beside?.[0]));
  if (!above || !below || below[1] < span[0] || below[1] > span[1] || Math.abs((above[2] ?? below[1]) - below[1]) > 1e-3) return null;
  return [below[1], below[1]];
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


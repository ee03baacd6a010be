// Several wells in one scene: their walls as tubes along their paths, tops as discs that are joined from well to well, picked
// planes as discs, a grid with depths, north and scale.

import { Orbit } from './camera.js';
import { casingsIn, shoeInWords } from './columns.js';
import { anglesInWords, anglesOf, wallPoint } from './dips.js';
import { Flat } from './flat.js';
import { BOLD, label, PALETTES, SMALL, SMALL_BOLD } from './layout.js';
import { niceStep } from './lod.js';
import { nameOf } from './path_maps.js';
import { discOf, discsInWords, topInWords, topPlanes } from './plane_rings.js';
import { scaleBar } from './scale_bar.js';
import { byId } from './dom.js';
import { line } from './strokes.js';
import { depthNumber, depthUnit, LENGTHS, showDepth } from './units.js';
import { cross, dot, eastNorthUp, length, minus, normalised, plus, scaled } from './vectors.js';
import { ticks } from './view.js';
import { captionLines, compass } from './wall_ink.js';

const WIDE = 3; // of a disc, in radii of the drawn hole: the scene is seen from afar
const TUBE = 0.03; // diameter of the nearest hole, in heights of the picture
const SLIM = 12; // radii in the length of a hole, at least
const STEPS = 24; // of the strip of a bed from its top to its base
const DOT = 0.06; // share of the box around the wells; shorter wells are dots in it
const EDGE = 30; // pixels from the edge of the picture to the words on what is beyond it
const ARROWS = '→↗↑↖←↙↓↘';
/** @type {Pair[]} */
const ROWS = [0, 16, -16, 32, -32].map((dy) => [0, dy]);
const NEAR = 16; // pixels from the axis of a well within which it is under the pointer
const [ACROSS, UPWARDS] = [0.86, 0.84]; // shares of the picture that the box around the wells fills at most, with its letters beside it
const APART = 70; // pixels from a depth beside a hole to the next
const NAMES = 170; // pixels across, for the names beside the wells
const FROM = [-0.5, -1, 0.35]; // direction from which the scene is seen at first, if another does not show wells and picks better

// Words to be written beside a hole: each of `texts` is tried in turn.
/** @typedef {{ well: import('./well.js').Well, depth: number, plane: Plane | null, side: 1 | -1, texts: string[], colour: string, rank: number }} Words */

export class Scene {
  fitted = false;
  all = false; // all wells are to be in view, also as dots
  seen = Infinity; // wells that it was fitted to
  changed = true; // the flat shapes are to be made anew
  key = '';
  usualTube = 1;
  tall = 1; // exaggeration of heights
  origin = [0, 0, 0];
  low = [0, 0, 0];
  high = [1, 1, 1];
  areas = new Flat();
  lines = new Flat();
  rect = { left: 0, top: 0, width: 1, height: 1 };

  /** @param {import('./wells.js').Wells} wells */
  constructor(wells) {
    this.wells = wells;
    const camera = wells.gpu.outside;
    const { modelView, project } = camera;
    Object.assign(camera, {
      modelView: (place = [0, 0, 0], axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]) => modelView.call(camera, this.stretched(place), axes.map((axis) => this.stretched(axis))),
      project: (/** @type {Vector} */ place) => project.call(camera, this.stretched(place)),
    });
    this.orbit = new Orbit(byId('ink'), wells.gpu.outside, () => wells.mode === 'scene' && wells.moved());
  }

  // Return where a place of the scene is seen: the camera and what it looks at are places there.
  /** @param {Vector} place */
  stretched([x, y, z]) {
    return [x, y, z * this.tall];
  }

  // The distance of the eye, rounded so that shapes are made anew only now and then.
  get far() {
    return 2 ** (Math.round(2 * Math.log2(length(this.from))) / 2);
  }

  // Metres that a line is wide: so many that it has 2 pixels or 3.
  get thin() {
    return (5 * this.far * this.wells.gpu.outside.tangent) / this.rect.height;
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

  // Measure the scene: the box around all wells and its middle.
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
  }

  // Return an exaggeration with which the nearest hole is seen as a hole, and no hole is a disc.
  suitedTube() {
    const { wells: { drawn, gpu: { outside: camera } } } = this;
    const radius = Math.max(...drawn.map(({ store }) => store.bitRadius));
    const near = Math.min(...drawn.map((well) => length(minus(this.stretched(this.at(well, (well.store.span[0] + well.store.span[1]) / 2)), camera.position))));
    const wanted = Math.min(TUBE * near * camera.tangent, Math.min(...drawn.map(({ store: { span } }) => span[1] - span[0])) / SLIM) / radius;
    return wanted <= 1 ? 1 : niceStep(0.6 * wanted);
  }

  // Whether the wells are so short, beside the distances between them, that each is a dot where all are in view.
  get scattered() {
    return Math.max(...this.wells.drawn.map(({ store: { span } }) => span[1] - span[0])) < DOT * length(minus(this.high, this.low));
  }

  // Write at the edge of the picture which wells are beyond it: how far, and which way from the well that is nearest to its middle.
  /** @param {Ink} ink @param {Rect} rect @param {Palette} palette */
  letterOthers(ink, rect, palette) {
    const { wells: { drawn, view, gpu: { outside: camera } }, orbit: { target } } = this;
    const middles = drawn.map((well) => this.at(well, (well.store.span[0] + well.store.span[1]) / 2));
    const away = (/** @type {Vector} */ place) => length(minus(this.stretched(place), target));
    const here = middles.reduce((near, place) => (away(place) < away(near) ? place : near));
    drawn.forEach(({ name }, i) => {
      const [x, y] = this.project(middles[i], rect) ?? [NaN, NaN];
      if (x > rect.left && x < rect.left + rect.width && y > rect.top && y < rect.top + rect.height) return;
      const way = minus(middles[i], here);
      const [right, up] = [0, 1].map((axis) => dot(minus(this.stretched(middles[i]), target), camera.axes[axis]));
      const share = Math.min((rect.width / 2 - EDGE) / Math.abs(right), (rect.height / 2 - EDGE) / Math.abs(up));
      const arrow = ARROWS[(Math.round((4 * Math.atan2(up, right)) / Math.PI) + 8) % 8];
      const [text, left] = [`${name}, ${showDepth(Math.hypot(way[0], way[1]), view.units, 0)} ${nameOf(Math.atan2(way[0], way[1]))}`, right < 0];
      label(ink, left ? `${arrow} ${text}` : `${text} ${arrow}`, rect.left + rect.width / 2 + share * right + (left ? -1 : 1) * (EDGE - 10), rect.top + rect.height / 2 - share * up, { colour: palette.ink, halo: palette.paper, align: left ? 'left' : 'right', font: BOLD, near: ROWS });
    });
  }

  get corners() {
    return [0, 1, 2, 3, 4, 5, 6, 7].map((corner) => [0, 1, 2].map((axis) => ((corner >> axis) & 1 ? this.high : this.low)[axis]));
  }

  // Whether all of the box is in view.
  get whole() {
    return this.corners.every((corner) => this.wells.gpu.outside.project(corner)?.every((at) => Math.abs(at) <= 1));
  }

  /** @param {Vector} [from] */
  fit(from = this.facing()) {
    const { low, high, orbit, rect, corners: points } = this;
    const { outside: camera } = this.wells.gpu;
    let far = length(this.stretched(minus(high, low))) / camera.tangent;
    Object.assign(camera, { aspect: rect.width / rect.height, near: far / 1e4, far: 10 * far });
    orbit.target = this.stretched(scaled(plus(low, high), 0.5));
    for (let i = 0; i < 20; i++) { // nearer and to the side, until the wells fill the picture
      orbit.look(from, far);
      const seen = points.map((point) => camera.project(point)).filter((at) => at !== null);
      const [[left, right], [lower, upper]] = [0, 1].map((axis) => seen.map((at) => at[axis])).map((places) => [Math.min(...places), Math.max(...places)]);
      orbit.target = plus(plus(orbit.target, camera.axes[0], ((left + right) / 2) * far * camera.tangent * camera.aspect), camera.axes[1], ((lower + upper) / 2) * far * camera.tangent);
      far *= Math.max((right - left) / 2 / Math.max(0.5, Math.min(ACROSS, 1 - NAMES / rect.width)), (upper - lower) / 2 / UPWARDS, 0.5) ** 0.7;
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
    this.orbit.target = this.stretched(this.at(well, depth ?? (top + bottom) / 2));
    const far = depth === undefined ? (0.7 * length(this.stretched(minus(this.at(well, bottom), this.at(well, top))))) / this.wells.gpu.outside.tangent : Math.max(0.4 * length(from), 40 * well.store.bitRadius * this.wells.tube);
    this.orbit.look(normalised(from), far);
  }

  /** @param {Ink} ink @param {Rect} rect @returns {Look[]} */
  draw(ink, rect) {
    const { wells } = this;
    const { gpu, drawn, view } = wells;
    this.rect = rect;
    this.orbit.enabled = true;
    if (drawn.length > this.seen) this.fitted = false; // another well has come
    this.measure();
    if (!this.fitted) {
      this.fit();
      if (this.scattered && !this.all) this.lookAt(drawn[0]);
    }
    this.usualTube = this.suitedTube();
    const key = [drawn.map(({ name, path }) => name + path.version).join(), view.theme, wells.tube, this.tall, this.far, ...this.from.slice(0, 2).map(Math.sign)].join();
    if (this.changed || key !== this.key) {
      this.key = key;
      this.changed = false;
      this.shapes();
    }
    const far = length(this.from);
    const size = length(this.stretched(minus(this.high, this.low)));
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
    for (const { name, colour } of visible) {
      drawn.slice(0, -1).forEach((well, i) => {
        const next = drawn[i + 1];
        const { a, b, top, base, lacks } = joined(well, next, name);
        if (!a || !b) return;
        const rows = [[well, a], [next, b]].map(([one, ends]) => along(/** @type {Pair} */ (ends), STEPS).map((depth) => this.at(/** @type {import('./well.js').Well} */ (one), depth)));
        if (shown.fence && base) areas.strip(rows[0], rows[1], colour, lacks ? 0.15 : 0.32);
        if (!top || (lacks && !(shown.fence && base))) return;
        for (const end of lacks ? [0, 1] : [0]) { // both edges of a bed that one of the wells lacks, dashed
          const [from, to] = [rows[0], rows[1]].map((row) => row[end * STEPS]);
          for (const [start, stop] of lacks ? DASHES : [[0, 1]]) {
            const edge = [start, stop].map((share) => plus(from, minus(to, from), share));
            areas.strip(edge, edge.map((point) => plus(point, [0, 0, -this.thin / this.tall])), colour, 0.95);
          }
        }
      });
    }
    const colours = new Map(visible.map(({ name, colour }) => [name, colour]));
    for (const well of drawn) {
      const named = this.topsOf(well);
      for (const { name, plane, picked } of named) if (plane) this.ring(well, plane, colours.get(name) ?? palette.top, !picked);
      for (const plane of this.picksOf(well, named)) this.ring(well, plane, palette.picks[plane.kind], false);
      for (const casing of casingsIn(well.store)) this.pipe(well, casing, palette);
    }
    for (const [a, b] of this.grid()) lines.add([a, b], palette.soft, 0.5);
  }

  // Return the tops of a well that are shown, as planes.
  /** @param {import('./well.js').Well} well */
  topsOf({ store, path, planes }) {
    const { hidden, shown } = this.wells;
    const [top, bottom] = store.span;
    const intervals = store.intervals.filter(([name, start]) => !hidden.has(name) && start >= top - 1e-6 && start <= bottom);
    return shown.discs ? topPlanes({ intervals, path, store }, planes) : [];
  }

  // Return the picks of a well that are shown; the disc of a top is that of its pick.
  /** @param {import('./well.js').Well} well @param {Top[]} tops */
  picksOf({ planes }, tops) {
    return this.wells.shown.planes ? planes.filter((plane) => !tops.some(({ picked }) => picked === plane)) : [];
  }

  // Return the disc of a plane, in the axes of the scene.
  /** @param {import('./well.js').Well} well @param {Plane} plane */
  disc({ store }, plane) {
    return discOf(plane, store.bitRadius * this.wells.tube, WIDE).map(({ edge, wide }) => ({ wide, edge: minus(eastNorthUp(edge), this.origin) }));
  }

  // Add a disc that one sees through, with its edge, or, for a top without a dip (`level`), a dashed ring.
  /** @param {import('./well.js').Well} well @param {Plane} plane @param {string} colour @param {boolean} level */
  ring(well, plane, colour, level) {
    const middle = this.at(well, plane.depth);
    const edges = this.disc(well, plane).map(({ edge }) => edge);
    if (!level) this.areas.fan(middle, edges, colour, 0.35);
    edges.slice(1).forEach((next, i) => {
      if (level && Math.floor(i / 3) % 2) return;
      const rim = [edges[i], next];
      this.areas.strip(rim.map((edge) => plus(edge, minus(middle, edge), Math.min(0.5, this.thin / length(minus(middle, edge))))), rim, colour, 0.9);
      if (level) this.areas.strip(rim, rim.map((point) => plus(point, [0, 0, -this.thin / this.tall])), colour, 0.9);
    });
  }

  // Add the part of a casing that stands in the measured hole, exaggerated as the hole is, and a ring at its shoe.
  /** @param {import('./well.js').Well} well @param {NamedInterval} casing @param {Palette} palette */
  pipe({ store, path }, [, start, stop, , diameter = 0], palette) {
    const [top, bottom] = [Math.max(start, store.span[0]), Math.min(stop ?? Infinity, store.span[1])];
    /** @param {number} depth */
    const around = (depth) => Array.from({ length: 37 }, (_, i) => minus(eastNorthUp(wallPoint(path, { depth, toolface: 10 * i, radius: 1.04 * (diameter / 2) * this.wells.tube })), this.origin));
    const rings = along([top, bottom], 6).map(around);
    rings.slice(1).forEach((ring, i) => this.areas.strip(rings[i], ring, palette.soft, 0.55));
    if (stop !== null && stop <= store.span[1]) this.areas.strip(around(stop - 0.4 * diameter), around(stop), palette.ink, 0.95);
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
    ink.canvas.strokes.push(...drawn.flatMap((well) => this.outline(well, rect)));
    for (const well of drawn) {
      const at = this.project(plus(this.at(well, well.store.span[0]), [0, 0, (2.5 * well.store.bitRadius * wells.tube) / this.tall]), rect);
      if (at) label(ink, well.name, at[0], at[1] - 12, { colour: palette.ink, halo: palette.paper, align: 'center', font: BOLD, near: ROWS });
    }
    const near = wells.shown.box && !this.whole; // the letters of the box are not in view, or not all
    if (near) scaleBar(ink, rect.left + 16, rect.top + rect.height - 100, rect.height / (2 * gpu.outside.tangent * length(this.from)), view, palette);
    this.letterOthers(ink, rect, palette);
    compass(ink, gpu, rect, palette);
    const all = drawn.map((well) => ({ well, tops: this.topsOf(well), picks: this.picksOf(well, this.topsOf(well)) }));
    const picked = drawn.flatMap((well) => this.picksOf(well, []));
    const planes = all.some(({ tops, picks }) => tops.length || picks.length);
    const words = [...(picked.length ? [anglesInWords(drawn[0].path, picked)] : []), ...(planes ? discsInWords(wells.tube, this.tall === 1) : [`tube × ${wells.tube}`]), ...(this.tall > 1 ? [`heights × ${this.tall}: dips look steeper`] : []), ...(wells.note ? ['places not stated'] : [])];
    const lines = captionLines(ink, words, rect.width - 120); // beside the compass
    lines.forEach((text, i) => label(ink, text, rect.left + rect.width - 10, rect.height - 14 - 16 * (lines.length - 1 - i), { colour: palette.ink, halo: palette.paper, align: 'right' }));
    /** @type {Words[]} */
    const asked = all.flatMap(({ well, tops, picks }) => [
      ...tops.map((top) => ({ well, depth: top.start, plane: top.plane, side: /** @type {1} */ (1), texts: [topInWords(top, well.path), top.name], colour: palette.ink, rank: 0 })),
      ...picks.map((plane) => ({ well, depth: plane.depth, plane, side: /** @type {-1} */ (-1), texts: [anglesOf(plane, well.path)], colour: palette.picks[plane.kind], rank: plane.kind === 'bed' ? 3 : 1 })),
      ...casingsIn(well.store).filter(([, , stop]) => stop !== null && stop <= well.store.span[1]).map((casing) => ({ well, depth: casing[2] ?? 0, plane: null, side: /** @type {-1} */ (-1), texts: [shoeInWords(casing, view.units), 'shoe'], colour: palette.ink, rank: 2 })),
      ...(near ? this.depthsOf(well, rect) : []).map(({ depth, text }) => ({ well, depth, plane: null, side: /** @type {1} */ (1), texts: [text], colour: palette.soft, rank: 4 })),
    ]);
    this.write(ink, rect, asked, palette);
    drawn.slice(0, -1).forEach((well, i) => { // where a bed ends that one of two wells lacks is not known
      for (const { name } of wells.shown.fence ? wells.tops : []) {
        const { a, b, base, lacks } = joined(well, drawn[i + 1], name);
        if (!a || !b || !base || !lacks || wells.hidden.has(name)) continue;
        const ends = [...a.map((depth) => this.at(well, depth)), ...b.map((depth) => this.at(drawn[i + 1], depth))];
        const at = this.project(scaled(ends.reduce((sum, point) => plus(sum, point)), 0.25), rect);
        if (at) label(ink, '?', ...at, { colour: palette.ink, halo: palette.paper, align: 'center', font: BOLD, yields: true });
      }
    });
    if (wells.shown.box) this.letterBox(ink, rect, palette);
  }

  // Return round measured depths of a well, far enough apart in the picture to be read.
  /** @param {import('./well.js').Well} well @param {Rect} rect */
  depthsOf(well, rect) {
    const [top, bottom] = well.store.span;
    const ends = [top, bottom].map((depth) => this.project(this.at(well, depth), rect));
    if (!ends[0] || !ends[1]) return [];
    const pixels = Math.hypot(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]);
    const { units } = this.wells.view;
    const { values, digits } = ticks(top, bottom, Math.max(pixels, APART), APART, LENGTHS[units].depth.scale);
    return values.map((depth) => ({ depth, text: `MD ${showDepth(depth, units, digits)}` }));
  }

  // Return the axis and both edges of a hole in the picture, off which words keep.
  /** @param {import('./well.js').Well} well @param {Rect} rect @returns {Stroke[]} */
  outline(well, rect) {
    const radius = scaled(this.wells.gpu.outside.axes[0], well.store.bitRadius * this.wells.tube);
    const places = along(well.store.span, STEPS).map((depth) => this.at(well, depth));
    const seen = places.flatMap((place) => {
      const [at, edge] = [this.project(place, rect), this.project(plus(place, radius), rect)];
      return at && edge ? [{ at, half: edge[0] - at[0] }] : [];
    });
    return seen.slice(1).flatMap(({ at: [x, y], half }, i) => {
      const [left, top] = seen[i].at;
      const long = Math.hypot(x - left, y - top) || 1;
      return [-half, 0, half].map((by) => [(by * (top - y)) / long, (by * (x - left)) / long]).map(([dx, dy]) => /** @type {Stroke} */ ([left + dx, top + dy, x + dx, y + dy]));
    });
  }

  // Write words beside the holes, those of most consequence (the least `rank`) first: at `side` of their disc or else at the other, in
  // its row or one near it, to which a line then leads. Where they would touch a hole, its discs or other words, or stand in another
  // order than their depths, they are left out.
  /** @param {Ink} ink @param {Rect} rect @param {Words[]} asked @param {Palette} palette */
  write(ink, rect, asked, palette) {
    const { wells: { gpu: { outside: camera }, tube } } = this;
    const places = asked.flatMap((one) => {
      const { well, depth, plane } = one;
      const place = this.at(well, depth);
      const at = this.project(place, rect);
      const ends = [-1, 1].map((way) => this.project(plus(place, camera.axes[0], way * 1.2 * well.store.bitRadius * tube), rect));
      const rim = [...ends, ...(plane ? this.disc(well, plane).filter(({ wide }) => wide).map(({ edge }) => this.project(edge, rect)) : [])].filter((edge) => edge !== null);
      return at ? [{ ...one, y: at[1], rim, from: Math.min(...rim.map(([x]) => x)), to: Math.max(...rim.map(([x]) => x)) }] : [];
    });
    ink.canvas.strokes.push(...places.flatMap(({ plane, rim }) => (plane ? rim.slice(3).map((edge, i) => /** @type {Stroke} */ ([...rim[i + 2], ...edge])) : [])));
    /** @type {{ well: import('./well.js').Well, way: number, y: number, row: number }[]} */
    const written = [];
    for (const { well, y, from, to, side, texts, colour } of places.sort((one, other) => one.rank - other.rank || one.y - other.y)) {
      for (const text of texts) {
        ink.font = SMALL_BOLD;
        const { width } = ink.measureText(text);
        const spots = ROWS.flatMap(([, dy]) => [side, -side].map((way) => ({ way, x: way > 0 ? to + 7 : from - 7 - width, row: y + dy })))
          .filter(({ way, x, row }) => x > rect.left + 4 && x + width < rect.left + rect.width - 4 && written.every((one) => one.well !== well || one.way !== way || (y - one.y) * (row - one.row) >= 0));
        const place = spots.length && label(ink, text, 0, 0, { colour, halo: palette.paper, font: SMALL_BOLD, near: spots.map(({ x, row }) => [x, row]), yields: true, margin: 2 });
        if (!place) continue;
        const [x, row] = place;
        const way = x > from ? 1 : -1;
        written.push({ well, way, y, row });
        if (row !== y) line(ink, way > 0 ? x - 2 : x + width + 2, row, way > 0 ? to : from, y, colour, [], 1); // it stands in another row
        break;
      }
    }
  }

  // Write true depths at an upright edge of the box, and east and north along the floor.
  /** @param {Ink} ink @param {Rect} rect @param {Palette} palette */
  letterBox(ink, rect, palette) {
    const { low, high } = this;
    const { units } = this.wells.view;
    const [east, north, up] = this.ticks();
    /** @param {Vector} place @param {string} text @param {CanvasTextAlign} align @param {number} dx @param {number} dy */
    const at = (place, text, align, dx, dy) => {
      const seen = this.project(place, rect);
      ink.font = SMALL;
      const start = seen ? seen[0] + dx - (align === 'right' ? ink.measureText(text).width : 0) - rect.left : -1;
      if (seen && start > 0 && start + ink.measureText(text).width < rect.width) label(ink, text, seen[0] + dx, seen[1] + dy, { colour: palette.soft, halo: palette.paper, align, font: SMALL, yields: true, margin: 3 });
    };
    const { back: [x, y], front } = this.sides();
    const ends = [[x, front[1]], [front[0], y]].map(([across, along]) => [across, along, high[2]]);
    const [edge] = ends.sort((a, b) => (this.project(a, rect)?.[0] ?? 0) - (this.project(b, rect)?.[0] ?? 0)); // the left one
    for (const tick of up) at([edge[0], edge[1], tick.at], depthNumber(-tick.place, units, 0), 'right', -6, 0);
    const head = this.project(edge, rect);
    if (head) label(ink, `TVD ${depthUnit(units)}`, Math.max(52, head[0] - 6), head[1] - 8, { colour: palette.ink, halo: palette.paper, align: 'right', font: BOLD, yields: true, margin: 3 });
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

const DASHES = Array.from({ length: 16 }, (_, i) => [i / 16, (i + 0.55) / 16]); // of an edge from well to well
/** @param {Plane} plane @returns {Vector} */
const normalOf = ({ a, b, frame: { high, right, tangent } }) => normalised(eastNorthUp(tangent.map((t, i) => t - a * high[i] - b * right[i])));
/** @param {Vector} ends @param {number} steps */
const along = ([start, stop], steps) => Array.from({ length: steps + 1 }, (_, i) => start + ((stop - start) * i) / steps);

// Return whether top and base of a bed lie in the measured hole of the well: only those are joined with another well's.
/** @param {import('./well.js').Well} well @param {string} name */
export function drilled({ store }, name) {
  const [, start, stop] = store.intervals.find(([one]) => one === name) ?? ['', NaN, NaN];
  return [start >= store.span[0] - 1e-6, (stop ?? Infinity) < store.span[1] - Math.abs(store.levels[0].pitch)];
}

// Return a bed in two neighbours (`a`, `b`), whether its top and its base lie in the measured hole of both, and whether one of them
// lacks the bed: where it ends between them is not known.
/** @param {import('./well.js').Well} one @param {import('./well.js').Well} next @param {string} name */
export function joined(one, next, name) {
  const [a, b] = [bed(one, name) ?? contact(next, one, name), bed(next, name) ?? contact(one, next, name)];
  const none = [a, b].map((ends) => ends !== null && ends[0] === ends[1]);
  const [top, base] = [0, 1].map((end) => [one, next].every((well, i) => none[i] || drilled(well, name)[end]));
  return { a, b, top, base, lacks: none.includes(true) };
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


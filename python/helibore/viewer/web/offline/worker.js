// The worker: bytes of a file in, columns with roles out; then samples and wall, and what the viewer's server does.

import { openArchive, samplesIn } from './archive.js';
import { Core, METHODS, REFERENCES } from './core.js';
import { figuresOf, windowTurns, zonesOf } from './figures.js';
import { glbOf } from './glb.js';
import { agesOf, historyOf } from './history.js';
import { isLas, readLas } from './las.js';
import { chooseLeftOut } from './left_out.js';
import { guess, sectorsOf } from './roles.js';
import { Refusal, rules, setRules } from './rules.js';
import { column, guessBit, samplesOf } from './samples.js';
import { framesAlong, sceneOf } from './scene.js';
import { Served } from './served.js';
import { decodeText, readTable } from './table.js';

const LARGEST = 512 * 2 ** 20; // bytes of a file
const MOST_VERTICES = 8_000_000;
const RUGOSITY_WINDOW = 1; // metres
const SURFACE = 0.001; // metres
const VERTICAL = 1e-6; // sine of the inclination, up to which a hole has no azimuth
const DEGREES = 180 / Math.PI;

/**
 * @typedef {{ settings: import('./core.js').Fields, stations: { depth: Float64Array, inclination: Float64Array, azimuth: Float64Array } }} Survey
 * @typedef {{ helix: import('./core.js').Helix, bit: number, basis: string, basisText: string, kept: number, arms: number, vertices: import('./scene.js').Vertices, samples: import('./core.js').Places & { time: Float64Array | null }, ofArms: import('./core.js').Arms | null, rule: number[], settings: import('./core.js').Fields | null, left: Record<string, number>, found: string[], reference: string | null, survey: Survey | null }} Rebuilt
 */

/** @type {Promise<Core>} */
let core;
/** @type {import('./table.js').LogSet | null} */
let set = null;
/** @type {import('./archive.js').Archive | null} */
let archive = null;
/** @type {Survey['stations'] | null} */
let stations = null; // of the survey beside the file
let name = '';
/** @type {Served | null} */
let served = null; // the wall that is shown
/** @type {import('./served.js').PageParts} */
let pageParts;

/** @param {ArrayBuffer} bytes */
function logOf(bytes) {
  const text = decodeText(bytes);
  if (!text.trim()) throw new Refusal('the file is empty: export the log again');
  return isLas(text) ? readLas(text) : readTable(text);
}

// Read a file: what it is, its columns, and their roles with reasons.
/** @param {ArrayBuffer} bytes @param {string} fileName @param {Core} engine */
export function read(bytes, fileName, engine) {
  set = archive = stations = null;
  name = fileName;
  if (bytes.byteLength > LARGEST) throw new Refusal(`${(bytes.byteLength / 2 ** 20).toFixed(0)} MB: this page reads files of up to ${LARGEST / 2 ** 20} MB; helibore reads larger ones on the command line`);
  const head = new Uint8Array(bytes.slice(0, 4));
  if (head[0] === 0x1f && head[1] === 0x8b) throw new Refusal('the file is gzipped: unpack it first');
  if (head[0] === 0x50 && head[1] === 0x4b) {
    archive = openArchive(bytes, engine);
    return whatIsIn(archive);
  }
  const found = logOf(bytes);
  const image = sectorsOf(found);
  if (image) throw new Refusal(`${image} has numbered columns, an image of sectors, which this page does not read; helibore view FILE does`);
  set = found;
  const roles = guess(found);
  return {
    format: found.format, rows: found.rows, remarks: found.remarks, roles, missing: Object.fromEntries(found.channels.map((channel) => [channel.name, channel.missing])),
    bit: bitOf(roles), well: found.header.WELL ?? '',
  };
}

// Read a survey: depth, inclination and azimuth of its stations. Return in words what it holds.
/** @param {ArrayBuffer} bytes @param {string} fileName */
export function readSurvey(bytes, fileName) {
  stations = null;
  const found = logOf(bytes);
  const roles = guess(found);
  const [depth, inclination, azimuth] = ['depth', 'inclination', 'azimuth'].map((wanted) => {
    const role = roles.find(({ role: of }) => of === wanted);
    if (!role) throw new Refusal(`${fileName}: no column of the survey has the role ${wanted}`);
    const values = column(found, role);
    const lost = values.findIndex(Number.isNaN);
    if (lost >= 0) throw new Refusal(`${fileName}: station ${lost + 1} has no ${wanted}`);
    return values;
  });
  stations = { depth, inclination, azimuth };
  return `${depth.length} stations, ${depth[0].toFixed(1)} to ${depth[depth.length - 1].toFixed(1)} m`;
}

// Place a wall along the survey that was read, as the package does where toolfaces count from the high side.
/** @param {import('./core.js').Helix} helix @param {number} count @param {string | null} reference @returns {Survey | null} */
function surveyFor({ startDepth, pitch, sectors }, count, reference) {
  if (!stations) return null;
  if (reference === 'north') throw new Refusal('the toolfaces count from north, which this page does not turn to the high side: helibore view FILE --survey SURVEY');
  const [first, last] = [stations.depth[0], stations.depth[stations.depth.length - 1]];
  const [top, bottom] = [startDepth, startDepth + ((count - 1) * pitch) / sectors].sort((a, b) => a - b);
  if (top < first - 1e-9 || bottom > last + 1e-9) throw new Refusal(`the wall lies from ${top.toFixed(2)} to ${bottom.toFixed(2)} m, the survey from ${first.toFixed(2)} to ${last.toFixed(2)} m: give a longer survey`);
  return { settings: { extend: 0, head_down: 0 }, stations };
}

/** @param {import('./archive.js').Archive} archive */
function whatIsIn({ contents: { settings, images, attributes, version, made_from: made } }) {
  const others = [...images.map((/** @type {any} */ { key }) => `image ${key}`), ...attributes.map((/** @type {any} */ { name: of }) => of)];
  const remarks = others.length ? [`not shown here: ${others.join(', ')}; helibore view FILE shows all`] : [];
  return { format: `archive of a wall, version ${version}`, rows: 0, remarks, roles: [], missing: {}, bit: { size: settings.bit_diameter, why: 'of the archive' }, well: made?.header?.well ?? '' };
}

/** @param {import('./roles.js').Role[]} roles */
export function bitOf(roles) {
  try {
    return set && guessBit(set, roles);
  } catch {
    return null; // a unit is missing: the wall will say it
  }
}

// Rebuild the wall from the columns with these roles.
/** @param {Core} engine @param {import('./roles.js').Role[]} roles @param {number} bit @returns {Rebuilt} */
export function rebuild(engine, roles, bit) {
  if (!set) throw new Refusal('no file is open');
  if (!(bit >= 0.01 && bit <= 4)) throw new Refusal('the bit size must be a number between 0.01 and 4 m');
  const { depth, toolface, radius, time, ...prepared } = samplesOf(engine, set, roles, bit);
  const made = { bit_diameter: bit, most_vertices: MOST_VERTICES };
  const wall = engine.wall(made);
  try {
    wall.append(depth, toolface, radius, time);
    const { settings, state } = wall;
    const helix = { startDepth: state.start_depth, startToolface: settings.start_toolface, pitch: settings.pitch, sectors: settings.sectors };
    const samples = { depth: wall.samples('depth'), toolface: wall.samples('toolface'), radius: wall.samples('radius'), time: time && wall.samples('time') };
    const vertices = { radius: wall.column('radius'), nearest: wall.column('nearest'), support: wall.column('support') };
    const basisText = prepared.arms > 1 ? 'radius measured by the arms of a caliper' : 'radius measured by an azimuthal caliper';
    const measured = { ...vertices, marks: engine.measured(helix, samples, vertices.radius, rules.measured) };
    const ofArms = prepared.arms > 1 ? { depth, toolface, radius, arm: prepared.arm, time, reach: settings.max_distance } : null;
    return { ...prepared, helix, bit, basis: 'azimuthal', basisText, kept: radius.length, vertices: measured, samples, ofArms, rule: rules.measured, settings: made, survey: surveyFor(helix, vertices.radius.length, prepared.reference) };
  } finally {
    wall.close();
  }
}

// Return the settings with which the core rebuilds the wall of an archive; null if it cannot.
/** @param {import('./archive.js').Contents} contents */
function settingsOf({ settings, start_depth: start, basis }) {
  const estimator = ['inverse-distance', 'kriging'].indexOf(settings.estimator);
  if (estimator < 0 || settings.window !== null || settings.first_vertex || basis !== 'azimuthal') return null;
  const numbers = Object.fromEntries(['bit_diameter', 'sectors', 'pitch', 'start_toolface', 'neighbors', 'power', 'max_iterations', 'tolerance', 'angular_scale', 'nugget'].map((key) => [key, settings[key]]));
  return { ...numbers, estimator, start_depth: start, stop_depth: settings.stop_depth ?? NaN, max_distance: settings.max_distance ?? Infinity, kriging_range: settings.kriging_range ?? 0, most_vertices: MOST_VERTICES };
}

// Return the standard uncertainty of each radius, from a wall that is rebuilt with what it needs; null: it is not known.
/** @param {Core} engine @param {Rebuilt} rebuilt */
export function sigmaOf(engine, { settings, samples, helix, vertices, basis, rule: [, , reach, largest] }) {
  const leftOut = basis === 'azimuthal' && settings && chooseLeftOut(samples, helix);
  if (!leftOut || !settings) return null;
  const wall = engine.wall({ ...settings, sigma: 1 });
  try {
    wall.append(samples.depth, samples.toolface, samples.radius);
    return wall.state.vertices === vertices.radius.length ? wall.calibratedSigma({ reach, largest }, leftOut, rules.left_out) : null;
  } finally {
    wall.close();
  }
}

// Return the wall of an archive, as it was saved.
/** @param {Core} engine @returns {Rebuilt} */
export function reopen(engine) {
  if (!archive) throw new Refusal('no archive is open');
  const { contents: { settings, basis, start_depth: startDepth, arms, path }, array } = archive;
  const helix = { startDepth, startToolface: settings.start_toolface, pitch: settings.pitch, sectors: settings.sectors };
  const { samples, arms: ofArms } = samplesIn(archive);
  const vertices = { radius: array('vertices/radius'), nearest: array('vertices/nearest'), support: array('vertices/support', '<i4') };
  const [depth, toolface] = rules.measured;
  const rule = [depth, toolface, settings.gap_reach, settings.largest_gap, rules.measured[4]];
  const marks = engine.measured(helix, samples, vertices.radius, rule);
  const survey = path && {
    settings: { method: METHODS.indexOf(path.method), reference: REFERENCES.indexOf(path.reference), head_north: path.head[0], head_east: path.head[1], head_down: path.head[2], extend: path.extend },
    stations: { depth: array('survey/depth'), inclination: array('survey/inclination'), azimuth: array('survey/azimuth') },
  };
  return {
    helix, bit: settings.bit_diameter, basis, basisText: arms.length ? 'radius measured by the arms of a caliper' : rules.bases[basis], kept: samples.depth.length, arms: arms.length ? 2 : 1,
    vertices: { ...vertices, marks }, samples, ofArms, rule, settings: settingsOf(archive.contents), left: {}, found: [], reference: path?.reference ?? null, survey,
  };
}

// Measure the turns of a wall, and find its zones; null where its shape is assumed.
/** @param {Core} engine @param {Rebuilt} rebuilt */
export function measure(engine, rebuilt) {
  const { helix, bit, basis, samples, vertices: { radius }, rule, ofArms, survey } = rebuilt;
  const found = basis === 'azimuthal' ? engine.zones(helix, bit, samples, radius, rule, ofArms) : null;
  const figures = figuresOf(engine.logs(helix, radius, windowTurns(RUGOSITY_WINDOW, helix.pitch)), found, rebuilt, (depth) => (survey ? onPath(engine, survey, depth) : []), (depth) => agesOf(samples.depth, samples.time, depth, Math.abs(helix.pitch)));
  return { figures, zones: found && zonesOf(found), shape: found?.arms.length ? 'arms' : 'wall' };
}

// Return true depth, inclination and azimuth of a path at some depths, NaN beyond its ends and where they are not known.
/** @param {Core} engine @param {Survey} survey @param {Float64Array} depths */
function onPath(engine, survey, depths) {
  const { stations: { depth }, settings: { extend } } = survey;
  const [top, bottom] = [depth[0], depth[depth.length - 1] + extend];
  const { position, frame } = engine.alongPath(survey, depths.map((at) => Math.min(Math.max(at, top), bottom)));
  const zero = trueDepth(survey)?.[2] ?? NaN;
  const each = (/** @type {(at: number) => number} */ of) => depths.map((at, row) => (at >= top && at <= bottom ? of(row) : NaN));
  const level = depths.map((_, row) => Math.hypot(frame[9 * row + 6], frame[9 * row + 7]));
  return [
    { name: 'TVD', unit: 'm', values: each((row) => position[3 * row + 2] - zero) },
    { name: 'INCL', unit: 'deg', values: each((row) => DEGREES * Math.atan2(level[row], frame[9 * row + 8])) },
    { name: 'AZIM', unit: 'deg', values: each((row) => (level[row] > VERTICAL ? (DEGREES * Math.atan2(frame[9 * row + 7], frame[9 * row + 6]) + 360) % 360 : NaN)) },
  ];
}

/** @param {Core} engine @param {Record<string, any>} given */
function show(engine, { roles, bit, well, picks }) {
  served = null;
  const rebuilt = archive ? reopen(engine) : rebuild(engine, roles, bit);
  const { helix, survey, vertices, left, found, kept, arms, reference, basis, basisText } = rebuilt;
  const shape = { ...helix, well: well || name.replace(/\.[^.]*$/, ''), basis, basisText, reference, bit: rebuilt.bit };
  const scene = sceneOf(shape, vertices, survey ? framesAlong(engine, survey) : undefined);
  if (survey) Object.assign(scene.hello, { reference: reference ?? 'high-side', assumed: !reference });
  if (survey) scene.state.true_depth = trueDepth(survey);
  served = new Served(scene, () => measure(engine, rebuilt), () => sigmaOf(engine, rebuilt), (...ends) => glbOf(engine, rebuilt, shape.well, ...ends), () => historyOf(rebuilt.samples.depth, rebuilt.samples.time, helix, vertices.radius.length), pageParts, picks, (changed) => postMessage({ picks: changed }));
  let [there, sure] = [0, 0];
  for (let k = 0; k < vertices.radius.length; k++) if (Number.isFinite(vertices.radius[k])) [there, sure] = [there + 1, sure + Number(vertices.marks[k] === 1)];
  return { ends: scene.ends, left, found, kept, arms, between: there ? 1 - sure / there : 0, zoned: basis === 'azimuthal' };
}

// Return the depths between which a survey gives true depths, and the "down" at which they are 0; null: not known (true_depth.py).
/** @param {Survey} survey */
function trueDepth({ settings: { head_down: down, extend }, stations: { depth } }) {
  const ends = [depth[0], depth[depth.length - 1] + extend];
  if (Math.abs(depth[0]) <= SURFACE) return [...ends, down];
  return down === 0 ? null : [...ends, 0];
}

/** @param {MessageEvent} event */
async function answer({ data: { id, ask, ...given } }) {
  try {
    let found;
    if (ask === 'open') {
      setRules(given.rules);
      pageParts = given.page;
      core = Core.open(given.wasm);
      found = (await core).version;
    } else if (ask === 'read') found = read(given.bytes, given.name, await core);
    else if (ask === 'survey') found = readSurvey(given.bytes, given.name);
    else if (ask === 'bit') found = bitOf(given.roles);
    else if (ask === 'serve') served?.attach(given.port);
    else if (ask === 'save') found = served?.exported(null);
    else found = show(await core, given);
    postMessage({ id, found });
  } catch (error) {
    const known = error instanceof Refusal || /** @type {any} */ (error)?.constructor?.name === 'CoreError';
    const message = /** @type {Error} */ (error)?.message ?? String(error);
    postMessage({ id, refused: known ? message : `this page failed on the file (${message}); helibore may read it on the command line` });
  }
}

if (typeof document === 'undefined' && typeof self !== 'undefined') self.onmessage = answer; // in a worker, not in Node.js

// From channels with roles to the samples of a wall: units, checks for likely mistakes, and the core's default preparation. What
// the package would do beyond that, such as turning by a survey, this page does not do: it refuses the file and names the command.

import { Refusal, rules, unitOf } from './rules.js';

/**
 * @typedef {import('./roles.js').Role} Role
 * @typedef {import('./table.js').LogSet} LogSet
 * @typedef {{ depth: Float64Array, toolface: Float64Array, radius: Float64Array, time: Float64Array | null, arm: Float64Array, arms: number, left: Record<string, number>, found: string[], reference: string | null, direction: boolean }} Samples
 */

export const WALL = ['radius', 'diameter'];
const MANY = 1 << 16;
const FEW = 5;
const COMMAND = 'helibore view FILE --bit-diameter SIZE';
const INCH = () => rules.units.in[1];

// Return the values that are not missing.
/** @param {Float64Array} values */
function present(values) {
  const found = new Float64Array(values.length);
  let count = 0;
  for (let at = 0; at < values.length; at++) if (!Number.isNaN(values[at])) found[count++] = values[at];
  return found.subarray(0, count);
}

// Return the least and the greatest of the values that are not missing.
/** @param {Float64Array} values */
function extremes(values) {
  let [low, high] = [Infinity, -Infinity];
  for (let at = 0; at < values.length; at++) {
    if (values[at] < low) low = values[at];
    if (values[at] > high) high = values[at];
  }
  return [low, high];
}

// Return values evenly from all, enough for a median.
/** @param {Float64Array} values */
function someOf(values) {
  const step = Math.max(1, Math.floor(values.length / MANY));
  return Float64Array.from({ length: Math.ceil(values.length / step) }, (_, at) => values[at * step]);
}

// Return the median of values, which are sorted here.
/** @param {Float64Array} values */
export function median(values) {
  const sorted = values.toSorted();
  const half = sorted.length >> 1;
  return sorted.length % 2 ? sorted[half] : (sorted[half - 1] + sorted[half]) / 2;
}

// Return a channel in metres, degrees or seconds.
/** @param {LogSet} set @param {Role} role */
export function column(set, { channel: name, role, unit }) {
  const channel = set.channels.find((each) => each.name === name);
  const values = channel?.values;
  if (!channel || !values) throw new Refusal(`column ${name}: not every cell is a number`);
  const kind = rules.roles[role];
  if (!unit) {
    if (!kind || role === 'time') return values;
    if (kind === 'angle' && (!channel || values.some((value) => Math.abs(value) > 2 * Math.PI + 1e-6) || channel.missing === values.length)) return values;
    throw new Refusal(`column ${name}: its unit is not stated; choose it below`);
  }
  const known = unitOf(unit);
  if (known?.[0] !== kind) throw new Refusal(`column ${name}: "${unit}" is no unit of ${kind}; choose it below`);
  return known[1] === 1 ? values : values.map((value) => value * known[1]);
}

/** @param {Role} role @param {Float64Array} values @param {number | null} bit */
function checkLengths({ channel, role, unit, stated }, values, bit) {
  const found = present(values);
  if (!found.length) throw new Refusal(`column ${channel}: every value is missing`);
  const middle = median(someOf(found));
  const scale = role === 'diameter' ? 2 : 1;
  const [low, high] = [0.02 * scale, scale];
  if (!(middle >= low && middle <= high)) {
    const raw = middle / (unitOf(unit)?.[1] ?? 1);
    const likely = ['m', 'cm', 'mm', 'in', 'ft'].filter((name) => raw * rules.units[name][1] >= low && raw * rules.units[name][1] <= high);
    throw new Refusal(`column ${channel}: its median is ${middle.toPrecision(3)} m if the unit is ${unit}, no ${role} of a borehole${likely.length ? `; ${likely.join(' or ')} would fit` : ''}`);
  }
  if (role === 'diameter') {
    if (bit !== null && !stated && Math.abs((2 * middle) / bit - 1) < 0.25) throw new Refusal(`column ${channel}: its median of ${middle.toPrecision(3)} m looks like a radius; choose the role below`);
    return;
  }
  if (bit === null && (stated || found.length < FEW)) return;
  const near = (/** @type {number} */ inches, /** @type {number[]} */ sizes) => sizes.some((size) => inches / size - 1 >= -0.005 && inches / size - 1 <= 0.03);
  const looks = bit === null ? near(middle / INCH(), rules.small_bits) && !near((2 * middle) / INCH(), rules.large_bits) : Math.abs(middle / bit - 1) < 0.25;
  if (looks) throw new Refusal(`column ${channel}: its median of ${middle.toPrecision(3)} m looks like a diameter; choose the role below`);
}

/** @param {Role} role @param {Float64Array} values @param {Float64Array} raw */
function checkDepths({ channel, stated }, values, raw) {
  const found = present(values);
  if (found.length < 1) throw new Refusal(`column ${channel}: every value is missing`);
  for (const odd of extremes(raw)) {
    if (!rules.likely_nulls.includes(odd)) continue;
    const others = raw.filter((value) => Number.isFinite(value) && value !== odd);
    const [least, most] = extremes(others);
    if (others.length && !(odd >= 2 * least - most - 100 && odd <= 2 * most - least + 100)) throw new Refusal(`column ${channel}: ${odd} stands in some rows and may mean no value: helibore view FILE --set nulls=${odd}`);
  }
  if (found.length >= FEW && !stated && found.every((value) => value < 0)) throw new Refusal(`column ${channel}: negative throughout (elevations?); depth counts positive down the hole`);
}

/** @param {Role} role @param {Float64Array} values */
function checkAngles({ channel, unit, stated }, values) {
  const found = present(values);
  if (!found.length) throw new Refusal(`column ${channel}: every value is missing`);
  const [low, high] = extremes(found);
  if (low < -720 || high > 720) throw new Refusal(`column ${channel}: ${low < -720 ? low : high} degrees: an angle lies within -720 and 720`);
  if (low >= -Math.PI - 1e-3 && high <= 2 * Math.PI + 1e-3 && high - low > 3 && !stated && found.length >= 4 * FEW) throw new Refusal(`column ${channel}: values between ${low.toPrecision(3)} and ${high.toPrecision(3)} ${unit} look like radians; choose the unit below`);
}

// Return in words what the default preparation found, and what it left out.
/** @param {Float64Array} depth @param {{ channel: string }[]} columns @param {import('./core.js').Suspect[]} suspects */
function findings(depth, columns, suspects) {
  /** @type {Record<string, string>} */
  const said = { closed: 'all arms are closed', ramp: 'the arms close or open', saturated: 'stays at its limit', stuck: 'does not move while the other arms do', disagreement: 'differs from another arm that looks in the same direction' };
  /** @type {Map<string, { rows: number, low: number, high: number, dropped: boolean }>} */
  const found = new Map();
  for (const { cause, column: number, first, stop, dropped } of suspects) {
    if (!said[cause]) continue;
    const name = cause === 'closed' || cause === 'ramp' || number < 0 ? said[cause] : `${columns[number].channel} ${said[cause]}`;
    const at = found.get(name) ?? { rows: 0, low: Infinity, high: -Infinity, dropped: false };
    for (let row = first; row < stop; row++) [at.low, at.high] = [Math.min(at.low, depth[row] || at.low), Math.max(at.high, depth[row] || at.high)];
    found.set(name, { ...at, rows: at.rows + stop - first, dropped: at.dropped || dropped });
  }
  return [...found].map(([name, { rows, low, high, dropped }]) => `${name} in ${rows.toLocaleString('en')} row${rows === 1 ? '' : 's'}${low <= high ? `, ${low.toFixed(1)} to ${high.toFixed(1)} m` : ''}: ${dropped ? 'left out' : 'kept'}`);
}

// Return the seconds since 1970 of dates, or null if they are no dates.
/** @param {string[]} texts */
function secondsOf(texts) {
  const seconds = new Float64Array(texts.length).fill(NaN);
  for (let row = 0; row < texts.length; row++) {
    const cell = texts[row].trim();
    if (!cell || /^nat$/i.test(cell)) continue;
    const found = /^(\d{4})-(\d\d)-(\d\d)[T ](\d\d):(\d\d)(?::(\d\d)(?:\.(\d{1,6}))?)? ?(?:Z|UTC)?$/.exec(cell);
    if (!found) return null;
    const [year, month, day, hour, minute, second] = found.slice(1, 7).map((part) => Number(part ?? 0));
    seconds[row] = (Date.UTC(year, month - 1, day, hour, minute, second) * 1000 + Number((found[7] ?? '').padEnd(6, '0'))) / 1e6;
  }
  return seconds;
}

// Return the samples for a bit diameter, metres; raise a Refusal where the package would do more than its default preparation.
/** @param {import('./core.js').Core} core @param {LogSet} set @param {Role[]} roles @param {number} bit @returns {Samples} */
export function samplesOf(core, set, roles, bit) {
  /** @param {string} role */
  const one = (role) => roles.find((each) => each.role === role);
  const [depthRole, turning, timed, inclined, azimuth] = ['depth', 'toolface', 'time', 'inclination', 'azimuth'].map(one);
  const arms = roles.filter(({ role }) => WALL.includes(role));
  if (one('travel-time')) throw new Refusal(`travel times need the velocity in the mud: ${COMMAND} with the setting echo`);
  if (!arms.length) {
    const means = roles.filter(({ role }) => role === 'mean-diameter').map(({ channel }) => channel);
    throw new Refusal(means.length ? `${means.join(', ')}: a mean diameter has no direction; helibore view --average FILE:${means[0]} --bit-diameter SIZE makes a round hole` : 'no column has the role radius or diameter; choose it below');
  }
  if (!depthRole) throw new Refusal('no column has the role depth; choose it below');
  if (one('toolface-reference')) throw new Refusal(`the reference of the toolface changes from row to row, so a survey is needed: ${COMMAND} --survey FILE`);
  if (turning?.reference === 'horizontal-north' && inclined?.unit && azimuth?.unit) throw new Refusal(`${turning.channel} counts in the horizontal plane and is turned across the hole: ${COMMAND}`);
  const depth = column(set, depthRole);
  const channelOf = (/** @type {Role} */ { channel }) => /** @type {import('./table.js').Channel} */ (set.channels.find(({ name }) => name === channel));
  if (channelOf(depthRole).odd) throw new Refusal(`column ${depthRole.channel}: NaN or infinite; a depth must be finite, or empty`);
  checkDepths(depthRole, depth, /** @type {Float64Array} */ (channelOf(depthRole).values));
  const toolface = turning ? column(set, turning) : new Float64Array(set.rows);
  if (turning) checkAngles(turning, toolface);
  /** @type {{ channel: string, radius: Float64Array, mountings: number[] }[]} */
  const sensors = arms.map((arm) => {
    const values = column(set, arm);
    checkLengths(arm, values, bit);
    if (arm.angle === null && !turning) throw new Refusal(`column ${arm.channel}: no column has the role toolface, so its direction is not known; choose it below`);
    if (!turning && !arm.stated && arm.reason.includes('arm pair')) throw new Refusal(`column ${arm.channel}: an arm pair turns with the tool, and no column has the role toolface; choose it below`);
    const angle = arm.angle ?? 0;
    return arm.role === 'diameter' ? { channel: arm.channel, radius: values.map((value) => 0.5 * value), mountings: [angle, angle + 180] } : { channel: arm.channel, radius: values, mountings: [angle] };
  });
  const timeTexts = timed && channelOf(timed).texts;
  if (timeTexts && set.channels.some(({ name, texts }) => texts && name.toUpperCase() === 'DATE' && name !== timed.channel)) throw new Refusal(`date and time stand in two columns: ${COMMAND}`);
  const firstText = timeTexts?.find((cell) => cell.trim())?.trim() ?? '';
  const time = !timed ? null : timeTexts ? secondsOf(timeTexts) : column(set, timed);
  if (timeTexts && !time && /^[-\d]{8,}|^\d{4}/.test(firstText)) throw new Refusal(`column ${timed.channel}: "${firstText.slice(0, 40)}" is no date that this page reads: ${COMMAND}`);
  const mounted = sensors.flatMap(({ mountings }, at) => mountings.map((mounting) => ({ mounting, column: at })));
  const { state, suspects, ...samples } = core.prepare({ depth, toolface, time, radii: sensors.map(({ radius }) => radius), sensors: mounted }, bit);
  if (!state.samples) throw new Refusal('no row has depth, toolface and a radius');
  const left = { depth: state.no_depth, toolface: state.no_toolface, radius: state.no_radius, time: state.no_time };
  const reference = turning ? { 'high-side': 'high-side', north: 'north', 'horizontal-north': 'north' }[turning.reference] ?? null : null;
  const order = sensors.map(({ channel }) => channel).sort(); // arms are numbered by their names
  const arm = samples.arm.map((at) => order.indexOf(sensors[at].channel));
  return { ...samples, arm, arms: mounted.length, left, found: findings(depth, sensors, suspects), reference, direction: Boolean(turning) };
}

// Return a guess of the bit diameter, metres, and how it was made.
/** @param {LogSet} set @param {Role[]} roles @returns {{ size: number, why: string } | null} */
export function guessBit(set, roles) {
  const stated = roles.find(({ role, unit }) => role === 'bit-diameter' && unit);
  if (stated) {
    const known = present(column(set, stated));
    if (known.length) return { size: median(known), why: `from column ${stated.channel}` };
  }
  /** @type {number[]} */
  const low = [];
  for (const role of roles.filter(({ role: each, unit }) => WALL.includes(each) && unit)) {
    const sorted = someOf(present(column(set, role))).sort();
    if (sorted.length) low.push(sorted[Math.floor(0.05 * sorted.length)] * (role.role === 'radius' ? 2 : 1));
  }
  if (!low.length) return null;
  const least = Math.min(...low) / INCH();
  const near = rules.sizes.reduce((best, one) => (Math.abs(one[1] - least) < Math.abs(best[1] - least) ? one : best));
  return { size: near[1] * INCH(), why: 'a guess: the usual bit size nearest to the narrow part of the hole' };
}

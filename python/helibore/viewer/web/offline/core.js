// The core as WebAssembly, by its C interface (cpp/include/helibore/helibore.h): columns in, a wall out.

// The members of the structs of the header, in order. u: uint32, i: int32, d: double, l: int64.
export const STRUCTS = {
  hb_settings: 'u size, i sectors, d bit_diameter, d pitch, d start_depth, d stop_depth, d start_toolface, l window, l most_vertices, d power, d max_distance, d tolerance, d angular_scale, d kriging_range, d nugget, i neighbors, i max_iterations, i estimator, i direct, i threads, i instruction_set, i sigma, i covariance_count',
  hb_wall_state: 'u size, i reserved, l vertices, l samples, l settled, d start_depth',
  hb_change: 'u size, i reserved, l ranges, l settled, l accepted, l redundant',
  hb_path_settings: 'u size, i method, i reference, i reserved, d head_north, d head_east, d head_down, d extend',
  hb_preparation: 'u size, i drop_closed, d bit_diameter, d spikes, i drop_saturated, i drop_spikes, d turn_spikes',
  hb_prepared_state: 'u size, i reserved, l samples, l suspects, l no_depth, l no_toolface, l no_radius, l no_time, d repeats, l spikes',
  hb_sigma_rule: 'u size, i reserved, d noise, d between, d scatter_power, d distance_power, d stretch, d reach',
};
export const COLUMNS = { depth: 0, toolface: 1, radius: 2, nearest: 3, support: 4, time: 7, sensor: 8 };
export const METHODS = ['minimum-curvature', 'radius-of-curvature'];
export const REFERENCES = ['high-side', 'north', 'parallel-transport'];
export const CAUSES = ['disagreement', 'closed', 'ramp', 'saturated', 'stuck', 'burst', 'jump'];
// The columns of the logs, in order (TurnLogs of logs.hpp).
export const LOGS = /** @type {const} */ ([
  'coverage', 'mean', 'mean_square', 'smallest', 'largest', 'c1', 'c1_toolface', 'c2', 'least_diameter', 'diameter_0', 'diameter_90', 'centre_0', 'centre_90',
  'inscribed_diameter', 'inscribed_0', 'inscribed_90', 'enclosing_diameter', 'rugosity',
]);
// The columns of the zones, in order (Zone of zones.hpp).
export const ZONES = /** @type {const} */ ([
  'kind', 'start', 'stop', 'measure', 'median', 'severity', 'enlargement', 'elongation', 'peak', 'coverage', 'confidence', 'pipe_diameter', 'toolface', 'deviation',
  'lobe1_toolface', 'lobe1_opening', 'lobe1_height', 'lobe2_toolface', 'lobe2_opening', 'lobe2_height',
]);
// The columns of turns that are found with the zones, in the order of page_zones.
const WITH_ZONES = /** @type {const} */ (['arms_c1', 'arms_c1_toolface', 'arms_c2', 'arms_least', 'arms_uneven', 'unworn_diameter', 'lobe1_height', 'likely_square', 'likely_sigma']);
const MOST_ARMS = 8;
const WIDTHS = /** @type {Record<string, number>} */ ({ u: 4, i: 4, d: 8, l: 8 });

/**
 * @typedef {Record<string, number>} Fields
 * @typedef {{ startDepth: number, startToolface: number, pitch: number, sectors: number }} Helix
 * @typedef {{ depth: Float64Array, toolface: Float64Array, time: Float64Array | null, radii: Float64Array[], sensors: { mounting: number, column: number }[] }} Rows
 * @typedef {{ cause: string, column: number, first: number, stop: number, dropped: boolean, radius: number }} Suspect
 * @typedef {{ depth: Float64Array, toolface: Float64Array, radius: Float64Array }} Places samples
 * @typedef {Places & { time: Float64Array | null, arm: Float64Array, reach: number }} Arms samples with the number of the arm of each
 * @typedef {{ kinds: Int32Array, zones: Record<typeof ZONES[number], number>[], columns: Record<typeof WITH_ZONES[number], Float64Array>, arms: Float64Array[] }} Found arms: the diameters of each; none: the wall gives the shape
 * @typedef {Places & { state: Fields, suspects: Suspect[], time: Float64Array | null, arm: Float64Array }} Prepared
 */

// Return a number as std::to_chars writes it: with so many significant digits, as the format %g; 0: the fewest that read back as
// the same number, without an exponent unless this is shorter.
/** @param {number} value @param {number} digits */
export function numberText(value, digits) {
  if (!Number.isFinite(value)) return Number.isNaN(value) ? 'nan' : value < 0 ? '-inf' : 'inf';
  const sign = value < 0 || Object.is(value, -0) ? '-' : '';
  const [mantissa, power] = Math.abs(value).toExponential(digits ? digits - 1 : undefined).split('e').map((part) => part.replace(/(\.\d*?)0+$/, '$1').replace(/\.$/, ''));
  const exponent = Number(power);
  const scientific = `${mantissa}e${exponent < 0 ? '-' : '+'}${String(Math.abs(exponent)).padStart(2, '0')}`;
  const all = mantissa.replace('.', '');
  const whole = () => (digits ? all.padEnd(exponent + 1, '0') : String(BigInt(Math.abs(value))));
  const fixed = exponent < 0 ? `0.${'0'.repeat(-exponent - 1)}${all}` : exponent + 1 < all.length ? `${all.slice(0, exponent + 1)}.${all.slice(exponent + 1)}` : whole();
  return sign + ((digits ? exponent >= -4 && exponent < digits : fixed.length <= scientific.length) ? fixed : scientific);
}

// An error of the core: a bad input, with place, value and rule, or no more memory.
export class CoreError extends Error {}

export class Core {
  /** @param {WebAssembly.Instance} instance */
  constructor(instance) {
    this.c = /** @type {Record<string, any>} */ (instance.exports);
    this.c._initialize();
  }

  /** @param {BufferSource} bytes */
  static async open(bytes) {
    // What the C library would write is dropped: the core prints nothing.
    const nothing = { fd_close: () => 8, fd_seek: () => 8, fd_write: () => 8 };
    const page = { number_text: (/** @type {number} */ value, /** @type {number} */ digits, /** @type {number} */ at) => {
      const text = new TextEncoder().encode(numberText(value, digits));
      new Uint8Array(/** @type {any} */ (instance.exports.memory).buffer, at, text.length).set(text);
      return text.length;
    } };
    const { instance } = /** @type {WebAssembly.WebAssemblyInstantiatedSource} */ (/** @type {unknown} */ (await WebAssembly.instantiate(bytes, { wasi_snapshot_preview1: nothing, page })));
    return new Core(instance);
  }

  get version() {
    return this.text(this.c.hb_version());
  }

  // The memory moves when it grows, so a view of it is made anew after each call.
  get view() {
    return new DataView(this.c.memory.buffer);
  }

  /** @param {number} at */
  text(at) {
    const bytes = new Uint8Array(this.c.memory.buffer);
    return new TextDecoder().decode(bytes.slice(at, bytes.indexOf(0, at)));
  }

  // Call `work(reserve)`; what `reserve(bytes)` reserved is free again afterwards.
  /** @template Result @param {(reserve: (bytes: number) => number) => Result} work @returns {Result} */
  within(work) {
    /** @type {number[]} */
    const reserved = [];
    try {
      return work((bytes) => {
        const at = this.c.malloc(Math.max(bytes, 8)) >>> 0;
        if (!at) throw new CoreError('not enough memory in this browser tab for a file of this size');
        reserved.push(at);
        return at;
      });
    } finally {
      for (const at of reserved) this.c.free(at);
    }
  }

  /** @param {string} name @param {...any} values */
  call(name, ...values) {
    if (this.c[name](...values)) throw new CoreError(this.text(this.c.hb_last_error()));
  }

  /** @param {(bytes: number) => number} reserve @param {Float64Array} values */
  copy(reserve, values) {
    const at = reserve(8 * values.length);
    new Float64Array(this.c.memory.buffer, at, values.length).set(values);
    return at;
  }

  /** @param {number} at @param {number} count */
  floats(at, count) {
    return new Float64Array(this.c.memory.buffer, at, count).slice();
  }

  // Return where a struct of these fields stands, its size set.
  /** @param {(bytes: number) => number} reserve @param {keyof typeof STRUCTS} name @param {Fields} [fields] */
  struct(reserve, name, fields = {}) {
    const { size } = layout(name);
    const at = reserve(size);
    new Uint8Array(this.c.memory.buffer, at, size).fill(0);
    this.write(at, name, { size, ...fields });
    return at;
  }

  /** @param {number} at @param {keyof typeof STRUCTS} name @param {Fields} fields */
  write(at, name, fields) {
    const { places } = layout(name);
    const { view } = this;
    for (const [field, value] of Object.entries(fields)) {
      const { kind, offset } = places[field];
      if (kind === 'd') view.setFloat64(at + offset, value, true);
      else if (kind === 'l') view.setBigInt64(at + offset, BigInt(value), true);
      else view.setInt32(at + offset, value, true);
    }
  }

  /** @param {number} at @param {keyof typeof STRUCTS} name @returns {Fields} */
  read(at, name) {
    const { view } = this;
    return Object.fromEntries(Object.entries(layout(name).places).map(([field, { kind, offset }]) => [
      field,
      kind === 'd' ? view.getFloat64(at + offset, true) : kind === 'l' ? Number(view.getBigInt64(at + offset, true)) : view.getInt32(at + offset, true),
    ]));
  }

  // Return where a count stands: the room of an array that the library fills.
  /** @param {(bytes: number) => number} reserve @param {number} count */
  counted(reserve, count) {
    const at = reserve(8);
    this.view.setBigInt64(at, BigInt(count), true);
    return at;
  }

  // Prepare the rows of a log by the defaults of the package, NaN where a value is missing; metres, degrees and seconds.
  /** @param {Rows} rows @param {number} bit @returns {Prepared} */
  prepare({ depth, toolface, time, radii, sensors }, bit) {
    return this.within((reserve) => {
      const rows = depth.length;
      const settings = this.struct(reserve, 'hb_preparation');
      this.call('hb_preparation_init', settings);
      this.write(settings, 'hb_preparation', { bit_diameter: bit });
      const columns = reserve(8 * rows * radii.length);
      radii.forEach((values, at) => new Float64Array(this.c.memory.buffer, columns + 8 * rows * at, rows).set(values));
      const [depths, toolfaces, times] = [depth, toolface, time].map((values) => (values ? this.copy(reserve, values) : 0));
      const [offsets, mountings] = [() => 0, (/** @type {{ mounting: number }} */ { mounting }) => mounting].map((of) => this.copy(reserve, Float64Array.from(sensors, of)));
      const places = reserve(4 * sensors.length);
      new Int32Array(this.c.memory.buffer, places, sensors.length).set(sensors.map(({ column }) => column));
      const out = reserve(8);
      this.call('hb_prepare', settings, BigInt(rows), depths, toolfaces, times, radii.length, columns, sensors.length, offsets, mountings, places, out);
      const handle = this.view.getBigInt64(out, true);
      try {
        const found = this.struct(reserve, 'hb_prepared_state');
        this.call('hb_prepared_get', handle, found);
        const state = this.read(found, 'hb_prepared_state');
        const of = (/** @type {keyof typeof COLUMNS} */ name) => {
          const at = reserve(8 * state.samples);
          this.call('hb_prepared_samples', handle, COLUMNS[name], this.counted(reserve, state.samples), at);
          return this.floats(at, state.samples);
        };
        return { state, suspects: this.suspects(reserve, handle, state.suspects), depth: of('depth'), toolface: of('toolface'), radius: of('radius'), time: time && of('time'), arm: of('sensor').map((sensor) => sensors[sensor].column) };
      } finally {
        this.call('hb_close', handle);
      }
    });
  }

  /** @param {(bytes: number) => number} reserve @param {bigint} handle @param {number} count @returns {Suspect[]} */
  suspects(reserve, handle, count) {
    const [causes, columns, dropped] = [0, 1, 2].map(() => reserve(4 * count));
    const [ends, radii] = [reserve(16 * count), reserve(8 * count)];
    this.call('hb_prepared_suspects', handle, this.counted(reserve, count), causes, columns, 0, ends, dropped, radii);
    const { view } = this;
    return Array.from({ length: count }, (_, at) => ({
      cause: CAUSES[view.getInt32(causes + 4 * at, true)], column: view.getInt32(columns + 4 * at, true), dropped: view.getInt32(dropped + 4 * at, true) === 1,
      first: Number(view.getBigInt64(ends + 16 * at, true)), stop: Number(view.getBigInt64(ends + 16 * at + 8, true)), radius: view.getFloat64(radii + 8 * at, true),
    }));
  }

  /** @param {string} name @param {...any} values */
  callPage(name, ...values) {
    if (this.c[name](...values)) throw new CoreError('the core refused what this page gave it: this is a bug in helibore');
  }

  // Return 1 for each measured vertex, 2 where the wall changes too much, else 0, by a rule of five numbers (MeasuredRule of logs.hpp).
  /** @param {Helix} helix @param {Places} samples in order of depth @param {Float64Array} radius @param {number[]} rule */
  measured({ startDepth, startToolface, pitch, sectors }, samples, radius, rule) {
    return this.within((reserve) => {
      const columns = [samples.depth, samples.toolface, samples.radius, radius].map((values) => this.copy(reserve, values));
      const helix = this.copy(reserve, Float64Array.of(startDepth, startToolface, pitch));
      const marks = reserve(radius.length);
      this.callPage('page_measured', helix, sectors, radius.length, this.copy(reserve, Float64Array.from(rule)), samples.depth.length, ...columns, marks);
      return new Uint8Array(this.c.memory.buffer, marks, radius.length).slice();
    });
  }

  // Return the zones of a wall and the kind of each full turn, by the default criteria, with the measures of turns that they are found
  // from; `samples` and `rule` as of `measured`.
  /** @param {Helix} helix @param {number} bit @param {Places} samples @param {Float64Array} radius @param {number[]} rule @param {Arms | null} arms @returns {Found} */
  zones({ startDepth, startToolface, pitch, sectors }, bit, samples, radius, rule, arms) {
    const turns = Math.floor(radius.length / sectors);
    return this.within((reserve) => {
      const columns = [samples.depth, samples.toolface, samples.radius, radius].map((values) => this.copy(reserve, values));
      const helix = this.copy(reserve, Float64Array.of(startDepth, startToolface, pitch));
      const [of, count] = [arms ?? { depth: null, toolface: null, radius: null, arm: null, time: null, reach: 0 }, arms?.depth.length ?? 0];
      const places = [of.depth, of.toolface, of.radius].map((values) => (values ? this.copy(reserve, values) : 0));
      const names = reserve(8 * count);
      new BigInt64Array(this.c.memory.buffer, names, count).set(BigInt64Array.from(of.arm ?? [], BigInt));
      const time = of.time ? this.copy(reserve, of.time) : 0;
      const [kinds, measures, numbers, found] = [4 * turns, 8 * (WITH_ZONES.length + MOST_ARMS) * turns, 8 * ZONES.length * turns, 8].map(reserve);
      const room = this.copy(reserve, Float64Array.from(rule));
      this.callPage('page_zones', helix, sectors, radius.length, room, samples.depth.length, ...columns, bit, count, ...places, names, time, of.reach, kinds, measures, numbers, found);
      const [diameters, many] = new Int32Array(this.c.memory.buffer, found, 2);
      const values = this.floats(numbers, ZONES.length * many);
      const column = (/** @type {number} */ at) => this.floats(measures + 8 * turns * at, turns);
      return {
        kinds: new Int32Array(this.c.memory.buffer, kinds, turns).slice(),
        zones: Array.from({ length: many }, (_, zone) => /** @type {any} */ (Object.fromEntries(ZONES.map((name, at) => [name, values[at * many + zone]])))),
        columns: /** @type {any} */ (Object.fromEntries(WITH_ZONES.map((name, at) => [name, column(at)]))),
        arms: Array.from({ length: diameters }, (_, arm) => column(WITH_ZONES.length + arm)),
      };
    });
  }

  // Return the logs of each full turn, by the names of LOGS; `window`: turns over which rugosity is measured.
  /** @param {Helix} helix @param {Float64Array} radius @param {number} window @returns {Record<typeof LOGS[number], Float64Array>} */
  logs({ startToolface, sectors }, radius, window) {
    const turns = Math.floor(radius.length / sectors);
    return this.within((reserve) => {
      const at = reserve(8 * turns * LOGS.length);
      this.callPage('page_logs', startToolface, sectors, radius.length, this.copy(reserve, radius), window, at);
      return /** @type {any} */ (Object.fromEntries(LOGS.map((name, column) => [name, this.floats(at + 8 * turns * column, turns)])));
    });
  }

  // Call `work(reserve, path)` with the handle of a path through stations; 0: straight down. `settings` lacks size.
  /** @template Result @param {import('./worker.js').Survey | null} survey @param {(reserve: (bytes: number) => number, path: bigint) => Result} work @returns {Result} */
  onPath(survey, work) {
    return this.within((reserve) => {
      if (!survey) return work(reserve, 0n);
      const { settings, stations: { depth, inclination, azimuth } } = survey;
      const how = this.struct(reserve, 'hb_path_settings');
      this.call('hb_path_settings_init', how);
      this.write(how, 'hb_path_settings', settings);
      const out = reserve(8);
      this.call('hb_path_create', how, BigInt(depth.length), ...[depth, inclination, azimuth].map((values) => this.copy(reserve, values)), out);
      const path = this.view.getBigInt64(out, true);
      try {
        return work(reserve, path);
      } finally {
        this.call('hb_close', path);
      }
    });
  }

  // Return positions (north, east, down) and frames (nine numbers) of a path at some depths.
  /** @param {import('./worker.js').Survey} survey @param {Float64Array} depth */
  alongPath(survey, depth) {
    return this.onPath(survey, (reserve, path) => {
      const count = depth.length;
      const [position, frame] = [reserve(24 * count), reserve(72 * count)];
      this.call('hb_path_read', path, BigInt(count), this.copy(reserve, depth), position, frame);
      return { position: this.floats(position, 3 * count), frame: this.floats(frame, 9 * count) };
    });
  }

  // Return a part of the wall in space: positions (north, east, down) of its vertices, their numbers on the helix, and rows of corners.
  /** @param {Helix} helix @param {number} first @param {Float64Array} radius @param {import('./worker.js').Survey | null} survey */
  surface({ startDepth, startToolface, pitch, sectors }, first, radius, survey) {
    return this.onPath(survey, (reserve, path) => {
      const count = radius.length;
      const [positions, places, quads, found] = [24, 4, 16].map((bytes) => reserve(bytes * count)).concat(reserve(8));
      this.callPage('page_surface', this.copy(reserve, Float64Array.of(startDepth, startToolface, pitch)), sectors, first, count, this.copy(reserve, radius), path, positions, places, quads, found);
      const whole = (/** @type {number} */ at, /** @type {number} */ size) => new Int32Array(this.c.memory.buffer, at, size).slice();
      const [vertices, joined] = whole(found, 2);
      return { positions: this.floats(positions, 3 * vertices), places: whole(places, vertices), quads: whole(quads, 4 * joined) };
    });
  }

  // Return the words of an array of an archive; null if the bytes are not those of so many words.
  /** @param {Uint8Array} bytes @param {number} count */
  decompress(bytes, count) {
    return this.within((reserve) => {
      const [from, to] = [reserve(bytes.length), reserve(8 * count)];
      new Uint8Array(this.c.memory.buffer, from, bytes.length).set(bytes);
      return this.c.page_decompress(bytes.length, from, count, to) ? null : this.c.memory.buffer.slice(to, to + 8 * count);
    });
  }

  // Return a wall with these settings, the others as the library has them.
  /** @param {Fields} settings */
  wall(settings) {
    return this.within((reserve) => {
      const at = this.struct(reserve, 'hb_settings');
      const out = reserve(8);
      this.call('hb_settings_init', at);
      this.write(at, 'hb_settings', { ...settings, threads: 1 });
      this.call('hb_wall_create', at, out);
      return new Wall(this, this.view.getBigInt64(out, true), this.read(at, 'hb_settings'));
    });
  }
}

export class Wall {
  /** @param {Core} core @param {bigint} handle @param {Fields} settings */
  constructor(core, handle, settings) {
    this.core = core;
    this.handle = handle;
    this.settings = settings;
  }

  // Append samples: columns in metres, degrees, metres and seconds (or null). Return how many were taken and dropped.
  /** @param {Float64Array} depth @param {Float64Array} toolface @param {Float64Array} radius @param {Float64Array | null} [time] @returns {Fields} */
  append(depth, toolface, radius, time = null) {
    const { core } = this;
    return core.within((reserve) => {
      const columns = [depth, toolface, radius, time].map((values) => (values ? core.copy(reserve, values) : 0));
      const change = core.struct(reserve, 'hb_change');
      core.call('hb_wall_append', this.handle, BigInt(depth.length), ...columns, change);
      return core.read(change, 'hb_change');
    });
  }

  /** @returns {Fields} */
  get state() {
    const { core } = this;
    return core.within((reserve) => {
      const at = core.struct(reserve, 'hb_wall_state');
      core.call('hb_wall_get', this.handle, at);
      return core.read(at, 'hb_wall_state');
    });
  }

  // Return a column of the samples, in order of depth.
  /** @param {keyof typeof COLUMNS} name */
  samples(name) {
    const { core, state } = this;
    return core.within((reserve) => {
      const at = reserve(8 * state.samples);
      core.call('hb_wall_samples', this.handle, COLUMNS[name], core.counted(reserve, state.samples), at);
      return core.floats(at, state.samples);
    });
  }

  // Return one column of all vertices.
  /** @param {keyof typeof COLUMNS} name */
  column(name) {
    const { core } = this;
    const { vertices } = this.state;
    return core.within((reserve) => {
      const at = reserve(8 * vertices);
      core.call('hb_wall_read', this.handle, COLUMNS[name], 0n, BigInt(vertices), at);
      return core.floats(at, vertices);
    });
  }

  // Return the standard uncertainty of each radius by a rule; the wall must have been made with `sigma: 1`.
  /** @param {Fields} rule @returns {Float64Array} */
  sigma(rule) {
    const { core } = this;
    const { vertices } = this.state;
    return core.within((reserve) => {
      const at = reserve(8 * vertices);
      core.call('hb_wall_sigma', this.handle, core.struct(reserve, 'hb_sigma_rule', rule), core.counted(reserve, vertices), at);
      return core.floats(at, vertices);
    });
  }

  // Return the standard uncertainty of each radius, calibrated by samples that are left out (uncertainty.py); null if it is not known.
  // The wall must have been made with `sigma: 1`.
  /** @param {{ reach: number, largest: number }} gap around a measured vertex @param {{ rows: Float64Array, height: Float64Array, width: Float64Array }} leftOut @param {{ normal: number, unmeasured: number }} rule @returns {Float64Array | null} */
  calibratedSigma({ reach, largest }, { rows, height, width }, { normal, unmeasured }) {
    const { core } = this;
    const { vertices } = this.state;
    const measure = (/** @type {(bytes: number) => number} */ reserve) => {
      const [numbers, out, at] = [reserve(8 * rows.length), reserve(8 * 7), reserve(8 * vertices)];
      new BigInt64Array(core.c.memory.buffer, numbers, rows.length).set(BigInt64Array.from(rows, BigInt));
      core.callPage('page_calibrate', this.handle, rows.length, numbers, core.copy(reserve, height), core.copy(reserve, width), out);
      core.call('hb_wall_angular_gaps', this.handle, reach, core.counted(reserve, vertices), at);
      return { found: core.floats(out, 7).map((value) => Number(value.toPrecision(9))), gaps: core.floats(at, vertices) };
    };
    const { found: [noise, between, scatterPower, distancePower, stretch, quantile, farthest], gaps } = core.within(measure);
    if (Number.isNaN(noise)) return null;
    const ratio = quantile / normal;
    const share = ratio * ratio;
    const sigma = this.sigma({ noise: share * noise * noise, between: share * between, scatter_power: scatterPower, distance_power: distancePower, stretch, reach: farthest });
    const left = ratio * noise;
    const few = gaps.filter((gap) => gap > largest).length > unmeasured * vertices;
    return sigma.map((value, k) => (gaps[k] > largest ? NaN : few ? Math.sqrt(value * value + left * left) : value));
  }

  close() {
    this.core.call('hb_close', this.handle);
  }
}

// Return where each member of a struct stands, and the size of the struct.
/** @param {keyof typeof STRUCTS} name */
export function layout(name) {
  /** @type {Record<string, { kind: string, offset: number }>} */
  const places = {};
  let end = 0;
  for (const member of STRUCTS[name].split(', ')) {
    const [kind, field] = member.split(' ');
    const width = WIDTHS[kind];
    const offset = Math.ceil(end / width) * width;
    places[field] = { kind, offset };
    end = offset + width;
  }
  return { places, size: Math.ceil(end / 8) * 8 };
}

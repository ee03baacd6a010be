// The core as WebAssembly, by its C interface (cpp/include/helibore/helibore.h): columns in, a wall out.

// The members of the structs of the header, in order. u: uint32, i: int32, d: double, l: int64.
export const STRUCTS = {
  hb_settings: 'u size, i sectors, d bit_diameter, d pitch, d start_depth, d stop_depth, d start_toolface, l window, l most_vertices, d power, d max_distance, d tolerance, d angular_scale, d kriging_range, d nugget, i neighbors, i max_iterations, i estimator, i direct, i threads, i instruction_set, i sigma, i reserved',
  hb_wall_state: 'u size, i reserved, l vertices, l samples, l settled, d start_depth',
  hb_change: 'u size, i reserved, l ranges, l settled, l accepted, l redundant',
  hb_sigma_rule: 'u size, i reserved, d noise, d between, d scatter_power, d distance_power, d stretch, d reach',
};
export const COLUMNS = { depth: 0, toolface: 1, radius: 2, nearest: 3, support: 4 };
const WIDTHS = /** @type {Record<string, number>} */ ({ u: 4, i: 4, d: 8, l: 8 });

/** @typedef {Record<string, number>} Fields */

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
    const { instance } = /** @type {WebAssembly.WebAssemblyInstantiatedSource} */ (/** @type {unknown} */ (await WebAssembly.instantiate(bytes, { wasi_snapshot_preview1: nothing })));
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
  /** @param {Fields} rule */
  sigma(rule) {
    const { core } = this;
    const { vertices } = this.state;
    return core.within((reserve) => {
      const at = reserve(8 * vertices);
      const count = reserve(8);
      core.view.setBigInt64(count, BigInt(vertices), true);
      core.call('hb_wall_sigma', this.handle, core.struct(reserve, 'hb_sigma_rule', rule), count, at);
      return core.floats(at, vertices);
    });
  }

  // Return 1 for each measured vertex, by a rule of five numbers (MeasuredRule of logs.hpp).
  /** @param {number[]} rule */
  measured(rule) {
    const { core, settings, state } = this;
    return core.within((reserve) => {
      const places = [COLUMNS.depth, COLUMNS.toolface, COLUMNS.radius].map((column) => {
        const at = reserve(8 * state.samples);
        const count = reserve(8);
        core.view.setBigInt64(count, BigInt(state.samples), true);
        core.call('hb_wall_samples', this.handle, column, count, at);
        return at;
      });
      const found = reserve(state.vertices);
      const helix = core.copy(reserve, Float64Array.of(state.start_depth, settings.start_toolface, settings.pitch));
      core.call('page_measured', helix, settings.sectors, state.vertices, core.copy(reserve, Float64Array.from(rule)), state.samples, ...places, core.copy(reserve, this.column('radius')), found);
      return new Uint8Array(core.c.memory.buffer, found, state.vertices).slice();
    });
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

// One of several wells of a page: its connection to the server, its wall and path, and what it is drawn from.

import { Q_ATTRIBUTE, quantities, takeRanges } from './color.js';
import { Connection, socketAddress } from './connection.js';
import { planeOf } from './dips.js';
import { FINE_TILES } from './lod.js';
import { Path } from './path.js';
import { coverage, Store } from './tiles.js';

export class Well {
  store = /** @type {Store} */ (/** @type {unknown} */ (null)); // null until the server has begun it
  path = /** @type {Path} */ (/** @type {unknown} */ (null));
  /** @type {Quantity[]} */
  quantities = [];
  /** @type {Zone[]} */
  zones = [];
  /** @type {WallPick[]} */
  picks = [];
  /** @type {number | null} */
  bitDepth = null;
  made = { picks: this.picks, version: -1, planes: /** @type {Plane[]} */ ([]) };
  words = '';
  east = 0; // metres to the east of where its path has it
  hidden = false;
  mostTiles = FINE_TILES; // at once: a longer part is drawn from the overview
  /** @type {number[]} */
  wanted = []; // tiles of what was drawn last

  /** @param {ListedWell} listed @param {() => void} changed */
  constructor({ name, address, head }, changed) {
    this.name = name;
    this.address = address;
    this.head = head;
    /** @type {Handlers} */
    const on = {
      handshake: (handshake) => this.begin(handshake),
      state: (state) => this.take(state),
      picks: (picks) => (this.picks = /** @type {WallPick[]} */ (picks.filter(({ kind }) => kind !== 'note'))),
      write: (message) => this.store.apply(message),
      frames: (message) => {
        for (let i = 1; i < message.centre.length; i += 3) message.centre[i] += this.east;
        this.path.apply(message);
      },
      status: (_, words) => (this.words = words),
    };
    const followed = Object.fromEntries(Object.entries(on).map(([kind, act]) => [kind, (/** @type {any[]} */ ...values) => {
      /** @type {any} */ (act)(...values);
      changed();
    }]));
    this.connection = new Connection(socketAddress(address), /** @type {Handlers} */ (/** @type {unknown} */ (followed)));
  }

  /** @param {Handshake} handshake */
  begin(handshake) {
    if (this.store) for (const level of this.store.levels) for (const tile of level.tiles.values()) tile.textures?.dispose();
    this.store = new Store(handshake);
    this.path = new Path(handshake.start_depth, handshake.frame_step, handshake.reference, handshake.assumed, handshake.north);
    this.quantities = quantities(this.store);
    this.ask(...this.store.span);
  }

  /** @param {State} state */
  take({ ranges, zones, true_depth: trueDepth, bit_depth: bit }) {
    if (!this.store) return;
    takeRanges(this.quantities, ranges);
    this.path.trueDepth = trueDepth;
    [this.zones, this.bitDepth] = [zones, bit];
  }

  // Whether there is something to draw.
  get ready() {
    return Boolean(this.store && this.path.count > 1 && this.store.levels[1].size);
  }

  // Whether a part of what was drawn last has not arrived.
  get lacks() {
    return this.wanted.some((index) => !this.store.levels[0].tiles.has(index));
  }

  // The beds and fractures that were picked.
  get planes() {
    const { picks, path, made } = this;
    if (made.picks !== picks || made.version !== path.version) this.made = { picks, version: path.version, planes: picks.flatMap((pick) => (pick.kind === 'breakout' ? [] : [planeOf(path, pick, this.store.bitRadius)])) };
    return this.made.planes;
  }

  // Subscribe to the tiles between two depths, if they are not too many.
  /** @param {number[]} ends */
  ask(...[top, bottom]) {
    const wall = this.store.levels[0];
    const seen = wall.tilesBetween(top, bottom);
    const wanted = (this.wanted = seen.length > this.mostTiles ? [] : seen);
    for (const [index, tile] of wall.tiles) {
      if (wanted.includes(index) || wall.tiles.size <= this.mostTiles) continue;
      tile.textures?.dispose();
      wall.tiles.delete(index);
    }
    this.connection.subscribe([...new Set([...wall.tiles.keys(), ...wanted])].sort((a, b) => a - b), wanted[0] ?? 0, (1 << this.store.attributes.length) - 1);
  }

  /** @param {number} top @param {number} bottom */
  pieces(top, bottom) {
    return coverage(this.store, top, bottom, this.store.levels[0].tilesBetween(top, bottom).length <= this.mostTiles);
  }

  // Return this well's quantity with the id and colours of another well's; grey, if it has none of this id.
  /** @param {Quantity | undefined} asked @returns {Quantity} */
  quantity(asked) {
    const own = this.quantities.find(({ id }) => id === asked?.id);
    if (own && asked) return { ...own, low: asked.low, high: asked.high, log: asked.log, map: asked.map };
    return { ...this.quantities[0], id: '', length: false, name: `no ${asked?.name}`, mode: Q_ATTRIBUTE, attribute: this.store.attributes.length, low: 0, high: 1 };
  }
}

// What the viewer's server does, in the worker: the page's port brings its messages and its requests (web_app.py, client.py).

import { curveBytes, sectionCsv, summaryOf, withoutPicked } from './figures.js';
import { logsText } from './las_writing.js';
import { checked, merged, parsePicks, picksTable } from './picks.js';
import { Refusal, rules } from './rules.js';
import { framesMessages, numbered, setTrust, tileMessage, tilesOf } from './scene.js';

const MOST_ENCLOSED = 8_000_000; // vertices in an exported page
const BYTES_A_CHUNK = 0x6000; // a multiple of three: chunks of base64 join

/**
 * @typedef {import('./scene.js').Scene} Scene
 * @typedef {import('./figures.js').Figures} Figures
 * @typedef {{ figures: Figures, zones: any[] | null, shape: string }} Measured
 * @typedef {{ before: string, app: string, after: string }} PageParts
 * @typedef {{ status?: number, type?: string, name?: string, body: string | ArrayBuffer | Blob }} Answer
 */

export class Served {
  /** @param {Scene} scene @param {() => Measured} measure @param {() => Float64Array | null} sigma @param {(start: number, stop: number) => Blob} mesh @param {() => import('./history.js').History} history @param {PageParts} parts @param {any[]} picks @param {(picks: any[]) => void} keep */
  constructor(scene, measure, sigma, mesh, history, parts, picks, keep) {
    this.scene = scene;
    this.measure = measure;
    this.sigma = sigma;
    this.mesh = mesh;
    this.history = history;
    /** @type {Figures | null} */
    this.measured = null;
    this.trusted = false; // whether the texels say how sure each radius is
    this.parts = parts;
    this.picks = picks;
    this.keep = keep;
    this.sequence = 0;
    /** @type {number[][]} */
    this.held = [];
    /** @type {MessagePort | null} */
    this.port = null;
    this.close = () => {};
  }

  // Serve a page at this port.
  /** @param {MessagePort} port */
  attach(port) {
    this.port = port;
    port.onmessage = ({ data }) => this.take(data);
  }

  /** @param {any} message @param {Transferable[]} [transfer] */
  post(message, transfer = []) {
    this.port?.postMessage(message, transfer);
  }

  /** @param {any} data */
  take(data) {
    if (data.open) this.open();
    else if ('text' in data) this.receive(JSON.parse(data.text));
    else if ('id' in data) this.answer(data);
  }

  open() {
    const { scene: { hello, state }, picks } = this;
    this.held = [];
    for (const text of [hello, state, { type: 'picks', picks }]) this.post(JSON.stringify(text));
  }

  // Send the tiles that the page asks for and does not have: those near the focus first, and with the first ones path and overview.
  /** @param {{ session: string, subscribe?: { tiles: number[][], focus: number } }} message */
  receive({ session, subscribe }) {
    const { scene } = this;
    if (session !== scene.hello.session || !subscribe) return;
    const last = tilesOf(scene.wall);
    const before = this.held;
    this.held = subscribe.tiles;
    const fresh = this.held.flatMap(([start, stop]) => Array.from({ length: Math.max(0, Math.min(stop, last) - start) }, (_, at) => start + at))
      .filter((tile) => !before.some(([start, stop]) => tile >= start && tile < stop)).sort((a, b) => Math.abs(a - subscribe.focus) - Math.abs(b - subscribe.focus));
    if (!before.length) framesMessages(scene).forEach((message) => this.send(message));
    const near = before.length ? fresh.length : Math.min(fresh.length, 5);
    for (const tile of fresh.slice(0, near)) this.send(tileMessage(scene, 0, tile));
    if (!before.length) for (let tile = 0; tile < tilesOf(scene.over); tile++) this.send(tileMessage(scene, 1, tile));
    for (const tile of fresh.slice(near)) this.send(tileMessage(scene, 0, tile));
    if (!before.length) setTimeout(() => (this.figures(), setTimeout(() => this.trust()))); // after the first picture
  }

  /** @param {ArrayBuffer} message */
  send(message) {
    this.sequence++;
    this.post(numbered(message, this.sequence), [message]);
  }

  // Return the figures of the turns. When they are first asked for, the turns are measured and zones found, and the page gets to
  // know zones and curves.
  figures() {
    if (this.measured) return this.measured;
    const { scene: { state } } = this;
    const { figures, zones, shape } = this.measure();
    this.measured = figures;
    Object.assign(state, { zones: zones ?? [], shape, curves: figures.curves.map(({ name, unit, low, high }) => [name, unit, low, high, false]) });
    this.post(JSON.stringify(state));
    return figures;
  }

  // Return the figures of a section.
  /** @param {number} start @param {number} stop */
  summary(start, stop) {
    return summaryOf(withoutPicked(this.figures(), this.scene.state.zones, this.picks), start, stop);
  }

  // Find how sure each radius is, and send the tiles that the page has again.
  trust() {
    if (this.trusted) return;
    this.trusted = true;
    const { scene } = this;
    const sigma = this.sigma();
    if (!sigma) return;
    setTrust(scene, sigma);
    const last = tilesOf(scene.wall);
    for (const [start, stop] of this.held) for (let tile = start; tile < Math.min(stop, last); tile++) this.send(tileMessage(scene, 0, tile));
    for (let tile = 0; tile < tilesOf(scene.over); tile++) this.send(tileMessage(scene, 1, tile));
  }

  /** @param {{ id: number, method: string, address: string, body: string }} question */
  answer({ id, method, address, body }) {
    const [path, query] = address.replace(/^api\//, '').split('?');
    /** @type {Answer} */
    let found;
    try {
      found = this.found(`${method} ${path}`, new URLSearchParams(query), body);
    } catch (error) {
      found = { status: error instanceof Refusal ? 400 : 500, body: /** @type {Error} */ (error).message };
    }
    const headers = { 'content-type': found.type ?? 'text/plain', ...(found.name ? { 'content-disposition': `attachment; filename=${found.name}` } : {}) };
    this.post({ id, status: found.status ?? 200, headers, body: found.body });
  }

  /** @param {string} question @param {URLSearchParams} query @param {string} body @returns {Answer} */
  found(question, query, body) {
    const ends = () => /** @type {[number, number]} */ ([Number(query.get('start')), Number(query.get('stop'))].sort((a, b) => a - b));
    const named = (/** @type {string} */ what, /** @type {string} */ ending) => `${what}-${ends().map((depth) => depth.toFixed(1)).join('-')}.${ending}`;
    const json = (/** @type {any} */ values) => ({ type: 'application/json', body: JSON.stringify(values) });
    switch (question) {
      case 'GET summary': return json(this.summary(...ends()));
      case 'GET history': return json(this.history());
      case 'GET curve': return { type: 'application/octet-stream', body: curveBytes(this.figures(), query.get('name') ?? '') };
      case 'GET section.csv': return { type: 'text/csv', name: named('section', 'csv'), body: sectionCsv(this.scene, ...ends()) };
      case 'GET section.las': return { type: 'text/plain', name: named('section', 'las'), body: logsText(this.figures(), ...ends()) };
      case 'GET section.glb': return { type: 'model/gltf-binary', name: named('section', 'glb'), body: this.mesh(...ends()) };
      case 'GET export.html': return { type: 'text/html', name: named('wall', 'html'), body: this.exported(ends(), query.get('address') ?? '') };
      case 'GET picks.csv': return { type: 'text/csv', name: 'picks.csv', body: picksTable(this.picks) };
      case 'POST picks.csv': {
        const { picks, ...counts } = merged(this.picks, parsePicks(body));
        this.change(picks);
        return json(counts);
      }
      case 'PUT pick': {
        const pick = checked({ ...rules.picks.defaults, ...JSON.parse(body) }, '');
        const others = this.picks.filter(({ key }) => key !== pick.key);
        this.change([...others, pick]);
        return { body: '' };
      }
      case 'DELETE pick':
        this.change(this.picks.filter(({ key }) => key !== query.get('key')));
        return { body: '' };
      default: return { status: 404, body: 'this page cannot do this; helibore view does it on the command line' };
    }
  }

  /** @param {any[]} picks */
  change(picks) {
    this.picks = picks;
    this.keep(picks);
    this.post(JSON.stringify({ type: 'picks', picks }));
  }

  // Return the page with a section of the wall as one HTML file that needs nothing else (html_export.py); null: the whole wall.
  /** @param {[number, number] | null} ends @param {string} address */
  exported(ends, address = '') {
    const { scene, parts, picks } = this;
    const figures = () => this.figures();
    this.trust();
    const { hello: { start_depth: startDepth, levels: [{ pitch, sectors, rows }] }, wall: { size } } = scene;
    const places = (ends ?? [startDepth, startDepth + ((size - 1) * pitch) / sectors]).map((depth) => ((depth - startDepth) / pitch) * sectors).sort((a, b) => a - b);
    const [first, last] = [Math.max(0, Math.floor(places[0])), Math.min(size - 1, Math.ceil(places[1]))];
    if (first > last) throw new Refusal('the wall does not reach there');
    if (last - first > MOST_ENCLOSED) throw new Refusal(`${last - first} vertices: a file holds at most ${MOST_ENCLOSED}; take a shorter section`);
    const [from, to] = [first, last].map((vertex) => Math.floor(vertex / (sectors * rows)));
    const messages = [...framesMessages(scene)];
    for (let tile = from; tile <= to; tile++) messages.push(tileMessage(scene, 0, tile));
    for (let tile = 0; tile < tilesOf(scene.over); tile++) messages.push(tileMessage(scene, 1, tile));
    const shown = new URLSearchParams(address.replace(/^#/, '')).get('curves')?.split('~') ?? [];
    const curves = Object.fromEntries(figures().curves.filter(({ name }) => shown.includes(name)).map(({ name }) => [name, base64(curveBytes(figures(), name))]));
    const [start, stop] = ends ?? [-Infinity, Infinity];
    const enclosed = JSON.stringify({ hello: scene.hello, state: scene.state, curves, picks, made: Math.round(Date.now() / 100) / 10, address, hosted: false, history: this.history(), summary: this.summary(start, stop) });
    const chunks = [`${parts.before}<script type="application/json" id="enclosed">${enclosed.replaceAll('<', '\\u003c').slice(0, -1)},"messages":[`];
    messages.forEach((message, at) => chunks.push(`${at ? ',' : ''}"`, base64(numbered(message, at + 1)), '"'));
    return new Blob([...chunks, `]}</script>\n<script type="module">\n${parts.app}</script>${parts.after}`], { type: 'text/html' });
  }
}

/** @param {ArrayBuffer} bytes */
function base64(bytes) {
  const all = new Uint8Array(bytes);
  let text = '';
  for (let at = 0; at < all.length; at += BYTES_A_CHUNK) text += btoa(String.fromCharCode(...all.subarray(at, at + BYTES_A_CHUNK)));
  return text;
}

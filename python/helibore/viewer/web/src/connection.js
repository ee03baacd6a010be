// The websocket: handshake, acknowledgements, subscription; it connects again after a break (0.5 s, doubling to 8 s).
// Messages are applied when they arrive, not when a frame is drawn, so a hidden tab stays up to date.
// A message that breaks the protocol ends the connection; the next connection starts with the handshake.

import { messageOf } from './errors.js';
import { decode, encodeAck, encodeSubscribe, FRAMES, toRanges } from './protocol.js';

const SLOWEST = 8000;
export const LOST = 'Connection lost, trying again';
export const STOPPED = 'The server was stopped, trying again';

// What the server's closing codes mean to the user.
/** @type {Record<number, string>} */
const REFUSALS = { 4403: 'The server refused this page', 4429: 'Too many pages are open', 4400: 'The page broke the protocol' };
const FAULT = 4401; // the code with which the page closes a connection

// Return the address of the websocket of the well at `place`, an address relative to that of the page.
/** @param {string} place */
export const socketAddress = (place) => new URL(`${place}ws${location.search}`, location.href.replace(/^http/, 'ws')).href;

export class Connection {
  socket = /** @type {Socket} */ (/** @type {unknown} */ (null));

  // `host` stands for the server in a notebook (host.js).
  /** @param {string} address @param {Handlers} on @param {Host | null} host */
  constructor(address, on, host = null) {
    this.address = address;
    this.host = host;
    this.on = on; // {handshake, state, picks, write, frames, status}
    this.wait = 500;
    this.stats = { bytes: 0, messages: 0, sent: 0, reconnects: -1 };
    /** @type {string | null} */
    this.session = null;
    this.subscribed = '';
    this.open();
  }

  open() {
    this.stats.reconnects++;
    this.socket = this.host?.connect() ?? /** @type {Socket} */ (/** @type {unknown} */ (new WebSocket(this.address)));
    this.socket.binaryType = 'arraybuffer';
    this.fault = '';
    this.socket.onmessage = ({ data }) => this.tryReceive(data);
    this.socket.onclose = (event) => this.closed(event);
  }

  /** @param {{ code: number, reason: string }} event */
  closed(event) {
    const refusal = REFUSALS[event.code];
    const words = event.code === 1012 ? STOPPED : refusal ? `${refusal}${event.reason ? `: ${event.reason}` : ''}` : LOST;
    this.on.status('lost', this.fault || words);
    this.session = null;
    this.subscribed = '';
    setTimeout(() => this.open(), this.wait);
    this.wait = Math.min(SLOWEST, this.wait * 2);
  }

  /** @param {string | ArrayBuffer} data */
  tryReceive(data) {
    if (this.fault) return;
    try {
      this.receive(data);
    } catch (error) {
      this.fault = `The server sent what this page cannot read, trying again: ${messageOf(error)}`;
      this.socket.close(FAULT);
    }
  }

  /** @param {string | ArrayBuffer} data */
  receive(data) {
    this.stats.messages++;
    if (typeof data === 'string') {
      this.stats.bytes += data.length;
      const message = JSON.parse(data);
      if (message.type === 'handshake') {
        this.session = message.session;
        this.subscribed = '';
        this.on.status('live', '');
        this.on.handshake(message);
      } else if (message.type === 'state') this.on.state(message);
      else if (message.type === 'picks') this.on.picks(message.picks);
      return;
    }
    this.stats.bytes += data.byteLength;
    const message = decode(data);
    this.wait = 500;
    if (message.type === FRAMES) this.on.frames(message);
    else this.on.write(message);
    this.send(encodeAck(this.session, message.sequence));
  }

  // Ask for these tiles and no others; the request is sent only if it differs from the last request.
  /** @param {number[]} tiles @param {number} focus @param {number} mask */
  subscribe(tiles, focus, mask) {
    const text = encodeSubscribe(this.session, toRanges(tiles), focus, mask);
    if (text === this.subscribed || this.session === null) return;
    this.subscribed = text;
    this.send(text);
  }

  /** @param {string} text */
  send(text) {
    if (this.socket.readyState !== 1) return;
    this.stats.sent += text.length;
    this.socket.send(text);
  }
}

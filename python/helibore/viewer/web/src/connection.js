// The websocket: greets, acknowledges, subscribes, and comes back by itself after a break (0.5 s, doubling to 8 s).
// Messages are applied as they arrive, not when a frame is drawn: a hidden tab stays up to date and sends its acks.
// One that breaks the protocol ends the connection with a sentence; the next one starts from the greeting.

import { decode, encodeAck, encodeSubscribe, FRAMES, toRanges } from './protocol.js';

const SLOWEST = 8000;
export const LOST = 'Connection lost, trying again';
export const STOPPED = 'The server was stopped, trying again';

// What the server's closing codes mean to the user.
const REFUSALS = { 4403: 'The server refused this page', 4429: 'Too many pages are open', 4400: 'The page broke the protocol' };
const FAULT = 4401; // our own closing code

export class Connection {
  constructor(address, on) {
    this.address = address;
    this.on = on; // {hello, state, write, frames, status}
    this.wait = 500;
    this.stats = { bytes: 0, messages: 0, sent: 0, reconnects: -1 };
    this.session = null;
    this.asked = '';
    this.open();
  }

  open() {
    this.stats.reconnects++;
    this.socket = new WebSocket(this.address);
    this.socket.binaryType = 'arraybuffer';
    this.fault = '';
    this.socket.onmessage = ({ data: said }) => this.tryHear(said);
    this.socket.onclose = (event) => this.closed(event);
  }

  closed(event) {
    const refusal = REFUSALS[event.code];
    const words = event.code === 1012 ? STOPPED : refusal ? `${refusal}${event.reason ? `: ${event.reason}` : ''}` : LOST;
    this.on.status('lost', this.fault || words);
    this.session = null;
    this.asked = '';
    setTimeout(() => this.open(), this.wait);
    this.wait = Math.min(SLOWEST, this.wait * 2);
  }

  tryHear(said) {
    if (this.fault) return;
    try {
      this.hear(said);
    } catch (error) {
      this.fault = `The server sent what this page cannot read, trying again: ${error.message}`;
      this.socket.close(FAULT);
    }
  }

  hear(said) {
    this.stats.messages++;
    if (typeof said === 'string') {
      this.stats.bytes += said.length;
      const message = JSON.parse(said);
      if (message.type === 'hello') {
        this.session = message.session;
        this.asked = '';
        this.on.status('live', '');
        this.on.hello(message);
      } else if (message.type === 'state') this.on.state(message);
      return;
    }
    this.stats.bytes += said.byteLength;
    const message = decode(said);
    this.wait = 500;
    if (message.type === FRAMES) this.on.frames(message);
    else this.on.write(message);
    this.send(encodeAck(this.session, message.sequence));
  }

  // Ask for these tiles and no others; said again only when it differs.
  subscribe(tiles, focus, mask) {
    const text = encodeSubscribe(this.session, toRanges(tiles), focus, mask);
    if (text === this.asked || this.session === null) return;
    this.asked = text;
    this.send(text);
  }

  send(text) {
    if (this.socket.readyState !== WebSocket.OPEN) return;
    this.stats.sent += text.length;
    this.socket.send(text);
  }
}

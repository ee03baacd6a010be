// In a notebook the page is a frame without a server. The notebook gives the page a port, which takes the place of websocket and
// `fetch`: the kernel's messages and answers come through it, and the page sends back what the user looks at (notebook.js).

export class Host {
  /** @type {Socket | null} */
  socket = null;
  /** @type {Map<number, (answer: Response) => void>} */
  asked = new Map(); // requests without an answer
  questions = 0;
  looked = '';
  /** @type {((top: number, bottom: number) => void) | null} */
  show = null;

  /** @param {MessagePort} port */
  constructor(port) {
    this.port = port;
    port.onmessage = ({ data }) => this.take(data);
  }

  // Return a socket for `Connection`.
  connect() {
    /** @type {Socket} */
    const socket = { readyState: 1, binaryType: 'arraybuffer', onmessage() {}, onclose() {}, send: (text) => this.port.postMessage({ text }), close: (code) => this.close(code, '') };
    this.socket = socket;
    this.port.postMessage({ open: true });
    return socket;
  }

  /** @param {number} code @param {string} reason */
  close(code, reason) {
    const { socket } = this;
    if (!socket || socket.readyState === 3) return;
    socket.readyState = 3;
    socket.onclose({ code, reason });
  }

  /** @param {any} data */
  take(data) {
    if (typeof data === 'string' || data instanceof ArrayBuffer) this.socket?.onmessage({ data });
    else if ('id' in data) this.answer(data);
    else if ('close' in data) this.close(data.close, data.reason);
    else if (data.depths) this.show?.(data.depths[0], data.depths[1]);
  }

  // Take the place of `fetch`: the kernel answers.
  /** @type {(address: RequestInfo | URL, request?: RequestInit) => Promise<Response>} */
  fetch(address, { method = 'GET', body = '' } = {}) {
    const id = ++this.questions;
    this.port.postMessage({ id, method, address: /api\/.*/.exec(String(address))?.[0], body });
    return new Promise((answer) => this.asked.set(id, answer));
  }

  /** @param {{ id: number, status: number, headers: Record<string, string>, body: BodyInit }} of */
  answer({ id, status, headers, body }) {
    this.asked.get(id)?.(new Response(body, { status, headers }));
    this.asked.delete(id);
  }

  // Send the kernel what the reader looks at, if it has changed.
  /** @param {{ depths: number[], cursor: (number | null)[] | null }} traits */
  look(traits) {
    const text = JSON.stringify(traits);
    if (text !== this.looked) this.port.postMessage({ traits });
    this.looked = text;
  }
}

// Call `begin(host)` when the notebook offers a port.
/** @param {(host: Host) => void} begin */
export function whenHosted(begin) {
  window.addEventListener('message', ({ source, data, ports }) => {
    if (source !== window.parent || data !== 'helibore' || !ports[0]) return;
    const host = new Host(ports[0]);
    window.fetch = (address, options) => host.fetch(address, options);
    begin(host);
  });
  window.parent.postMessage('helibore', '*');
}

// In an exported file there is no server: the messages that the file holds are played once. A hosted page may hold none: it
// waits for its host (host.js).

import { decode, FRAMES } from './protocol.js';

// The contents of an exported file; null on a page that a server sent.
/** @type {() => Contents | null} */
export const exportedContents = () => JSON.parse(document.getElementById('enclosed')?.textContent ?? 'null');

export class Exported {
  /** @param {Contents} contents @param {Handlers} on */
  constructor(contents, on) {
    this.stats = { bytes: 0, messages: 0, sent: 0, reconnects: 0 };
    setTimeout(() => this.play(contents, on));
  }

  /** @param {Contents} contents @param {Handlers} on */
  play({ hello, state, picks, messages }, on) {
    if (!hello) return;
    on.status('live', '');
    on.handshake(hello);
    on.state(state);
    on.picks(picks);
    for (const text of messages) {
      const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
      const message = decode(bytes.buffer);
      this.stats.messages++;
      this.stats.bytes += bytes.length;
      if (message.type === FRAMES) on.frames(message);
      else on.write(message);
    }
  }

  subscribe() {}
}

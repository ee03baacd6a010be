// A connection to nowhere: the messages that a snapshot file carries, played once. Nothing is sent, nothing is asked for.

import { decode, FRAMES } from './protocol.js';

// The page's own contents when it is a snapshot, else null.
export const enclosed = () => JSON.parse(document.getElementById('enclosed')?.textContent ?? 'null');

export class Enclosed {
  constructor(contents, on) {
    this.stats = { bytes: 0, messages: 0, sent: 0, reconnects: 0 };
    setTimeout(() => this.play(contents, on));
  }

  play({ hello, state, messages }, on) {
    on.status('live', '');
    on.hello(hello);
    on.state(state);
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

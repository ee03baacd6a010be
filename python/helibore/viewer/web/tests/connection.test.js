// The connection over a socket that the test plays: greeting, acknowledgement, a message that breaks the protocol.

import assert from 'node:assert/strict';
import test, { mock } from 'node:test';
import { Connection } from '../src/connection.js';
import { HEAD, WRITE } from '../src/protocol.js';

class Socket {
  static OPEN = 1;
  static made = [];
  constructor(address) {
    Object.assign(this, { address, readyState: Socket.OPEN, sent: [] });
    Socket.made.push(this);
  }
  send(text) {
    this.sent.push(JSON.parse(text));
  }
  close(code) {
    this.readyState = 3;
    this.onclose({ code, reason: '' });
  }
  say(what) {
    this.onmessage({ data: what instanceof ArrayBuffer ? what : JSON.stringify(what) });
  }
}

function connected() {
  Socket.made = [];
  globalThis.WebSocket = Socket;
  const received = { handshake: [], write: [], status: [] };
  const on = { handshake: (m) => received.handshake.push(m), state() {}, frames() {}, write: (m) => received.write.push(m), status: (...s) => received.status.push(s) };
  const connection = new Connection('ws://rig/ws', on);
  return { connection, received, socket: Socket.made[0] };
}

function written(count, sequence, cut = 0) {
  const buffer = new ArrayBuffer(HEAD + 8 * count - cut);
  const head = new DataView(buffer);
  head.setUint8(0, WRITE);
  head.setUint32(12, count, true);
  head.setUint32(20, sequence, true);
  return buffer;
}

test('a write is applied and acknowledged', () => {
  const { received, socket } = connected();
  socket.say({ type: 'handshake', session: 's' });
  socket.say(written(3, 7));
  assert.equal(received.write[0].count, 3);
  assert.deepEqual(socket.sent, [{ session: 's', ack: 7 }]);
  assert.deepEqual(received.status, [['live', '']]);
});

test('a message that is not what its head says is reported, and the page connects again, later each time', () => {
  mock.timers.enable({ apis: ['setTimeout'] });
  try {
    const { received, socket } = connected();
    socket.say({ type: 'handshake', session: 's' });
    socket.say(written(3, 1, 2));
    socket.say(written(3, 2));
    assert.deepEqual(received.status.at(-1), [
      'lost',
      'The server sent what this page cannot read, trying again: message of 54 bytes: its head says 56',
    ]);
    assert.equal(received.write.length, 0, 'nothing after it is applied');
    mock.timers.tick(499);
    assert.equal(Socket.made.length, 1);
    mock.timers.tick(1);
    Socket.made[1].say({ type: 'handshake', session: 's' });
    Socket.made[1].say(written(3, 1, 2));
    mock.timers.tick(999);
    assert.equal(Socket.made.length, 2, 'a greeting alone does not make it hasty again');
    mock.timers.tick(1);
    assert.equal(Socket.made.length, 3);
    Socket.made[2].say({ type: 'handshake', session: 's' });
    Socket.made[2].say(written(3, 1));
    assert.deepEqual(received.status.at(-1), ['live', '']);
    assert.equal(received.write.length, 1);
  } finally {
    mock.timers.reset();
  }
});

test('a lost connection says so; a refusal says why', () => {
  mock.timers.enable({ apis: ['setTimeout'] });
  try {
    const { received, socket } = connected();
    socket.onclose({ code: 1006, reason: '' });
    assert.deepEqual(received.status.at(-1), ['lost', 'Connection lost, trying again']);
    socket.onclose({ code: 1012, reason: '' });
    assert.deepEqual(received.status.at(-1), ['lost', 'The server was stopped, trying again']);
    socket.onclose({ code: 4403, reason: 'token: missing or wrong.' });
    assert.deepEqual(received.status.at(-1), ['lost', 'The server refused this page: token: missing or wrong.']);
  } finally {
    mock.timers.reset();
  }
});

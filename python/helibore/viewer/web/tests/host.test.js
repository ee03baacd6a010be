// A page in a notebook: the port stands for the websocket, answers find their questions, traits are sent once.

import assert from 'node:assert/strict';
import test from 'node:test';
import { Connection } from '../src/connection.js';
import { Host } from '../src/host.js';

function hosted() {
  const sent = [];
  const port = { postMessage: (message) => sent.push(message) };
  return { sent, port, host: new Host(port), say: (data) => port.onmessage({ data }) };
}

test('a connection speaks through the port, and is lost when the kernel ends it', () => {
  const { sent, host, say } = hosted();
  const statuses = [];
  const connection = new Connection('', { handshake() {}, state() {}, status: (...s) => statuses.push(s) }, host);
  say(JSON.stringify({ type: 'handshake', session: 's' }));
  connection.subscribe([0, 1], 0, 0);
  assert.deepEqual(sent[0], { open: true });
  assert.equal(JSON.parse(sent[1].text).session, 's');
  say({ close: 4400, reason: 'not JSON' });
  assert.deepEqual(statuses, [['live', ''], ['lost', 'The page broke the protocol: not JSON']]);
});

test('answers find their questions', async () => {
  const { sent, host, say } = hosted();
  const [first, second] = [host.fetch('http://lab/tree/api/summary?start=1'), host.fetch('api/pick', { method: 'PUT', body: '{}' })];
  assert.deepEqual(sent.map(({ id, ...rest }) => rest), [{ method: 'GET', address: 'api/summary?start=1', body: '' }, { method: 'PUT', address: 'api/pick', body: '{}' }]);
  say({ id: sent[1].id, status: 400, headers: {}, body: new TextEncoder().encode('no').buffer });
  say({ id: sent[0].id, status: 200, headers: { 'content-type': 'application/json' }, body: new TextEncoder().encode('[1]').buffer });
  assert.deepEqual(await (await first).json(), [1]);
  assert.deepEqual([(await second).ok, await (await second).text()], [false, 'no']);
});

test('what the reader looks at is sent when it differs', () => {
  const { sent, host, say } = hosted();
  host.look({ depths: [1, 2] });
  host.look({ depths: [1, 2] });
  host.look({ depths: [1, 3] });
  assert.deepEqual(sent, [{ traits: { depths: [1, 2] } }, { traits: { depths: [1, 3] } }]);
  const shown = [];
  host.show = (...depths) => shown.push(depths);
  say({ depths: [5, 6] });
  assert.deepEqual(shown, [[5, 6]]);
});

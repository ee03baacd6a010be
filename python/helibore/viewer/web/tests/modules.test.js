import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { test } from 'node:test';

const here = new URL('../src/', import.meta.url);
const imports = new Map(readdirSync(here).filter((name) => name.endsWith('.js')).map((name) => (
  [name, [...readFileSync(new URL(name, here), 'utf8').matchAll(/^import .*'\.\/(.*)'/gm)].map(([, other]) => other)]
)));

test('no module imports itself by way of others', () => {
  assert.ok(imports.get('main.js').includes('renderer.js'));
  const done = new Set();
  const visit = (name, way) => {
    assert.ok(!way.includes(name), [...way.slice(way.indexOf(name)), name].join(' -> '));
    if (done.has(name)) return;
    for (const other of imports.get(name)) visit(other, [...way, name]);
    done.add(name);
  };
  for (const name of imports.keys()) visit(name, []);
});

// Bundles the page that needs no server:  node build_offline.mjs PAGE_DIR WASM RULES.json NODE_MODULES OUT.html EXAMPLE ...
// PAGE_DIR is what build.mjs wrote. Everything is in the one file; scripts run by their hashes alone, and nothing is requested.
import { createHash } from 'node:crypto';
import { createRequire } from 'node:module';
import { readFileSync, writeFileSync } from 'node:fs';
import { basename, dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { gzipSync } from 'node:zlib';

const here = join(dirname(fileURLToPath(import.meta.url)), 'offline');
const [page, wasm, rules, modules, out, ...examples] = process.argv.slice(2).map((path) => resolve(path));
const esbuild = await import(pathToFileURL(createRequire(join(modules, 'x.js')).resolve('esbuild')));
const read = (/** @type {string} */ path) => readFileSync(path, 'utf8');
const bundled = (/** @type {string} */ name, /** @type {string} */ format) => esbuild.buildSync({
  entryPoints: [join(here, name)], bundle: true, format, minify: true, write: false, target: 'es2022', legalComments: 'none', charset: 'utf8', nodePaths: [modules],
}).outputFiles[0].text;
const enclosable = (/** @type {string} */ code) => code.replaceAll('</script', '<\\/script').replaceAll('<!--', '<\\!--');
const hash = (/** @type {string} */ code) => `'sha256-${createHash('sha256').update(code).digest('base64')}'`;
// The memory level sets how often the codes follow the contents: 8 makes the smallest file of the core, 6 of the texts.
const packed = (/** @type {Buffer | string} */ bytes, /** @type {number} */ memLevel) => gzipSync(bytes, { level: 9, memLevel }).toString('base64');

// The shipped page, as html_export.py encloses it; rig mode is hidden.
const app = enclosable(`${read(join(page, 'offline_more.js'))}${read(join(page, 'app.js'))}`);
const script = enclosable(bundled('start.js', 'esm').trim());
const policy = (/** @type {string[]} */ ...scripts) => `default-src 'none'; style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'; script-src ${scripts.join(' ')}`;
const [before, after] = read(join(page, 'index.html'))
  .replace('<meta charset="utf-8">', `<meta charset="utf-8">\n<meta http-equiv="Content-Security-Policy" content="${policy(hash(`\n${app}`))}">`)
  .replace('id="rigOpen"', 'id="rigOpen" hidden')
  .replace('<link rel="stylesheet" href="app.css">', () => `<style>\n${read(join(page, 'app.css'))}</style>`)
  .split('<script type="module" src="app.js"></script>');
const tables = JSON.stringify({ rules: JSON.parse(read(rules)), examples: Object.fromEntries(examples.map((path) => [basename(path), read(path)])) });
const parts = [tables, before, app, after, bundled('worker.js', 'iife')].join('\0'); // scripts as they are: smaller than in JSON
const whole = { // `SCRIPT` last, so that no other text is looked for in it
  POLICY: `${policy(hash(script), hash(`\n${app}`), "'wasm-unsafe-eval'")}; worker-src blob:; frame-src blob:`, STYLE: esbuild.transformSync(read(join(here, 'start.css')), { loader: 'css', minify: true }).code,
  CORE: packed(readFileSync(wasm), 8), PARTS: packed(parts, 6), SCRIPT: script,
};
const html = Object.entries(whole).reduce((text, [name, value]) => text.replace(name, () => value), read(join(here, 'start.html')));
writeFileSync(out, html);
console.log(`${out}: ${html.length} bytes, ${gzipSync(html, { level: 9 }).length} gzipped`);

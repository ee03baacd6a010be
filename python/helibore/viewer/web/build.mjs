// Bundles the page:  node build.mjs OUT_DIR [NODE_MODULES]
// Writes index.html, app.css, app.js and licences.txt (the licence of every package in the bundle, and of nothing else).
// The output depends on the sources and the lock file alone.
import { createRequire } from 'node:module';
import { copyFileSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const out = resolve(process.argv[2] ?? join(here, '..', 'page'));
const modules = resolve(process.argv[3] ?? join(here, 'node_modules'));
const esbuild = await import(pathToFileURL(createRequire(join(modules, 'x.js')).resolve('esbuild')));

mkdirSync(out, { recursive: true });
const result = await esbuild.build({
  entryPoints: [join(here, 'src', 'main.js')],
  absWorkingDir: here,
  bundle: true,
  format: 'esm',
  minify: true,
  target: 'es2022',
  legalComments: 'none',
  charset: 'utf8',
  nodePaths: [modules],
  metafile: true,
  outfile: join(out, 'app.js'),
});
for (const name of ['index.html', 'app.css']) copyFileSync(join(here, name), join(out, name));

const packages = new Set();
for (const input of Object.keys(result.metafile.inputs)) {
  const match = /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(input.replaceAll('\\', '/'));
  if (match) packages.add(match[1]);
}
const licences = [...packages].sort().map((name) => {
  const folder = join(modules, name);
  const { version } = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'));
  const file = readdirSync(folder).find((entry) => /^licen[cs]e/i.test(entry));
  if (!file) throw new Error(`${name} ${version} has no licence file`);
  return `${name} ${version}\n\n${readFileSync(join(folder, file), 'utf8').trim()}\n`;
});
writeFileSync(join(out, 'licences.txt'), `This page contains:\n\n${licences.join('\n----\n\n')}`);

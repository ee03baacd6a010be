// Bundles the page:  node build.mjs OUT_DIR [NODE_MODULES]
// Writes index.html, app.css, app.js, more.js (which app.js loads late; offline_more.js for build_offline.mjs), notebook.js, wells.html and wells.js, which hold this project's own sources and nothing else.
// The output depends on the sources and the lock file alone.
import { createRequire } from 'node:module';
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const out = resolve(process.argv[2] ?? join(here, '..', 'page'));
const modules = resolve(process.argv[3] ?? join(here, 'node_modules'));
const esbuild = await import(pathToFileURL(createRequire(join(modules, 'x.js')).resolve('esbuild')));

mkdirSync(out, { recursive: true });
const unindented = (file) => readFileSync(file, 'utf8').replace(/\n\s+/g, '\n');
// The texts of shaders are strings, which esbuild keeps as they are: leave out comments, blanks and the zeros of 1.0 and 0.5.
const shortened = (text) => text.replace(/ *\/\/.*/g, '').replace(/ *([*/=<>(){},;?:&|!]) */g, '$1').replace(/ ([-+]) (?![-+])/g, '$1').replace(/([;{},])\n+/g, '$1').replace(/\b(\d+\.)0\b/g, '$1').replace(/\b0(\.\d)/g, '$1');
const shaders = {
  name: 'shaders',
  setup: (build) => build.onLoad({ filter: /shaders\.js$/ }, ({ path }) => ({ contents: shortened(unindented(path)) })),
};
// The page without a server has no rig mode, no planned path and no print.
const withoutRig = {
  name: 'without rig mode, planned path and print',
  setup: (build) => build.onLoad({ filter: /(rig(_digits\.js|_places\.js|\.css)|planned\.js|pane_picture\.js)$/ }, () => ({ contents: 'export const drawPlan = 0, paneOf = 0, planInWords = 0, hungInRig = 0, placesOf = 0, rigSection = 0, tightNow = 0, writeDigits = 0, zonesInRig = 0; export default 0;', loader: 'js' })),
};
// What a module imports of these is a text.
const texts = {
  name: 'texts',
  setup: (build) => {
    build.onLoad({ filter: /\.html$/ }, ({ path }) => ({ contents: unindented(path), loader: 'text' }));
    build.onLoad({ filter: /\.css$/ }, ({ path }) => ({ contents: esbuild.transformSync(readFileSync(path, 'utf8'), { loader: 'css', minify: true }).code, loader: 'text' }));
  },
};
/** @param {string} source @param {object} kind */
const bundled = (source, kind) => esbuild.build({
  entryPoints: [join(here, 'src', source)],
  absWorkingDir: here,
  bundle: true,
  minify: true,
  target: 'es2022',
  legalComments: 'none',
  charset: 'utf8',
  nodePaths: [modules],
  plugins: [shaders, texts],
  ...kind,
});
await bundled('main.js', { format: 'esm', outfile: join(out, 'app.js') });
// Alone it defines what late.js looks for, so it may also stand before app.js in one file.
const late = { format: 'iife', globalName: 'more', footer: { js: 'globalThis.more=more;' } };
await bundled('more.js', { ...late, outfile: join(out, 'more.js') });
await bundled('more.js', { ...late, plugins: [withoutRig, shaders, texts], outfile: join(out, 'offline_more.js') });
await bundled('wells.js', { format: 'esm', outfile: join(out, 'wells.js') });
await esbuild.build({ entryPoints: [join(here, 'app.css')], minify: true, target: 'es2022', charset: 'utf8', outfile: join(out, 'app.css') });
for (const name of ['index.html', 'wells.html']) writeFileSync(join(out, name), unindented(join(here, name)));
copyFileSync(join(here, 'notebook.js'), join(out, 'notebook.js'));

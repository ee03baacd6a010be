// Bundles the page:  node build.mjs OUT_DIR [NODE_MODULES]
// Writes index.html, app.css, app.js and notebook.js, which hold this project's own sources and nothing else.
// The output depends on the sources and the lock file alone.
import { createRequire } from 'node:module';
import { copyFileSync, mkdirSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const out = resolve(process.argv[2] ?? join(here, '..', 'page'));
const modules = resolve(process.argv[3] ?? join(here, 'node_modules'));
const esbuild = await import(pathToFileURL(createRequire(join(modules, 'x.js')).resolve('esbuild')));

mkdirSync(out, { recursive: true });
await esbuild.build({
  entryPoints: [join(here, 'src', 'main.js')],
  absWorkingDir: here,
  bundle: true,
  format: 'esm',
  minify: true,
  target: 'es2022',
  legalComments: 'none',
  charset: 'utf8',
  nodePaths: [modules],
  outfile: join(out, 'app.js'),
});
for (const name of ['index.html', 'app.css', 'notebook.js']) copyFileSync(join(here, name), join(out, name));

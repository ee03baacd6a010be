// The page without a server: a file, its columns and their roles, then the wall in the shipped page, in a frame.
//
//   file -> worker: columns, roles -> the user: roles, units, bit size -> worker: wall <-port-> page in a frame

/** @typedef {import('./roles.js').Role} Role */

/** @type {<Kind extends HTMLElement = HTMLElement>(id: string) => Kind} */
const byId = (id) => /** @type {any} */ (document.getElementById(id));
const CHOICES = ['none', 'depth', 'toolface', 'radius', 'diameter', 'time', 'inclination', 'azimuth', 'bit-diameter'];
const WALLS = ['radius', 'diameter'];
const REFERENCES = { '': 'from: not stated', 'high-side': 'from high side', north: 'from north', 'horizontal-north': 'from north, in the horizontal plane' };

const [PICKS, SETTINGS] = ['helibore picks ', 'helibore settings']; // names in the browser's storage
const MOST_RECENT = 20;

/** @type {{ rules: import('./rules.js').Rules, page: import('./served.js').PageParts, worker: string, examples: Record<string, string> }} */
let parts;
/** @type {Worker} */
let worker;
/** @type {Map<number, { resolve: (found: any) => void, reject: (error: Error) => void }>} */
const waiting = new Map();
/** @type {{ name: string, roles: Role[], well: string, mark: string }} */
let log;
/** @type {ReturnType<typeof frameOf> | null} */
let next = null; // the frame of the wall that is shown next
let asked = 0;

/** @param {string} id */
async function unpacked(id) {
  const bytes = Uint8Array.from(atob(byId(id).textContent ?? ''), (letter) => letter.charCodeAt(0));
  byId(id).remove();
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
}

// Ask the worker; a failure of the worker itself is an answer, too.
/** @param {Record<string, any>} question @param {Transferable[]} [transfer] @returns {Promise<any>} */
function ask(question, transfer = []) {
  const id = ++asked;
  worker.postMessage({ id, ...question }, transfer);
  return new Promise((resolve, reject) => waiting.set(id, { resolve, reject }));
}

/** @param {string} text */
function say(text) {
  byId('trouble').textContent = text;
  byId('trouble').hidden = !text;
  if (text) byId('trouble').scrollIntoView({ block: 'nearest' });
}

function clear() {
  say('');
  byId('columns').hidden = true;
}

/** @param {string} name @param {ArrayBuffer} bytes */
async function take(name, bytes) {
  const size = bytes.byteLength;
  try {
    const { format, rows, remarks, roles, missing, bit, well } = await ask({ ask: 'read', name, bytes }, [bytes]);
    log = { name, roles, well, mark: `${name} ${size}` };
    const last = roles.length && (stored(SETTINGS) ?? []).find((/** @type {any} */ one) => one.columns === columnsOf(roles));
    for (const role of last ? last.roles : []) Object.assign(roles.find((/** @type {Role} */ { channel }) => channel === role.channel), role);
    byId('fileName').textContent = name;
    byId('what').textContent = roles.length ? `${format}, ${rows.toLocaleString('en')} rows, ${roles.length} columns` : format;
    byId('table').hidden = !roles.length;
    for (const id of ['bit', 'bitUnit']) /** @type {HTMLInputElement} */ (byId(id)).disabled = !roles.length;
    byId('surveyOf').hidden = byId('surveyWhat').hidden = !roles.length;
    byId('surveyWhat').textContent = NO_SURVEY;
    /** @type {HTMLInputElement} */ (byId('survey')).value = '';
    byId('remarks').replaceChildren(...remarks.map((/** @type {string} */ text) => Object.assign(document.createElement('li'), { textContent: text })));
    byId('roles').replaceChildren(...roles.map((/** @type {Role} */ role) => rowOf(role, missing[role.channel], rows)));
    showBit(bit);
    if (last) {
      /** @type {HTMLInputElement} */ (byId('bit')).value = last.bit;
      /** @type {HTMLSelectElement} */ (byId('bitUnit')).value = last.unit;
      byId('bitWhy').textContent = 'as in the last file with these columns: check it';
    }
    byId('columns').hidden = false;
    next ??= frameOf(); // the page begins while the user reads
    if (!roles.length) return void (await show()); // an archive says all itself
    byId(bit || last ? 'show' : 'bit').focus();
  } catch (error) {
    say(`${name}: ${/** @type {Error} */ (error).message}.`);
  }
}

/** @param {{ size: number, why: string } | null} bit */
function showBit(bit) {
  const unit = byId('bitUnit');
  /** @type {HTMLSelectElement} */ (unit).value = 'in';
  /** @type {HTMLInputElement} */ (byId('bit')).value = bit ? String(Number((bit.size / parts.rules.units.in[1]).toFixed(3))) : '';
  byId('bitWhy').textContent = bit ? `${bit.why}: check it` : 'of the section that the log covers';
}

const NO_SURVEY = 'if there is one: depth, inclination, azimuth';

/** @param {File | undefined} file */
async function takeSurvey(file) {
  say('');
  byId('surveyWhat').textContent = NO_SURVEY;
  if (!file) return;
  try {
    const bytes = await file.arrayBuffer();
    byId('surveyWhat').textContent = await ask({ ask: 'survey', name: file.name, bytes }, [bytes]);
  } catch (error) {
    say(`${/** @type {Error} */ (error).message}.`);
  }
}

// One row of the table: the column, its role, its unit, and why.
/** @param {Role} role @param {number} missing @param {number} rows */
function rowOf(role, missing, rows) {
  const row = document.createElement('tr');
  const cells = Array.from({ length: 4 }, () => row.appendChild(document.createElement('td')));
  const kind = document.createElement('select');
  kind.ariaLabel = `What ${role.channel} is`;
  const known = role.role === 'none' || CHOICES.includes(role.role) ? CHOICES : [...CHOICES, role.role];
  kind.replaceChildren(...known.map((name) => new Option(name === 'none' ? 'not used' : name, name)));
  kind.value = role.role;
  const unit = document.createElement('select');
  unit.ariaLabel = `Unit of ${role.channel}`;
  const from = document.createElement('select');
  from.ariaLabel = `What ${role.channel} counts from`;
  from.replaceChildren(...Object.entries(REFERENCES).map(([name, text]) => new Option(text, name)));
  const angle = Object.assign(document.createElement('input'), { type: 'text', inputMode: 'decimal', size: 4, title: 'Degrees from the toolface, clockwise seen downhole' });
  const degrees = Object.assign(document.createElement('span'), { textContent: '° from toolface' });
  angle.ariaLabel = `Degrees from the toolface to ${role.channel}`;
  const fill = () => {
    const wanted = parts.rules.roles[role.role];
    const fitting = ['m', 'ft', 'in', 'mm', 'cm', '0.1in', 'deg', 'rad', 's', 'ms', 'min', 'h'].filter((name) => !wanted || parts.rules.units[name]?.[0] === wanted);
    unit.replaceChildren(...[...new Set([role.unit, ...fitting])].map((name) => new Option(name || '(not stated)', name)));
    unit.value = role.unit;
    unit.hidden = role.role === 'none' || !wanted;
    row.className = role.role === 'none' ? 'unused' : '';
    from.value = role.reference;
    from.hidden = role.role !== 'toolface';
    angle.value = role.angle === null ? '' : String(role.angle);
    angle.hidden = !WALLS.includes(role.role) || !log.roles.some((one) => one.role === 'toolface');
    const lost = missing ? `; ${missing.toLocaleString('en')} of ${rows.toLocaleString('en')} values missing` : '';
    cells[3].textContent = (role.stated || role.changed ? 'your choice' : role.reason) + lost;
    degrees.hidden = angle.hidden;
  };
  from.onchange = () => {
    Object.assign(role, { reference: from.value, changed: true });
    fill();
  };
  angle.onchange = () => {
    const stated = Number(angle.value.trim().replace(',', '.'));
    if (angle.value.trim() && Math.abs(stated) <= 360) Object.assign(role, { angle: stated, changed: true });
    fill();
  };
  kind.onchange = () => {
    Object.assign(role, { role: kind.value, stated: true, reference: '' });
    if (WALLS.includes(role.role)) role.angle ??= log.roles.some((one) => one.role === 'toolface') ? 0 : null;
    fill();
    rebit();
  };
  unit.onchange = () => {
    Object.assign(role, { unit: unit.value, stated: true });
    fill();
    rebit();
  };
  cells[0].textContent = role.channel;
  cells[1].append(kind);
  cells[2].append(unit, from, angle, degrees);
  fill();
  return row;
}

// Guess the bit size again from the roles of now, unless the user has typed one.
async function rebit() {
  say('');
  if (byId('bitWhy').textContent) showBit(await ask({ ask: 'bit', roles: log.roles }));
}

async function show() {
  say('');
  const number = Number(/** @type {HTMLInputElement} */ (byId('bit')).value.trim().replace(',', '.'));
  const size = number * parts.rules.units[/** @type {HTMLSelectElement} */ (byId('bitUnit')).value][1];
  if (!(number > 0)) return say('Bit size: must be a number above 0, such as 8.5.');
  /** @type {HTMLButtonElement} */ (byId('show')).disabled = true;
  const frame = (next ??= frameOf());
  next = null;
  try {
    const { ends, left, found, kept, arms, between, zoned } = await ask({ ask: 'wall', roles: log.roles, bit: size, well: log.well, picks: stored(PICKS + log.mark) ?? [] });
    if (log.roles.length) remember(SETTINGS, [{ columns: columnsOf(log.roles), roles: log.roles.filter(({ stated, changed }) => stated || changed), bit: /** @type {HTMLInputElement} */ (byId('bit')).value, unit: /** @type {HTMLSelectElement} */ (byId('bitUnit')).value }, ...(stored(SETTINGS) ?? []).filter((/** @type {any} */ one) => one.columns !== columnsOf(log.roles))].slice(0, MOST_RECENT));
    const { port1, port2 } = new MessageChannel();
    await ask({ ask: 'serve', port: port2 }, [port2]);
    frame.port(port1);
    const lost = Object.entries(left).filter(([, count]) => count).map(([name, count]) => `${Number(count).toLocaleString('en')} without ${name} left out`);
    const share = between > 0.005 ? [`${Math.round(100 * between)} % of the wall is interpolated${arms > 2 ? ' between the arms' : ''}, not measured`] : [];
    byId('made').textContent = [log.name, `${kept.toLocaleString('en')} samples`, ...lost, ...found, ...share, ...(zoned ? [] : ['zones: helibore view FILE'])].join(' · ');
    byId('made').title = `${byId('made').textContent}; ${ends.map((/** @type {number} */ end) => end.toFixed(2)).join(' to ')} m`;
    byId('begin').hidden = true;
    byId('wall').classList.add('shown');
    frame.focus();
  } catch (error) {
    drop();
    say(`${log.name}: ${/** @type {Error} */ (error).message}.`);
  }
  /** @type {HTMLButtonElement} */ (byId('show')).disabled = false;
  return undefined;
}

// Make the page of a wall in a frame; `port` gives it the worker's port as soon as it asks for one (host.js). A frame of a blob
// has an address, in which the page keeps what it shows; a frame of `srcdoc` has none.
function frameOf() {
  drop();
  const { before, app, after } = parts.page;
  const html = `${before}<script type="application/json" id="enclosed">{"hosted":true}</script>\n<script type="module">\n${app}</script>${after}`;
  const frame = Object.assign(document.createElement('iframe'), { title: 'Wall', src: URL.createObjectURL(new Blob([html], { type: 'text/html' })) });
  const ready = new Promise((resolve) => {
    window.addEventListener('message', ({ source, data }) => source === frame.contentWindow && data === 'helibore' && resolve(undefined));
  });
  byId('wall').append(frame);
  return { focus: () => frame.focus(), port: (/** @type {MessagePort} */ port) => ready.then(() => frame.contentWindow?.postMessage('helibore', '*', [port])) };
}

async function save() {
  try {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(await ask({ ask: 'save' }));
    link.download = `${log.name.replace(/\.[^.]*$/, '')}.html`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  } catch (error) {
    byId('made').textContent = `Not saved: ${/** @type {Error} */ (error).message}.`;
  }
}

// What the browser keeps for this page; null where it keeps nothing, as in a private window.
/** @param {string} name */
function stored(name) {
  try {
    return JSON.parse(localStorage.getItem(name) ?? 'null');
  } catch {
    return null;
  }
}

/** @param {string} name @param {any} value */
function remember(name, value) {
  try {
    localStorage.setItem(name, JSON.stringify(value));
  } catch {
    byId('made').title = 'This browser keeps nothing for this page: save it, to keep the picks.';
  }
}

/** @param {Role[]} roles */
const columnsOf = (roles) => roles.map(({ channel }) => channel).join('|');

// Close the frame, and free its bytes.
function drop() {
  const frame = byId('wall').querySelector('iframe');
  if (frame) URL.revokeObjectURL(frame.src);
  frame?.remove();
}

function back() {
  byId('wall').classList.remove('shown');
  drop();
  byId('begin').hidden = false;
  byId('show').focus();
}

/** @param {FileList | null | undefined} files */
async function openFile(files) {
  const file = files?.[0];
  if (!file) return;
  if (files.length > 1) return say('Open one file at a time; helibore joins several on the command line.');
  if (file.size > 512 * 2 ** 20) return say(`${file.name}: ${Math.round(file.size / 2 ** 20)} MB; this page reads files of up to 512 MB, helibore larger ones on the command line.`);
  clear();
  await take(file.name, await file.arrayBuffer()).catch(() => say(`${file.name}: it could not be read from the disk.`));
}

/** @param {string} name @param {string} text */
function takeExample(name, text) {
  clear();
  return take(name, /** @type {ArrayBuffer} */ (new TextEncoder().encode(text).buffer));
}

async function begin() {
  if (typeof WebAssembly === 'undefined' || typeof DecompressionStream === 'undefined' || typeof Worker === 'undefined') {
    byId('drop').hidden = true;
    return say('This browser has no WebAssembly or cannot unpack: use a newer one, such as Chrome 95, Firefox 113 or Safari 16.4.');
  }
  const [tables, before, app, after, script] = new TextDecoder().decode(await unpacked('parts')).split('\0');
  parts = { ...JSON.parse(tables), page: { before, app, after }, worker: script };
  worker = new Worker(URL.createObjectURL(new Blob([parts.worker], { type: 'text/javascript' })));
  worker.onmessage = ({ data: { id, found, refused, picks } }) => {
    if (picks) return remember(PICKS + log.mark, picks);
    const { resolve, reject } = waiting.get(id) ?? {};
    waiting.delete(id);
    if (refused === undefined) resolve?.(found);
    else reject?.(new Error(refused));
    return undefined;
  };
  worker.onerror = ({ message }) => {
    for (const { reject } of waiting.values()) reject(new Error(`the worker of this page failed (${message})`));
    waiting.clear();
  };
  const wasm = await unpacked('core');
  const version = await ask({ ask: 'open', rules: parts.rules, page: parts.page, wasm }, [wasm]);
  byId('version').textContent = `helibore ${version}: inverse distance of the 8 nearest samples. On the command line, helibore view FILE also shows images and live wells, prints, and chooses the estimator (-s wall.estimator=automatic).`;
  byId('examples').replaceChildren(...Object.entries(parts.examples).map(([name, text]) => {
    const button = Object.assign(document.createElement('button'), { type: 'button', textContent: name });
    button.onclick = () => takeExample(name, text);
    return button;
  }));
  const survey = /** @type {HTMLInputElement} */ (byId('survey'));
  survey.onchange = () => takeSurvey(survey.files?.[0]);
  const input = /** @type {HTMLInputElement} */ (byId('file'));
  input.onchange = () => openFile(input.files).then(() => (input.value = ''));
  byId('bit').oninput = () => (byId('bitWhy').textContent = '');
  byId('ask').onsubmit = (event) => {
    event.preventDefault();
    show();
  };
  byId('back').onclick = back;
  byId('save').onclick = save;
  window.addEventListener('dragover', (event) => {
    event.preventDefault();
    byId('drop').classList.add('over');
  });
  window.addEventListener('dragleave', () => byId('drop').classList.remove('over'));
  window.addEventListener('drop', (event) => {
    event.preventDefault();
    byId('drop').classList.remove('over');
    if (byId('begin').hidden) back();
    openFile(event.dataTransfer?.files);
  });
  if (location.hash === '#demo') {
    await takeExample(...Object.entries(parts.examples)[0]);
    await show();
  }
  return undefined;
}

begin().catch((error) => say(`This page did not start: ${error.message}.`));

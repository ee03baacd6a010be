// Elements of the page, and what several modules write into them.

/** @template {string} Id @param {Id} id */
export const byId = (id) => /** @type {ElementOf<Id>} */ (/** @type {unknown} */ (document.getElementById(id)));

/** @param {string} id @param {Choice[]} pairs */
export function options(id, pairs) {
  byId(id).replaceChildren(...pairs.map(([value, text]) => new Option(text, String(value))));
}

// Return a function that calls `draw` with the next frame, once, however often it is called before.
/** @param {() => void} draw */
export function oncePerFrame(draw) {
  let scheduled = false;
  return () => {
    if (scheduled) return;
    scheduled = true;
    requestAnimationFrame(() => {
      scheduled = false;
      draw();
    });
  };
}

// Give an element properties. What it has already is not written: the browser would find its style or lay the page out anew.
/** @param {HTMLElement} at @param {Record<string, unknown>} properties */
export function put(at, properties) {
  const of = /** @type {Record<string, unknown>} */ (/** @type {unknown} */ (at));
  for (const [name, value] of Object.entries(properties)) if (of[name] !== value) of[name] = value;
}

/** @param {boolean} hidden @param {...string} ids */
export const hide = (hidden, ...ids) => ids.forEach((id) => put(byId(id), { hidden }));

/** @param {string} id @param {string} textContent */
export const say = (id, textContent) => put(byId(id), { textContent });

const ATOM = /((?:at |[+−±≤])?\d[\d.]*(?:–\d[\d.]*)?(?: ?(?:[°%]|[a-z]{1,2}³?(?![a-z])))?)/;

// Write a text in which no line ends between a number and its sign, its unit or the other end of its range.
/** @param {Element} at @param {string} text */
export function fill(at, text) {
  if (at.textContent !== text) at.replaceChildren(...text.split(ATOM).map((part, i) => (i % 2 ? Object.assign(document.createElement('nobr'), { textContent: part }) : part)));
}

// Write pairs of name and text to a list; a third text is the tooltip of both.
/** @param {string} id @param {string[][]} pairs */
export function write(id, pairs) {
  const list = byId(id);
  if (list.children.length !== 2 * pairs.length) {
    list.replaceChildren(...pairs.flatMap(() => ['dt', 'dd'].flatMap((name) => [document.createElement(name), ' ']))); // copied text keeps its words apart
  }
  pairs.forEach(([name, text, title = ''], i) => [name, text].forEach((words, j) => {
    const at = /** @type {HTMLElement} */ (list.children[2 * i + j]);
    fill(at, words);
    put(at, { title });
  }));
}

// The colours and patterns of the common rocks, from rocks.json, for tracks of rocks (lithology). A text has the colour of the
// rock that it names first; a text that names none has no colour.

import definition from '../../../base/rocks.json' with { type: 'json' };
import { within } from './layout.js';

const [WIDE, TALL] = definition.size; // pixels of the pattern

/** @typedef {(typeof definition.rocks)[number]} Rock */
/** @type {Map<string, Rock | undefined>} */
const named = new Map(definition.rocks.flatMap((rock) => rock.words.map((word) => [word, rock])));

/** @param {string} text */
const words = (text) => text.toLowerCase().match(/[a-z]+/g) ?? [];

// Return the rock that a text of this track names first.
/** @param {string} track @param {string} text */
export function rockOf(track, text) {
  if (!words(track).some((word) => definition.tracks.includes(word))) return undefined;
  const first = words(text).find((word) => named.has(word) || named.has(word.replace(/s$/, ''))) ?? '';
  return named.get(first) ?? named.get(first.replace(/s$/, ''));
}

/** @param {Rock} rock @param {Theme} theme */
export const rockColour = (rock, theme) => `#${rock.colours[theme === 'dark' ? 1 : 0]}`;

// Fill a track between two heights; the pattern begins at `from`, so that it moves with the rock.
/** @param {Ink} ink @param {Rock} rock @param {Rect} rect @param {number} from @param {Palette} palette @param {Theme} theme */
export function drawRock(ink, rock, { left, top, width, height }, from, palette, theme) {
  ink.fillStyle = rockColour(rock, theme);
  ink.fillRect(left, top, width, height);
  within(ink, { left, top, width, height }, () => {
    ink.beginPath();
    for (let y = from + TALL * Math.floor((top - from) / TALL); y < top + height; y += TALL) {
      for (let x = left; x < left + width; x += WIDE) {
        for (const [x0, y0, x1, y1] of rock.marks) {
          ink.moveTo(x + x0, y + y0 + 0.5);
          ink.lineTo(x + x1, y + y1 + 0.5);
        }
      }
    }
    ink.strokeStyle = palette.soft;
    ink.lineWidth = 1;
    ink.globalAlpha = 0.7;
    ink.stroke();
    ink.globalAlpha = 1;
  });
}

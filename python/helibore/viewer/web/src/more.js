// The parts of the page that late.js loads.

export { columnRows, drawColumns, drawPipes } from './columns.js';
export { drawCurtain } from './curtain.js';
export { film } from './film.js';
export { drawNet } from './net.js';
export { drawNext, drawPoints } from './pick_ink.js';
export { openingOf } from './opening.js';
export { inWords, writeCard } from './pick_card.js';
export { marksOf, surenessOf } from './sureness.js';
export { default as HELP } from '../help.html';
export { BIT, BIT_CORNERS, INSIDE_FRAGMENT } from './late_shaders.js';
export { plainImage } from './plain_image.js';
export { paneOf } from './pane_picture.js';
export { saveStage } from './stage_picture.js';
export { hungInRig, placesOf, tightNow, writeDigits, zonesInRig } from './rig_digits.js';
export { rigSection } from './rig_places.js';
export { default as rigStyles } from '../rig.css';
export { drawRun } from './run_chart.js';
export { toTemplate } from './template_text.js';
export { drawWallInk } from './wall_ink.js';
export { unpicked } from './unpicked.js';

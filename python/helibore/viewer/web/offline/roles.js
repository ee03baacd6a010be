// Guess the role of each channel by name, description and unit, never by values, as helibore.channels.roles does from the
// same table of names.

import { rules, unitInName, unitOf } from './rules.js';

/**
 * @typedef {import('./table.js').Channel} Channel
 * @typedef {import('./table.js').LogSet} LogSet
 * @typedef {import('./rules.js').NameRule} NameRule
 * @typedef {{ channel: string, role: string, reason: string, unit: string, angle: number | null, reference: string, stated?: boolean, changed?: boolean }} Role
 */

const NO_RULE = 'no rule fits';
const CALIPER_TEXT = /\bcaliper\b(?!.*\b(matrix|filtered|corrected porosity|salinity)\b)/i;
const ONE_OF_SEVERAL = /\b(arm|finger|radius)\b/i;
const NUMBERED = /^(.*?\D)[[_:(. -]?(\d{1,4})[\])]?(\D{0,8})$/;

/** @param {string} unit */
const measures = (unit) => unitOf(unit)?.[0] ?? '';
/** @param {Channel} channel @param {string} kind */
const fits = ({ unit }, kind) => !kind || !unit || measures(unit) === kind;

// Return the name in lower case without the unit at its end.
/** @param {Channel} channel */
function stem({ name: given }) {
  let name = given.toLowerCase();
  const unit = unitInName(given).toLowerCase();
  if (unit && name.endsWith(unit) && !/[[(]$/.test(name.slice(0, -unit.length))) name = name.slice(0, -unit.length).replace(/[_ ]+$/, '') || name;
  return name.replace(/\s*[[(][^\])]*[\])]\s*$/, '').trim();
}

/** @param {Channel} channel */
function spellings(channel) {
  const plain = stem(channel);
  return [plain, plain.replace(new RegExp(`(?:${rules.names.endings.join('|')})$`), '') || plain];
}

/** @param {NameRule} rule @param {Channel} channel */
const named = (rule, channel) => spellings(channel).some((name) => rule.names?.includes(name) || (rule.pattern && new RegExp(`^(?:${rule.pattern})$`).test(name)));
/** @param {NameRule} rule @param {Channel} channel */
const says = (rule, { description }) => Boolean(description && rule.described && new RegExp(rule.described, 'i').test(description));
/** @param {NameRule} rule @param {Channel} channel */
const allows = (rule, { name, description, unit }) => !(rule.never && new RegExp(rule.never, 'i').test(`${name} ${description}`.replaceAll('_', ' '))) && Boolean(unit || !rule.unit_stated);

/** @param {Channel} channel @param {string} role @param {string} reason @param {Partial<Role>} [more] @returns {Role} */
const roleOf = ({ name, unit }, role, reason, more = {}) => ({ channel: name, role, reason, unit, angle: null, reference: '', ...more });

// Return the roles of all channels, in the order of the file.
/** @param {LogSet} set @returns {Role[]} */
export function guess({ channels, index }) {
  /** @type {Map<string, Role>} */
  const roles = new Map(channels.map((channel) => [channel.name, roleOf(channel, 'none', NO_RULE)]));
  /** @param {Channel} channel @returns {Role} */
  const of = ({ name }) => /** @type {Role} */ (roles.get(name));
  /** @param {string} role */
  const owner = (role) => [...roles.values()].find((each) => each.role === role)?.channel;
  const { single } = rules.names;
  const inclined = single.some((rule) => rule.role === 'inclination' && channels.some((one) => (named(rule, one) || says(rule, one)) && fits(one, 'angle')));
  for (const byName of [true, false]) {
    for (const rule of single) {
      for (const channel of channels) {
        if (of(channel).role !== 'none' || (!byName && of(channel).reason !== NO_RULE)) continue;
        if (channel.texts && !['time', 'toolface-reference'].includes(rule.role)) continue;
        if (!(byName ? named(rule, channel) : says(rule, channel)) || !allows(rule, channel)) continue;
        roles.set(channel.name, singleRole(rule, channel, byName ? `named ${channel.name}` : `described as "${channel.description}"`, owner(rule.role), inclined));
      }
    }
  }
  const first = channels.find(({ name }) => name === index);
  if (first && !owner('depth') && !first.texts && of(first).role === 'none' && measures(first.unit) === 'length') roles.set(first.name, roleOf(first, 'depth', 'it is the index and a length'));
  const hasToolface = owner('toolface') !== undefined;
  for (const channel of channels) {
    if (of(channel).role === 'none' && !channel.texts) roles.set(channel.name, wallRole(channel, hasToolface) ?? of(channel));
  }
  for (const channel of channels) { // its bad cell is then named
    if (!channel.texts || of(channel).role !== 'none') continue;
    const taken = (/** @type {string} */ role) => [...roles.values()].some((each) => each.role === role);
    const rule = single.find((one) => ['depth', 'toolface'].includes(one.role) && !taken(one.role) && named(one, channel) && allows(one, channel) && fits(channel, rules.roles[one.role]));
    const found = rule ? roleOf(channel, rule.role, `named ${channel.name}`) : taken('radius') || taken('diameter') ? null : wallRole(channel, hasToolface || taken('toolface'));
    if (found && ['depth', 'toolface', 'radius', 'diameter'].includes(found.role)) roles.set(channel.name, { ...found, reason: `${found.reason}, but not every cell is a number` });
  }
  setsOfArms(channels, roles);
  const arms = [...roles.values()].filter((each) => each.role === 'diameter' && each.reason.includes('arm pair'));
  if (new Set(arms.map(({ angle }) => angle)).size === 1) {
    for (const arm of arms) roles.set(arm.channel, { ...arm, role: 'none', angle: null, reason: 'named like one arm pair of an X-Y caliper, but its partner at right angles is missing' });
  }
  return [...roles.values()];
}

/** @param {NameRule} rule @param {Channel} channel @param {string} how @param {string | undefined} owned @param {boolean} inclined */
function singleRole(rule, channel, how, owned, inclined) {
  const { role } = rule;
  if (!fits(channel, rules.roles[role])) return roleOf(channel, 'none', `${how}, like ${role}, but "${channel.unit}" is no known unit of ${rules.roles[role]}`);
  if (owned !== undefined) return roleOf(channel, 'none', `${how}, like ${role}; ${owned} has this role`);
  if (role === 'azimuth' && !inclined) return roleOf(channel, 'none', `${how}, but a survey also needs an inclination`);
  return roleOf(channel, role, how, { reference: role === 'toolface' ? reference(rule, channel) : '' });
}

// Return what a toolface counts from, by its rule, or else by its description; '' if it is not stated.
/** @param {NameRule} rule @param {Channel} channel */
function reference(rule, channel) {
  const known = [rule, ...rules.names.single.filter((each) => each.role === 'toolface' && says(each, channel))].find((each) => each.reference);
  return known?.reference ?? (/\bfrom (magnetic |true |grid )?north\b/i.test(channel.description) ? 'north' : '');
}

/** @param {Channel} channel @param {boolean} hasToolface @returns {Role | null} */
function wallRole(channel, hasToolface) {
  const sonic = /\b(transit|transmitter|receiver|sonic|compressional|shear|integrated)\b/i.test(channel.description);
  const echo = /^(?:(tw)?tt\d?|travel[_ ]?time|transit[_ ]?time|awtt|two[_ ]?way[_ ]?time)$/.test(stem(channel)) || /\btravel ?time\b/i.test(channel.description);
  if (echo && !sonic && measures(channel.unit) === 'time') return roleOf(channel, 'travel-time', 'named or described as a travel time');
  if (!fits(channel, 'length')) return null;
  for (const rule of rules.names.wall) {
    const byName = named(rule, channel);
    if (!(byName || says(rule, channel)) || !allows(rule, channel) || (rule.needs_toolface && !hasToolface)) continue;
    let how = byName ? `named ${channel.name}` : `described as "${channel.description}"`;
    if (rule.role === 'none') return roleOf(channel, 'none', `${how}: ${rule.reason}`);
    if (rule.role === 'mean-diameter') return roleOf(channel, rule.role, `named or described as a caliper (${channel.description || channel.name}) without a direction`);
    if (rule.arm) how = `named like the ${rule.arm} arm pair of a caliper: across the hole at ${rule.angle} deg from the toolface`;
    return roleOf(channel, rule.role, how, { angle: rule.angle ?? (hasToolface ? 0 : null) });
  }
  return channel.unit && CALIPER_TEXT.test(channel.description) ? roleOf(channel, 'mean-diameter', `described as a caliper (${channel.description}) without a direction`) : null;
}

/** @param {Channel[]} channels @param {Map<string, Role>} roles */
function setsOfArms(channels, roles) {
  const byName = new Map(channels.map((channel) => [stem(channel), channel]));
  for (const { names, step } of rules.names.sets) {
    for (const members of names) {
      const arms = members.flatMap((name) => byName.get(name) ?? []).filter((arm) => fits(arm, 'length'));
      if (arms.length < members.length) continue;
      const doubtful = arms.some((arm) => ONE_OF_SEVERAL.test(arm.description));
      const shown = arms.map(({ name }) => name).join(', ');
      arms.forEach((arm, at) => roles.set(arm.name, doubtful
        ? roleOf(arm, 'none', `${shown} are three diameters ${step} deg apart, or three radii ${2 * step} deg apart: choose`)
        : roleOf(arm, 'diameter', `one arm pair of ${shown}, ${step} deg apart: across the hole at ${at * step} deg from the toolface`, { angle: at * step })));
    }
  }
}

// Return the stem of numbered columns that the package joins to one image, which this page does not do; '' if there are none.
/** @param {LogSet} set */
export function sectorsOf({ channels, index }) {
  /** @type {Map<string, number[]>} */
  const series = new Map();
  for (const { name, unit, texts } of channels) {
    const match = NUMBERED.exec(name);
    if (!match || texts || name === index || match[1].startsWith('column')) continue;
    const key = JSON.stringify([match[1], match[3], unit]);
    series.set(key, [...(series.get(key) ?? []), Number(match[2])]);
  }
  for (const [key, numbers] of series) {
    const [name, , unit] = JSON.parse(key);
    if (numbers.length >= 4 && Math.min(...numbers) <= 1 && measures(unit) === 'length') return name;
  }
  return '';
}

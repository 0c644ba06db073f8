// The panels: counts and state of the run, legend, time line, the numbers of a person, tau.

import { SYMBOLS, LYING, drawSymbol } from './marks.js';
import { scaleColours } from './water.js';

export const $ = (id) => document.getElementById(id);
const number = (v, digits = 2) => (Number.isFinite(v) ? v.toFixed(digits).replace('-', '\u2212') : '\u2013');
const TELLING = ['arrived', 'dead', 'drowned', 'toppled', 'carried', 'afloat']; // changes that the time line marks

export function symbolCanvas(state) {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 36;
  const [shape, colour] = state === 'tumbled' ? LYING : SYMBOLS[state];
  drawSymbol(canvas.getContext('2d'), shape, colour, 36);
  return canvas;
}

/** How many are in each state, as symbol, number and word. */
export function showCounts(counts) {
  const text = JSON.stringify(counts), box = $('counts');
  if (box.dataset.shown === text) return;
  box.dataset.shown = text;
  box.replaceChildren(...Object.entries(counts).map(([state, n]) => {
    const item = document.createElement('span');
    item.dataset.state = state;
    item.dataset.count = n;
    if (SYMBOLS[state] || state === 'tumbled') item.append(symbolCanvas(state));
    item.append(`${n} ${state}`);
    return item;
  }));
}

export function showState(word, sub, note) {
  $('state').textContent = word === 'lost' ? 'no server' : word;
  $('state').dataset.word = word;
  $('sub').textContent = sub;
  $('note').textContent = note;
}

export function showLegend(legend, mode) {
  $('legend-name').textContent = mode === 'clear' ? 'clear water, foam where it is steep or fast' : `${legend.name}, ${legend.unit}`;
  $('bar').style.display = $('ticks').style.display = mode === 'clear' ? 'none' : '';
  $('bar').style.background = `linear-gradient(90deg, ${scaleColours(mode).join(',')})`;
  $('ticks').replaceChildren(...[0, 0.25, 0.5, 0.75, 1].map((share, k) => {
    const tick = document.createElement('span');
    tick.textContent = `${+(share * legend.full).toPrecision(3)}${k === 4 ? ` ${legend.unit}` : ''}`;
    return tick;
  }));
}

/** Marks on the time line: who arrived, fell, was carried or died, and each change of tau. */
export function showEvents(changes, taus, end) {
  const colours = { arrived: '#009e73', dead: '#16161a', drowned: '#16161a', toppled: '#d55e00', carried: '#0072b2', afloat: '#56b4e9' };
  const marks = new Map();
  for (const [time, , state] of changes) {
    if (!TELLING.includes(state)) continue;
    const key = `${Math.round((400 * time) / Math.max(end, 1e-6))} ${state}`;
    marks.set(key, { time, state, count: (marks.get(key)?.count ?? 0) + 1 });
  }
  const list = [...marks.values()].map(({ time, state, count }) => {
    const mark = document.createElement('i');
    mark.style.background = colours[state];
    mark.title = `${count} ${state} at ${time.toFixed(1)} s`;
    mark.style.left = `${(100 * time) / end}%`;
    mark.style.height = `${Math.min(13, 5 + 2 * count)}px`;
    return mark;
  });
  for (const { time, text } of taus) {
    const mark = document.createElement('i');
    mark.className = 'tau';
    mark.title = text;
    mark.style.left = `${(100 * time) / end}%`;
    list.push(mark);
  }
  $('events').replaceChildren(...list);
}

function rows(list) {
  const table = document.createElement('table');
  for (const [name, value, unit] of list) {
    const row = table.insertRow();
    row.insertCell().innerHTML = name;
    row.insertCell().textContent = unit ? `${value} ${unit}` : value;
  }
  return table;
}

/** One row of a table with a header, as an object; numbers where they are numbers. */
export function rowOf(text) {
  const [head, row] = text.trim().split('\n').map((line) => line.split(','));
  return row ? Object.fromEntries(head.map((name, k) => [name, row[k] !== '' && Number.isFinite(+row[k]) ? +row[k] : row[k]])) : null;
}

/** The numbers of a person: as it is, the terms of the equations, how it ended. */
export function showPerson(person, terms, agent, hint) {
  const panel = $('who');
  panel.classList.toggle('open', Boolean(person || agent));
  if (!person && !agent) return;
  const id = person?.id ?? agent.id, title = document.createElement('h2');
  title.textContent = `person ${id}${agent?.group ? `, ${agent.group}` : ''}`;
  const parts = [title];
  if (person) {
    parts.push(rows([
      ['state', person.state], ['posture', person.posture], ['x, z', `${number(person.x)}, ${number(person.z)}`, 'm'], ['speed over ground', number(person.speed), 'm/s'],
      ['height', number(person.height), 'm'],
    ]));
  }
  if (terms) {
    const m = terms.mass_kg, w = terms.water_mass_kg, tau = terms.tau, px = terms.water_momentum_x_kg_m_s, pz = terms.water_momentum_z_kg_m_s;
    const vx = terms.walking_x_m_s, vz = terms.walking_z_m_s, pair = (a, b) => `${number(a)}, ${number(b)}`;
    const list = [
      ['tau <small>endurance</small>', number(tau)], ['m<sub>a</sub>', number(m, 1), 'kg'], ['v<sub>B</sub> <small>wants, x z, Eq. 4</small>', pair(vx, vz), 'm/s'],
    ];
    if (Number.isFinite(w)) {
      list.push(
        ['\u03a3m<sub>i</sub> <small>touching water, Eq. 5</small>', number(w, 1), 'kg'], ['\u03a3m<sub>i</sub>v<sub>i</sub> <small>Eq. 5</small>', pair(px, pz), 'kg m/s'],
        ['p <small>m<sub>a</sub>v<sub>B</sub> + \u03a3m<sub>i</sub>v<sub>i</sub>, Eq. 6</small>', pair(m * vx + px, m * vz + pz), 'kg m/s'],
        ['M <small>m<sub>a</sub> + \u03a3m<sub>i</sub>, Eq. 7</small>', number(m + w, 1), 'kg'],
        ['\u03c4\u03a3m<sub>i</sub> <small>yields to, Eq. 8</small>', number(tau * w, 1), 'kg'], ['\u03c4\u03a3m<sub>i</sub>v<sub>i</sub> <small>Eq. 8</small>', pair(tau * px, tau * pz), 'kg m/s'],
      );
    }
    list.push(['v <small>goes, x z, Eq. 9</small>', pair(terms.velocity_x_m_s, terms.velocity_z_m_s), 'm/s']);
    if (Number.isFinite(terms.depth_m)) list.push(['h <small>felt depth</small>', number(terms.depth_m), 'm'], ['U <small>felt stream, x z</small>', pair(terms.stream_x_m_s, terms.stream_z_m_s), 'm/s']);
    if (Number.isFinite(terms.slip)) list.push(['S <small>slips at 1</small>', number(terms.slip)], ['T <small>topples at 1</small>', number(terms.topple)]);
    parts.push(rows(list));
  } else if (hint) {
    const line = document.createElement('small');
    line.textContent = hint;
    parts.push(line);
  }
  if (agent && agent.outcome !== 'active') parts.push(rows([['outcome', `${agent.outcome} at ${number(agent.time_s, 1)} s`], ['way', number(agent.path_length_m, 1), 'm'], ['deepest water', number(agent.max_depth_m), 'm'], ['most depth x speed', number(agent.max_dv_m2_s), 'm\u00b2/s']]));
  panel.replaceChildren(...parts);
}

export function fillHelp() {
  const list = $('symbols');
  for (const state of [...Object.keys(SYMBOLS).filter((s) => SYMBOLS[s] && s !== 'drowned'), 'tumbled']) {
    const term = document.createElement('dt'), text = document.createElement('dd'), canvas = symbolCanvas(state);
    canvas.style.cssText = 'width:18px;height:18px';
    term.append(canvas);
    text.textContent = { dead: 'dead, drowned', tumbled: 'tumbled by the water (poses.csv)' }[state] ?? state;
    list.append(term, text);
  }
}

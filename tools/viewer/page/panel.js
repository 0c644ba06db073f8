// What the page shows about the run: symbols of states and outcomes, traces of the paths, the ring round the selected
// person, and the panels: counts and state of the run, legend, time line, the numbers of a person and their course.

import * as THREE from 'three';
import { UNKNOWN, UNTOLD } from './people.js';
import { scaleColours } from './water.js';

// Shape and colour of each state, so that neither is needed alone.
export const SYMBOLS = {
  walking: null, standing: ['square', '#bbbbbb'], effort: ['bars', '#f0e442'], sliding: ['chevron', '#e69f00'], toppled: ['triangle', '#d55e00'],
  afloat: ['drop', '#56b4e9'], carried: ['waves', '#0072b2'], recovering: ['plus', '#ffffff'], holding: ['ring', '#cc79a7'], pinned: ['wall', '#e69f00'],
  drowned: ['cross', '#16161a'], dead: ['cross', '#16161a'], arrived: ['tick', '#009e73'], sheltered: ['house', '#009e73'],
  indoors: ['house', '#bbbbbb'], upper_floor: ['house', '#56b4e9'],
  [UNKNOWN]: ['question', '#ffffff'],
};
export const LYING = ['waves', '#0072b2']; // of a person with state walking and posture lying: tumbled by the water
const CELL = 64, ATLAS = 5; // pixels of a symbol, symbols of a row of the texture
const HARMLESS = ['walking', 'standing', 'arrived', 'sheltered', 'indoors', 'upper_floor']; // below the others where symbols overlap

export function drawSymbol(c, shape, colour, size) {
  const dark = colour === '#16161a';
  c.save();
  c.scale(size / 64, size / 64);
  c.translate(32, 32);
  c.beginPath();
  c.arc(0, 0, 29, 0, 2 * Math.PI);
  c.fillStyle = dark ? '#ffffff' : '#1c2530';
  c.fill();
  c.lineWidth = 3;
  c.strokeStyle = dark ? '#16161a' : '#ffffff';
  c.stroke();
  c.strokeStyle = c.fillStyle = colour;
  c.lineWidth = 7;
  c.lineCap = c.lineJoin = 'round';
  c.beginPath();
  const line = (...points) => points.forEach(([x, y], k) => c[k ? 'lineTo' : 'moveTo'](x, y));
  if (shape === 'square') c.rect(-11, -11, 22, 22), c.fill();
  if (shape === 'bars') line([-10, -13], [-10, 13]), line([10, -13], [10, 13]);
  if (shape === 'chevron') line([-14, 2], [0, -11], [14, 2]), line([-14, 15], [0, 2], [14, 15]);
  if (shape === 'triangle') line([0, -15], [16, 12], [-16, 12], [0, -15]), c.fill();
  if (shape === 'drop') line([0, -17], [12, 4]), c.arc(0, 5, 12, 0, Math.PI), c.lineTo(0, -17), c.fill();
  if (shape === 'waves') for (const y of [-9, 6]) { c.moveTo(-18, y); c.bezierCurveTo(-9, y - 12, -6, y + 14, 2, y + 2); c.bezierCurveTo(8, y - 8, 12, y - 6, 18, y + 2); }
  if (shape === 'plus') line([0, -15], [0, 15]), line([-15, 0], [15, 0]);
  if (shape === 'ring') c.arc(0, 0, 13, 0, 2 * Math.PI);
  if (shape === 'wall') line([-12, -16], [-12, 16]), line([16, 0], [-4, 0]), line([5, -9], [-4, 0], [5, 9]);
  if (shape === 'dot') c.arc(0, 0, 20, 0, 2 * Math.PI), c.fill();
  if (shape === 'cross') line([-13, -13], [13, 13]), line([-13, 13], [13, -13]);
  if (shape === 'house') line([-15, 15], [-15, -2], [0, -16], [15, -2], [15, 15], [-15, 15]), c.fill();
  if (shape === 'question') c.arc(0, -7, 9, -Math.PI, 0.45 * Math.PI), c.lineTo(1, 7), c.moveTo(1, 17), c.lineTo(1, 17.5);
  if (shape === 'tick') line([-15, 1], [-4, 13], [15, -12]);
  c.stroke();
  c.restore();
}

const TRACE_VERTEX = `
  attribute vec2 corner, high; attribute vec4 ends, more; // ta, tb, colour r g packed
  uniform vec2 screen; uniform float width, now, lift, past, faint; uniform vec3 colours[9]; varying vec4 tint;
  void main() {
    vec4 a = projectionMatrix * viewMatrix * vec4(ends.x, high.x + lift, -ends.y, 1.), b = projectionMatrix * viewMatrix * vec4(ends.z, high.y + lift, -ends.w, 1.);
    tint = vec4(colours[int(more.z)], more.w > .5 ? 1. : .85 * faint);
    if (more.x > now || a.w < .1 || b.w < .1) { gl_Position = vec4(2., 2., 2., 1.); return; }
    float reach = clamp((now - more.x) / max(1e-4, more.y - more.x), 0., 1.);
    b = mix(a, b, reach);
    vec2 d = (b.xy / b.w - a.xy / a.w) * screen; d = length(d) > 1e-5 ? normalize(d) : vec2(1., 0.);
    vec4 p = corner.x < .5 ? a : b;
    float wide = width * (more.w > .5 ? 2. : 1.);
    p.xy += p.w * wide * (vec2(-d.y, d.x) * corner.y + d * (corner.x < .5 ? -.5 : .5)) / screen;
    gl_Position = p;
  }`;

export class Traces {
  /** heightAt: of the ground, m. */
  constructor(parent, colours, heightAt) {
    this.heightAt = heightAt;
    const g = new THREE.InstancedBufferGeometry();
    g.setAttribute('corner', new THREE.Float32BufferAttribute([0, -1, 1, -1, 0, 1, 1, 1], 2));
    g.setIndex([0, 1, 2, 2, 1, 3]);
    g.instanceCount = 0;
    this.uniforms = { screen: { value: new THREE.Vector2(1, 1) }, width: { value: 1.6 }, now: { value: 0 }, lift: { value: 0.06 }, faint: { value: 1 }, past: { value: 0 }, colours: { value: colours.map((c) => new THREE.Color(c)) } };
    const material = new THREE.ShaderMaterial({ uniforms: this.uniforms, vertexShader: TRACE_VERTEX, transparent: true, depthWrite: false, side: THREE.DoubleSide,
      fragmentShader: 'varying vec4 tint; void main() { gl_FragColor = tint;\n#include <colorspace_fragment>\n}' });
    this.mesh = new THREE.Mesh(g, material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 4; // before the water, through which they are seen
    parent.add(this.mesh);
    this.last = new Map(); // of id: time, x, z
    this.segments = [];
    this.until = -1;
  }

  /** Points in the order of ids and times, after those before. */
  take(message, colourOf, period) {
    const [id, t, x, z] = message.arrays;
    for (let k = 0; k < message.count; ++k) {
      const before = this.last.get(id[k]);
      if (before && t[k] <= before[0]) continue;
      if (before && !(period && Math.abs(x[k] - before[1]) > period / 2)) this.segments.push([before[1], before[2], x[k], z[k], before[0], t[k], colourOf(id[k]), id[k], this.heightAt(before[1], before[2]), this.heightAt(x[k], z[k])]);
      this.last.set(id[k], [t[k], x[k], z[k]]);
      this.until = Math.max(this.until, t[k]);
    }
    this.rebuild();
  }

  rebuild(selected = this.selected) {
    this.selected = selected;
    const n = this.segments.length, ends = new Float32Array(4 * n), more = new Float32Array(4 * n), high = new Float32Array(2 * n);
    this.segments.forEach((s, k) => {
      ends.set([s[0], s[1], s[2], s[3]], 4 * k);
      more.set([s[4], s[5], s[6], s[7] === selected ? 1 : 0], 4 * k);
      high.set([s[8], s[9]], 2 * k);
    });
    const g = this.mesh.geometry;
    g.setAttribute('ends', new THREE.InstancedBufferAttribute(ends, 4));
    g.setAttribute('more', new THREE.InstancedBufferAttribute(more, 4));
    g.setAttribute('high', new THREE.InstancedBufferAttribute(high, 2));
    g.instanceCount = n;
  }
}

export class Symbols {
  constructor(parent) {
    const canvas = document.createElement('canvas');
    canvas.width = canvas.height = ATLAS * CELL;
    const c = canvas.getContext('2d');
    this.cells = new Map();
    Object.entries({ ...SYMBOLS, walking: ['dot', '#ffffff'], tumbled: LYING }).filter(([, s]) => s).forEach(([state, [shape, colour]], k) => {
      c.save();
      c.translate((k % ATLAS) * CELL, Math.floor(k / ATLAS) * CELL);
      drawSymbol(c, shape, colour, CELL);
      c.restore();
      this.cells.set(state, k);
    });
    const texture = new THREE.CanvasTexture(canvas);
    texture.colorSpace = THREE.SRGBColorSpace;
    texture.flipY = false;
    this.walking = this.cells.get('walking');
    this.cells.set(UNTOLD, this.walking);
    this.uniforms = { map: { value: texture }, size: { value: 15 }, high: { value: 700 }, walking: { value: this.walking } };
    this.points = new THREE.Points(new THREE.BufferGeometry(), new THREE.ShaderMaterial({
      uniforms: this.uniforms, transparent: true, depthTest: false, depthWrite: false,
      // Whoever walks has a dot where the figure is no more than a dozen pixels high.
      vertexShader: `attribute float cell; uniform float size, high, walking; varying float c;
        void main() { c = cell; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.);
          gl_PointSize = size * clamp(26. / max(1., gl_Position.w), .55, 1.3);
          if (cell == walking) {
            gl_PointSize *= .75;
            if (.85 * projectionMatrix[1][1] * high / gl_Position.w > 12.) gl_Position = vec4(2., 2., 2., 1.);
          } }`,
      fragmentShader: `uniform sampler2D map; varying float c;
        void main() { vec4 t = texture2D(map, (vec2(mod(c, ${ATLAS}.), floor(c / ${ATLAS}. + .01)) + gl_PointCoord) / ${ATLAS}.); if (t.a < .1) discard; gl_FragColor = t;
        #include <colorspace_fragment>
        }`,
    }));
    this.points.frustumCulled = false;
    this.points.renderOrder = 9;
    parent.add(this.points);
  }

  /** list: x, y, z and state; ratio: pixels of the picture per pixel of the window. From above the symbols of many people are
   * smaller, at least 6 pixels of the window. */
  show(list, isAbove, ratio) {
    const rank = (p) => (p.state === 'walking' || p.state === UNTOLD ? 0 : HARMLESS.includes(p.state) ? 1 : 2), known = list.filter((p) => this.cells.has(p.state)).sort((a, b) => rank(a) - rank(b));
    this.uniforms.size.value = ratio * (!isAbove ? 15 : list.length > 300 ? 8 : list.length > 100 ? 10 : 13);
    this.uniforms.high.value = innerHeight;
    const g = this.points.geometry;
    const position = new Float32Array(3 * known.length), cell = new Float32Array(known.length);
    known.forEach((p, k) => {
      position.set([p.x, p.y, -p.z], 3 * k);
      cell[k] = this.cells.get(p.state);
    });
    g.setAttribute('position', new THREE.BufferAttribute(position, 3));
    g.setAttribute('cell', new THREE.BufferAttribute(cell, 1));
    g.setDrawRange(0, known.length);
  }
}

export function makeRing(parent) {
  const ring = new THREE.Mesh(new THREE.TorusGeometry(0.75, 0.06, 8, 40), new THREE.MeshBasicMaterial({ color: 0xffffff, depthTest: false, transparent: true, opacity: 0.95 }));
  ring.rotation.x = Math.PI / 2;
  ring.renderOrder = 8;
  ring.visible = false;
  parent.add(ring);
  return ring;
}

export const $ = (id) => document.getElementById(id);

/** Takes the next choice of a list. */
export function cycle(id) {
  const list = $(id), next = (k) => (k + 1) % list.options.length;
  let k = next(list.selectedIndex);
  while (list.options[k].disabled) k = next(k);
  list.selectedIndex = k;
  $(id).dispatchEvent(new Event('change'));
}
const number = (v, digits = 2) => (Number.isFinite(v) ? v.toFixed(digits).replace('-', '\u2212') : '\u2013');
const TELLING = ['arrived', 'sheltered', 'dead', 'drowned', 'toppled', 'carried', 'afloat']; // changes that the time line marks

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

/** The legend of a mode; without velocities there are no speeds to show. */
export function showLegend(legend, mode, hasVelocity) {
  const isMissing = mode === 'speed' && !hasVelocity, speed = $('mode').querySelector('[value=speed]');
  speed.disabled = !hasVelocity;
  speed.textContent = hasVelocity ? 'speed' : 'speed: not recorded';
  $('legend-name').textContent = isMissing ? 'no speeds: water.bin has depths only; run with --record FILE for velocities'
    : mode === 'clear' ? `clear water, foam where it is steep${hasVelocity ? ' or fast' : ''}` : `${legend.name}, ${legend.unit}`;
  $('bar').style.display = $('ticks').style.display = mode === 'clear' || isMissing ? 'none' : '';
  $('bar').style.background = `linear-gradient(90deg, ${scaleColours(mode).join(',')})`;
  $('ticks').replaceChildren(...[0, 0.25, 0.5, 0.75, 1].map((share, k) => {
    const tick = document.createElement('span');
    tick.textContent = `${k === 4 && legend.isBeyond ? '\u2265 ' : ''}${+(share * legend.full).toPrecision(3)}${k === 4 ? ` ${legend.unit}` : ''}`;
    return tick;
  }));
}

/** Draws marks on the time line: people that arrived, fell, drifted or died, and each change of tau. */
export function showEvents(changes, taus, end) {
  const marks = new Map();
  for (const [time, , state] of changes) {
    if (!TELLING.includes(state)) continue;
    const key = `${Math.round((400 * time) / Math.max(end, 1e-6))} ${state}`;
    marks.set(key, { time, state, count: (marks.get(key)?.count ?? 0) + 1 });
  }
  const list = [...marks.values()].map(({ time, state, count }) => {
    const mark = document.createElement('i');
    mark.style.background = SYMBOLS[state][1];
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

// Of a person over time: name, unit, colour and dashes (told apart by both), value of a row of terms.csv.
const COURSES = [
  ['tau', '', '#d55e00', [], (r) => r.tau], ['h', 'm', '#0072b2', [6, 3], (r) => r.depth_m], ['v', 'm/s', '#009e73', [2, 2], (r) => Math.hypot(r.velocity_x_m_s, r.velocity_z_m_s)],
  ['S', '', '#cc79a7', [8, 2, 2, 2], (r) => r.slip], ['T', '', '#e69f00', [1, 3], (r) => r.topple],
];

/** Draws the terms of a person over the run, each on a scale up to the value in the legend; a line marks the time. */
function courseChart(rows_of, time) {
  const canvas = document.createElement('canvas'), c = canvas.getContext('2d'), wide = 440, high = 130;
  Object.assign(canvas, { width: wide, height: high, className: 'course' });
  canvas.style.width = '100%';
  const first = rows_of[0].time_s, span = Math.max(1e-6, rows_of[rows_of.length - 1].time_s - first), x = (t) => 4 + ((wide - 8) * (t - first)) / span;
  const told = [];
  for (const [name, unit, colour, dashes, of] of COURSES) {
    const points = rows_of.map((r) => [x(r.time_s), of(r)]).filter(([, v]) => typeof v === 'number' && Number.isFinite(v));
    const top = points.reduce((most, [, v]) => Math.max(most, v), name.length > 1 || unit ? 0 : 1);
    if (!points.length || !(top > 0)) continue;
    c.strokeStyle = colour;
    c.lineWidth = 2.5;
    c.setLineDash(dashes);
    c.beginPath();
    points.forEach(([at, v], k) => c[k ? 'lineTo' : 'moveTo'](at, high - 6 - (high - 12) * Math.max(0, v / top)));
    c.stroke();
    told.push(`<span style="color:${colour}">${dashes.length ? '\u2504' : '\u2500'} ${name}</span> to ${+top.toPrecision(2)} ${unit}`);
  }
  c.setLineDash([]);
  c.strokeStyle = 'rgba(128,128,128,0.9)';
  c.lineWidth = 1.5;
  c.strokeRect(x(time), 0, 0.01, high);
  canvas.setAttribute('role', 'img');
  canvas.setAttribute('aria-label', `course of ${told.join(', ').replace(/<[^>]*>/g, '')} from ${number(first, 1)} s over ${number(span, 1)} s`);
  const legend = document.createElement('small');
  legend.innerHTML = told.join(' \u00b7 ');
  return [canvas, legend];
}

/** The numbers of a person: as it is, the terms of the equations, their course up to now, how it ended. */
export function showPerson(person, terms, agent, hint, course, time) {
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
    if (course?.id === id && course.rows.length > 1) parts.push(...courseChart(course.rows, time));
  } else if (hint) {
    const line = document.createElement('small');
    line.textContent = hint;
    parts.push(line);
  }
  if (agent && agent.outcome !== 'active') parts.push(rows([['outcome', `${agent.outcome} at ${number(agent.time_s, 1)} s`], ['way', number(agent.path_length_m, 1), 'm'], ['deepest water', number(agent.max_depth_m), 'm'], ['most depth x speed', number(agent.max_dv_m2_s), 'm\u00b2/s']]));
  panel.replaceChildren(...parts);
}

const TABLE = ['person', 'group', 'state', 'since, s', 'x, m', 'z, m', 'depth, m', 'speed, m/s'];
const urgency = ({ state }) => (['dead', 'drowned'].includes(state) ? 0 : HARMLESS.includes(state) ? 2 : 1);

/** The people of a time as a table, the dead and the endangered first; the button of a row picks its person. */
export function showTable(list, time, pick) {
  const body = $('rows'), focus = document.activeElement?.closest?.('#rows tr')?.dataset.id, rows_by_id = new Map([...body.rows].map((row) => [row.dataset.id, row]));
  $('rows-name').textContent = `people at ${time.toFixed(1)} s`;
  if (!$('rows-head').cells.length) for (const name of TABLE) $('rows-head').append(Object.assign(document.createElement('th'), { scope: 'col', textContent: name }));
  const ordered = list.sort((a, b) => urgency(a) - urgency(b) || (a.since ?? 0) - (b.since ?? 0) || a.id - b.id).map((p) => {
    const row = rows_by_id.get(`${p.id}`) ?? document.createElement('tr');
    if (!row.cells.length) {
      row.dataset.id = p.id;
      const button = Object.assign(document.createElement('button'), { textContent: p.id, onclick: () => pick(p.id) });
      row.append(Object.assign(document.createElement('th'), { scope: 'row' }));
      row.cells[0].append(button);
      for (let k = 1; k < TABLE.length; ++k) row.insertCell();
    }
    [p.group, p.state, ...[p.since, p.x, p.z, p.depth, p.speed].map((v, k) => number(v, k < 3 ? 1 : 2))].forEach((text, k) => {
      if (row.cells[k + 1].textContent !== text) row.cells[k + 1].textContent = text;
    });
    return row;
  });
  if (ordered.length !== body.rows.length || ordered.some((row, k) => row !== body.rows[k])) body.replaceChildren(...ordered);
  if (focus !== undefined) body.querySelector(`[data-id="${focus}"] button`)?.focus();
}

export function fillHelp() {
  const list = $('symbols');
  for (const state of [...Object.keys(SYMBOLS).filter((s) => SYMBOLS[s] && s !== 'drowned'), 'tumbled']) {
    const term = document.createElement('dt'), text = document.createElement('dd'), canvas = symbolCanvas(state);
    canvas.style.cssText = 'width:18px;height:18px';
    term.append(canvas);
    text.textContent = { dead: 'dead, drowned', tumbled: 'tumbled by the water (poses.csv)', upper_floor: 'on an upper floor', [UNKNOWN]: 'state unknown: not in the list of states' }[state] ?? state;
    list.append(term, text);
  }
}

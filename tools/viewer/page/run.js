// The run as the page knows it: positions and states of people at a time, the state of the run itself, and the stream
// of messages.

import { Buffer } from './buffer.js';
import { $, rowOf, showEvents, showPerson, showState } from './panel.js';
import { UNKNOWN, UNTOLD } from './people.js';

export const wanted = new URLSearchParams(location.hash.slice(1));

export const show = {
  run: null, scene: null, status: null, world: null, water: null, people: null, traces: null, symbols: null, ring: null,
  time: +(wanted.get('t') ?? 0), target: +(wanted.get('t') ?? 0), due: 0, playing: wanted.get('play') !== '0', speed: 1, live: false, step: 0, last: 0, selected: -1, ground: null, agents: new Map(), changes: [], taus: [],
  lost: false, terms: null, follows: false, tracesOn: true, symbolsOn: true, dark: false, drawn: 0, sought: wanted.has('t'), shownTime: -1,
};

export const buffer = new Buffer();

/** The rows of a table as objects. */
export function rowsOf(table) {
  const [head, ...lines] = table.trim().split('\n');
  return lines.map((line) => rowOf(`${head}\n${line}`)).filter(Boolean);
}

export const readAgents = (table) => rowsOf(table).forEach((agent) => {
  if (agent.outcome !== UNTOLD && !show.run?.states.includes(agent.outcome)) agent.outcome = UNKNOWN;
  show.agents.set(agent.id, agent);
});

export const faster = (way) => {
  const s = $('speed');
  s.selectedIndex = Math.min(s.options.length - 1, Math.max(0, s.selectedIndex + way));
  show.speed = +s.value;
};

/** Whether the page waits for the ground of the run's site before it draws anything. */
export const lacksGround = () => Boolean(show.run?.site?.houses && !show.ground);

/** Height of the ground, m. */
export const groundAt = (x, z) => show.ground?.at(x, z) ?? 0;

export function groupOf(id) {
  let end = 0;
  for (const [k, group] of (show.scene?.crowd.groups ?? []).entries()) if (id < (end += group.count)) return k;
  return 0;
}

export function heightOf(id) {
  const h = show.agents.get(id)?.height_m ?? show.scene?.crowd.groups[groupOf(id)]?.height_m;
  return typeof h === 'number' ? h : 1.7;
}

export function takeTaus(text) {
  const lines = text.trim() ? text.trim().split('\n').map((line) => JSON.parse(line)) : [];
  const rate = show.scene?.frame_rate_hz ?? 30;
  const events = [...(show.scene?.events ?? []), ...lines];
  show.taus = events.map((e) => ({ time: e.frame / rate, text: `tau ${e.tau} for ${e.group ?? (e.agent !== undefined ? `person ${e.agent}` : 'all')} at ${(e.frame / rate).toFixed(1)} s` }));
}

export const isLive = () => ['running', 'paused', 'stale', 'waiting'].includes(show.status?.live?.state);

export const lastTime = () => (show.live ? Math.max(show.time, buffer.lastTime(true)) : buffer.lastTime(!isLive()));

// A stream of agents has no poses: positions, velocities and outcomes; 0 stands for all states without an end, -1 is unknown. The positions move on by `later` seconds.
export function asPeople(m, later) {
  const [id, x0, z0, vx, vz, , state] = m.arrays, x = x0.map((v, k) => v + later * vx[k]), z = z0.map((v, k) => v + later * vz[k]), zero = new Float32Array(m.count), known = state.map((s) => s || -1), none = new Float32Array(m.count).fill(-1);
  const speed = vx.map((v, k) => Math.hypot(v, vz[k])), heading = vx.map((v, k) => Math.atan2(vz[k], v));
  return { ...m, arrays: [id, x, z, known, zero, heading, speed, zero, zero, zero, zero, zero, zero, zero, zero, none] };
}

/** Whether a state is an end: arrived, sheltered, dead. */
export const hasEnd = (state) => (show.run?.ends?.[show.run.states.indexOf(state)] ?? 'none') !== 'none';

export const stateShown = (p) => (p.state === 'walking' && p.posture === 'lying' ? 'tumbled' : p.state);

export function endedBy(time) {
  const list = [];
  for (const a of show.agents.values()) if (a.outcome !== 'active' && a.time_s <= time) list.push({ id: a.id, x: Math.max(0, a.x_m), z: a.z_m, state: a.outcome });
  return list;
}

/** Returns a row per person at the time shown: people in the frame, people that have ended, people still indoors. */
export function tableOf() {
  const since = new Map(), rows = new Map(), groups = show.scene?.crowd.groups ?? [];
  for (const [time, id, state] of show.changes) if (time <= show.time + 1e-6) since.set(id, { time, state });
  const add = (id, state, more) => rows.set(id, { id, group: groups[groupOf(id)]?.name ?? '', state, since: since.get(id)?.time, ...more });
  for (const p of show.people?.shown ?? []) add(p.id, stateShown(p), { x: p.x, z: p.z, speed: p.speed, depth: show.water?.grid.at(p.x, p.z) });
  for (const [id, { state }] of since) if (!rows.has(id) && hasEnd(state)) add(id, state);
  for (const end of endedBy(show.time)) if (!rows.has(end.id)) add(end.id, end.state, { x: end.x, z: end.z, since: show.agents.get(end.id).time_s });
  if (show.ground) for (let id = groups.reduce((n, g) => n + g.count, 0) - 1; id >= 0; --id) if (!rows.has(id)) add(id, 'indoors');
  return [...rows.values()];
}

export function countStates() {
  const counts = {}, seen = new Set(), all = show.scene?.crowd.groups.reduce((n, g) => n + g.count, 0) ?? show.people.shown.length;
  const add = (state) => (counts[state] = (counts[state] ?? 0) + 1);
  for (const p of show.people.shown) seen.add(p.id), add(stateShown(p));
  // A person that has ended is in one more frame; later frames of the file lack it.
  const ended = new Map();
  for (const [time, id, state] of show.changes) if (time <= show.time + 1e-6 && hasEnd(state)) ended.set(id, state);
  for (const end of endedBy(show.time)) ended.set(end.id, end.state);
  for (const [id, state] of ended) if (!seen.has(id)) add(state);
  const rest_of_all = all - Object.values(counts).reduce((a, b) => a + b, 0);
  if (show.ground && rest_of_all > 0) counts.indoors = (counts.indoors ?? 0) + rest_of_all; // have not left yet
  counts.total = all;
  const { total, ...rest } = counts;
  show.counts = rest;
  show.total = total;
  return rest;
}

export function stateOfPage() {
  const s = show.status;
  if (show.lost) return 'lost';
  if (s?.live && isLive()) return s.live.state;
  if (s?.live?.state === 'killed') return 'killed';
  // outcome.json says "running" from the start to the end: without a session that runs the crowd was killed.
  if (s?.outcome === 'running') return s.live ? s.live.state : 'killed';
  return s ? 'ended' : 'waiting';
}

/** Follows a run that goes on. */
export function follow() {
  show.live = isLive();
  show.pending = null;
  if (show.live) show.target = null;
}

/** Asks for a time, which the page shows as soon as its people and water have come. */
export function seek(time) {
  show.live = false;
  show.target = Math.min(Math.max(0, time), lastTime());
}

export function advance(wall) {
  if (!show.status) return;
  if (show.live && !isLive()) (show.live = false), (show.target = show.time);
  if (show.live) return advanceLive();
  if (show.target !== null) {
    if (!buffer.has(show.target)) return;
    show.time = show.due = show.target;
    show.target = null;
  }
  if (!show.playing) return;
  const end = lastTime(), step = buffer.stepOf(show.speed);
  if (end < show.time && isLive()) return; // it was the newest picture of a run that goes on
  // What a stall has lost is not made up for.
  show.due = Math.min(Math.max(show.due, show.time) + wall * show.speed, show.time + Math.max(1.001 * step, 0.25 * show.speed), end);
  show.time = buffer.reach(show.time, show.due, end, show.speed, wall);
  if (show.time >= end && !isLive()) setPlaying(false);
}

// The newest water with people of its time, also where they are none: the server counts frames that the run has passed. A pending one
// stays so until it is shown, as newer ones come all the time.
function advanceLive() {
  const people = show.status.people;
  if (people && !people.frames && (show.scene?.crowd.poses.rate_hz ?? 1) > 0) return; // no frame has come yet
  show.pending ??= buffer.newestLive();
  if (!show.pending || !buffer.peopleAt(show.pending.time)) return;
  show.time = show.pending.time;
  show.shownLive = show.pending;
  const next = buffer.newestLive();
  show.pending = next.frame > show.pending.frame ? next : null; // its people are asked for at once
}

export function setPlaying(on) {
  if (on && !show.live && show.time >= lastTime() - 1e-3 && !isLive()) show.target = 0;
  show.due = show.time;
  show.playing = on;
  $('play').textContent = on ? 'pause' : 'play';
  $('play').setAttribute('aria-pressed', on);
}

// Tells a screen reader the state of the run and the people that have come to an end, no more than once in 6 s.
let toldAt = -Infinity;
function announce() {
  const now = performance.now();
  if (now - toldAt < 6000) return;
  const ends = Object.entries(show.counts ?? {}).filter(([state]) => hasEnd(state)).map(([state, n]) => `${n} ${state}`);
  const text = [stateOfPage(), ...ends].join(', ');
  if ($('told').textContent === text) return;
  toldAt = now;
  $('told').textContent = text;
}

export function showTexts() {
  const s = show.status, end = lastTime(), w = show.water;
  const waterOf = w?.time !== undefined ? `water of ${w.time.toFixed(1)} s${w.message ? `, ${(w.message.count * w.message.stride).toLocaleString('en')} particles${w.message.stride > 1 ? `, every ${w.message.stride}th shown` : ''}` : ', depths only'}` : 'no water yet';
  const bare = s?.people?.frames > 1 && !s.people.poses ? '; paths only, for poses run with --view' : '';
  const gone = show.run?.site?.problem ? `; the site cannot be shown: ${show.run.site.problem}` : '';
  const cut = `${s?.recorded && !s.recorded.whole ? '; the recording was cut off' : ''}${gone}`;
  showState(stateOfPage(), s?.outcome && s.outcome !== 'running' ? s.outcome : '', `${waterOf}${bare}${cut}${[s?.live?.problem, s?.depths?.problem].filter(Boolean).map((text) => `; ${text}`).join('')}`);
  $('clock').textContent = `${show.time.toFixed(1)} / ${end.toFixed(1)} s`;
  const bar = $('time');
  bar.max = Math.max(end, 0.01);
  if (document.activeElement !== bar || show.playing) bar.value = show.time;
  $('live').hidden = !isLive();
  $('live').setAttribute('aria-pressed', show.live);
  announce();
  showEvents(show.changes, show.taus, Math.max(end, 0.01));
  const person = show.people?.shown.find((p) => p.id === show.selected), agent = show.agents.get(show.selected);
  showPerson(show.selected < 0 ? null : person, show.terms, show.selected < 0 ? null : agent, 'For the terms of Eq. 5 to 9 run with --view or --terms-every-s 0.1.', show.course, show.time);
}

// Questions and answers over the one WebSocket; tools/viewer/README.md has the table of a binary answer.

export const KINDS = { 1: 'water', 2: 'people', 3: 'depths', 4: 'paths', 5: 'walkers', 6: 'ground' };
const HEAD_BYTES = 56;

/** A binary message: its head, and `arrays` that look into the bytes as they came. */
export function decode(buffer) {
  const head = new DataView(buffer);
  const count = head.getUint32(8, true), fields = head.getUint32(12, true);
  const arrays = [];
  for (let k = 0; k < fields; ++k) arrays.push(new Float32Array(buffer, HEAD_BYTES + 4 * k * count, count));
  return {
    kind: KINDS[head.getUint32(4, true)], count, fields, arrays, bytes: buffer.byteLength,
    time: head.getFloat64(16, true), frame: head.getFloat64(24, true), stride: head.getUint32(32, true),
    columns: head.getUint32(36, true), x0: head.getFloat32(40, true), z0: head.getFloat32(44, true),
    cell: head.getFloat32(48, true), lasts: head.getFloat32(52, true),
  };
}

/** Asks one question of a kind at a time; a new one before the answer replaces the old one. */
export class Stream {
  constructor(handlers) {
    this.handlers = handlers; // by kind of message, and status, text, opened, closed
    this.waits = new Map(); // kind of question -> when it was asked
    this.bytes = 0; // received
    this.open();
  }

  open() {
    this.socket = new WebSocket(`ws://${location.host}/stream`);
    this.socket.binaryType = 'arraybuffer';
    this.socket.onopen = () => this.handlers.opened();
    this.socket.onclose = () => {
      this.waits.clear();
      this.handlers.closed();
      setTimeout(() => this.open(), 1000);
    };
    this.socket.onmessage = (event) => {
      this.heard = performance.now();
      // The server tells its state twice a second, mostly the same.
      if (event.data !== this.told) this.handlers.came();
      if (typeof event.data === 'string' && event.data.startsWith('{"status"')) this.told = event.data;
      this.take(event.data);
    };
  }

  take(data) {
    if (typeof data === 'string') {
      this.bytes += data.length;
      const answer = JSON.parse(data);
      if (answer.status) return this.handlers.status(answer.status);
      for (const kind of ['terms', 'course', 'changes', 'command']) if (kind in answer) this.waits.delete(kind);
      return this.handlers.text(answer);
    }
    this.bytes += data.byteLength;
    const message = decode(data);
    this.waits.delete(message.kind === 'water' ? 'live' : message.kind);
    this.handlers[message.kind](message);
  }

  /** False while there is no connection. */
  put(question) {
    if (this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(question));
    return true;
  }

  /** False while an answer of this kind is still out. */
  ask(kind, question = {}) {
    const since = performance.now() - (this.waits.get(kind) ?? -1e9);
    if (since < 2000 || !this.put({ get: kind, ...question })) return false;
    this.waits.set(kind, performance.now());
    return true;
  }

  command(line) {
    this.waits.delete('command');
    return this.ask('command', { line });
  }
}

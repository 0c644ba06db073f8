// The run as the page knows it, and what it says of a time: who is where in which state, how the run itself stands.

import { $, rowOf } from './panel.js';

export const wanted = new URLSearchParams(location.hash.slice(1));

export const show = {
  run: null, scene: null, status: null, world: null, water: null, people: null, traces: null, symbols: null, ring: null,
  time: +(wanted.get('t') ?? 0), playing: wanted.get('play') !== '0', speed: 1, live: false, step: 0, last: 0, selected: -1, ground: null, agents: new Map(), changes: [], taus: [],
  terms: null, follows: false, tracesOn: true, symbolsOn: true, dark: false, drawn: 0, sought: wanted.has('t'), shownTime: -1,
};

export const frames = new Map(); // of people, by number

export function readAgents(table) {
  const [head, ...lines] = table.trim().split('\n');
  for (const line of lines) {
    const agent = rowOf(`${head}\n${line}`);
    if (agent) show.agents.set(agent.id, agent);
  }
}

/** Whether the page waits for the ground of the run's place before it draws anything. */
export const lacksGround = () => Boolean(show.run?.place?.houses && !show.ground);

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

export const lastTime = () => Math.max(show.status?.people?.last ?? 0, show.status?.recorded?.last ?? 0, show.status?.depths?.last ?? 0, show.live ? show.time : 0, 0);

export const frameAt = (time) => Math.min(Math.max(0, Math.floor(time * show.status.people.rate + 1e-4)), show.status.people.frames - 1);

// A stream of agents has no poses: places, velocities and outcomes.
export function asPeople(m) {
  const [id, x, z, vx, vz, , state] = m.arrays, zero = new Float32Array(m.count), none = new Float32Array(m.count).fill(-1);
  const speed = vx.map((v, k) => Math.hypot(v, vz[k])), heading = vx.map((v, k) => Math.atan2(vz[k], v));
  const words = Float32Array.from(state, (v) => [0, 2, 3][v] ?? 0);
  return { ...m, arrays: [id, x, z, words, zero, heading, speed, zero, zero, zero, zero, zero, zero, zero, zero, none] };
}

export const stateShown = (p) => (p.state === 'walking' && p.posture === 'lying' ? 'tumbled' : p.state);

export function endedBy(time) {
  const list = [];
  for (const a of show.agents.values()) if (a.outcome !== 'active' && a.time_s <= time) list.push({ id: a.id, x: Math.max(0, a.x_m), z: a.z_m, state: a.outcome });
  return list;
}

export function countStates() {
  const counts = {}, seen = new Set(), all = show.scene?.crowd.groups.reduce((n, g) => n + g.count, 0) ?? show.people.shown.length;
  const add = (state) => (counts[state] = (counts[state] ?? 0) + 1);
  for (const p of show.people.shown) seen.add(p.id), add(stateShown(p));
  // Who has ended is in one more frame; from then on the file says no more of it.
  const ended = new Map();
  for (const [time, id, state] of show.changes) if (time <= show.time + 1e-6 && ['arrived', 'dead', 'sheltered', 'upper_floor'].includes(state)) ended.set(id, state);
  for (const end of endedBy(show.time)) ended.set(end.id, end.state);
  for (const [id, state] of ended) if (!seen.has(id)) add(state);
  const rest_of_all = all - Object.values(counts).reduce((a, b) => a + b, 0);
  if (show.ground && rest_of_all > 0) counts.indoors = (counts.indoors ?? 0) + rest_of_all; // not yet on their way
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
  if (s?.outcome === 'running' && s?.live) return s.live.state;
  return s ? 'ended' : 'waiting';
}

export function start() {
  show.live = isLive() && !show.sought;
  if (!show.sought && !show.live) show.time = 0;
}

export function seek(time) {
  show.live = false;
  show.time = Math.min(Math.max(0, time), lastTime());
}

export function advance(wall) {
  const s = show.status, people = s?.people;
  if (!s) return;
  if (show.live && !isLive()) show.live = false;
  if (show.live) {
    if (people?.frames) { // glide towards the newest frame; once nobody is on its way only the water goes on
      const water = show.water?.time ?? 0, gap = (water > people.last + 5 ? water : people.last) - show.time;
      show.time += gap > 3 || gap < 0 ? gap : gap * Math.min(1, 2.5 * wall);
    }
  } else if (show.playing) {
    show.time += wall * show.speed;
    if (show.time >= lastTime()) {
      show.time = lastTime();
      if (!isLive()) setPlaying(false);
    }
  }
}

export function setPlaying(on) {
  if (on && !show.live && show.time >= lastTime() - 1e-3 && !isLive()) show.time = 0;
  show.playing = on;
  $('play').textContent = on ? 'pause' : 'play';
  $('play').setAttribute('aria-pressed', on);
}

// Keeps the received frames of people and water, and asks for the frames that a time still needs. The page shows a time
// only with people and water of that time, so that a slow server makes pictures rarer, never wrong.

const PEOPLE_BYTES = 96e6, WATER_BYTES = 256e6; // of frames that are kept
const SLOTS = { people: 8, water: 3, depths: 3 }; // open questions at once
const PATIENCE_MS = 5000; // until a question without an answer is asked again
const PICTURES_PER_S = 25; // of a replay: the frames that are asked for ahead of the clock
export const TWEEN_S = 1; // snapshots of water no further apart are interpolated

const weight = (message) => message.bytes ?? 0;

function trim(map, most, keep) {
  let bytes = 0;
  for (const message of map.values()) bytes += weight(message);
  for (const [key, message] of map) {
    if (bytes <= most) return;
    if (keep(message)) continue;
    bytes -= weight(message);
    map.delete(key);
  }
}

export class Buffer {
  constructor() {
    this.people = new Map(); // by number
    this.water = { water: new Map(), depths: new Map(), live: new Map() }; // by number
    this.walkers = new Map(); // by number
    this.asked = { people: new Map(), water: new Map(), depths: new Map() }; // number or time -> when, slot
    this.near = 0; // frames round this time are kept
    this.stretch = 1; // of the steps of a replay while answers come late
    this.calm = 0; // s without a stall
    this.status = null;
  }

  /** After the server has gone its answers are out no more. */
  disconnect() {
    for (const asked of Object.values(this.asked)) asked.clear();
  }

  /** The newest that is known of the run; the last frame of water that grew has a successor now. */
  know(status) {
    const before = this.status;
    this.status = status;
    if ((before?.depths?.frames ?? 0) < (status.depths?.frames ?? 0)) this.forget('depths');
    if ((before?.recorded?.frames ?? 0) < (status.recorded?.frames ?? 0)) this.forget('water');
  }

  forget(kind) {
    for (const [key, message] of this.water[kind]) if (message.lasts === 0) this.water[kind].delete(key);
  }

  takePeople(message) {
    this.people.set(message.frame, message);
    this.asked.people.delete(message.frame);
    const people = this.status?.people;
    if (people?.frames > 1 && message.frame >= people.frames) Object.assign(people, { frames: message.frame + 1, last: message.time });
    trim(this.people, PEOPLE_BYTES, (m) => m === message || Math.abs(m.time - this.near) < 2);
  }

  takeWater(kind, message) {
    this.water[kind].set(message.frame, message);
    for (const t of this.asked[kind]?.keys() ?? []) if (this.covers(message, t)) this.asked[kind].delete(t);
    trim(this.water[kind], WATER_BYTES, (m) => m === message || (kind !== 'live' && this.covers(m, this.near)));
    if (kind === 'live') while (this.water.live.size > 90) this.water.live.delete(this.water.live.keys().next().value);
  }

  takeWalkers(message) {
    this.walkers.set(message.frame, message);
    while (this.walkers.size > 30) this.walkers.delete(this.walkers.keys().next().value);
  }

  /** A frame of a recording that is damaged: the one before stays. */
  damaged(t) {
    const before = [...this.water.water.values()].filter((m) => m.time <= t).pop();
    if (before) this.water.water.set(`damaged at ${t}`, { ...before, bytes: 0, frame: before.frame, time: t, lasts: 1 / 30, shows: before });
    this.asked.water.delete(t);
  }

  covers(message, t) {
    const begins = message.time <= t + 1e-6 || message.frame === this.firstOf(message);
    return begins && (message.lasts === 0 || t + 1e-6 < message.time + message.lasts);
  }

  // Before the first frame of its source the first one stands.
  firstOf(message) {
    return message.kind === 'depths' ? 0 : message.time <= (this.status?.recorded?.first ?? -1) + 1e-6 ? message.frame : NaN;
  }

  /** Where the water of a time comes from: water (a recording), depths (snapshots), or nothing. */
  source(t) {
    const s = this.status;
    if (s?.recorded && t <= s.recorded.last + 0.5) return 'water';
    return s?.depths?.frames ? 'depths' : '';
  }

  /** Water of a time: two frames and how far between them it is, rounded so that it changes ten times a second; or null. */
  waterAt(t) {
    const kind = this.source(t);
    if (!kind) return { none: true };
    const at = (time) => [...this.water[kind].values()].find((m) => this.covers(m, time));
    const before = at(t);
    if (!before) return null;
    if (kind === 'water' || !(before.lasts > 0) || before.lasts > TWEEN_S || t <= before.time) return { kind, before, share: 0 };
    const after = at(before.time + before.lasts), parts = Math.ceil(10 * before.lasts - 1e-6);
    return after && { kind, before, after, share: Math.floor((parts * (t - before.time)) / before.lasts + 1e-6) / parts };
  }

  frameAt(t) {
    const { rate, frames } = this.status.people;
    return Math.min(Math.max(0, Math.floor(t * rate + 1e-4)), frames - 1);
  }

  /** Returns people at a time: two frames and the fraction between them, or null. No people after the last frame. */
  peopleAt(t) {
    const people = this.status?.people;
    if (!people?.frames) return { none: true };
    if (t > people.last + 1 / people.rate + 1e-6) return { before: { count: 0, time: t, arrays: Array.from({ length: 16 }, () => []) }, after: null, share: 0 };
    const k = this.frameAt(t), before = this.people.get(k);
    if (!before) return null;
    if (t - before.time < 1e-3 / people.rate || k + 1 >= people.frames) return { before, after: null, share: 0 };
    // The last frame of a run that ends between two frames comes early.
    const after = this.people.get(k + 1), share = after && Math.min(1, (t - before.time) / (after.time - before.time));
    return after ? { before, after, share } : null;
  }

  has(t) {
    return Boolean(this.peopleAt(t) && this.waterAt(t));
  }

  /** Simulated seconds between two pictures of a replay at a speed: whole frames of people where there are more than can be shown. */
  stepOf(speed) {
    const rate = this.status?.people?.frames ? this.status.people.rate : 30;
    return Math.max(1, Math.round((this.stretch * speed * rate) / PICTURES_PER_S)) / rate;
  }

  /** The time that a replay shows next: as near to a wanted one as there are frames for, never before the present one. */
  reach(from, to, end, speed, wall) {
    const step = this.stepOf(speed), rate = this.status?.people?.frames ? this.status.people.rate : 30, whole = step * rate > 1.5;
    const times = whole && to < end ? [] : [to];
    for (let k = Math.floor(to / step + 1e-6); k * step > from + 1e-6; --k) times.push(k * step);
    const found = times.find((t) => this.has(t));
    if (found !== undefined || times.length === 0) this.calm += wall;
    else this.calm = Math.min(0, this.calm) - wall;
    // Late answers make the steps wider, and a second without makes them narrower.
    if (this.calm < -0.6) [this.stretch, this.calm] = [Math.min(this.stretch * 1.5, 40), 0];
    if (this.calm > 2) [this.stretch, this.calm] = [Math.max(1, this.stretch / 1.25), 0];
    return found ?? from;
  }

  /** Asks for what a time lacks; true if nothing is missing. */
  need(t, stream) {
    const people = this.status?.people, kind = this.source(t);
    let complete = true;
    const ask = (what, key, question) => {
      complete = false;
      const now = performance.now(), asked = this.asked[what];
      for (const [other, one] of asked) if (now - one.now > PATIENCE_MS) asked.delete(other);
      if (asked.has(key) || asked.size >= SLOTS[what]) return;
      const taken = [...asked.values()].map((one) => one.slot), slot = [0, 1, 2, 3, 4, 5, 6, 7].find((k) => !taken.includes(k));
      if (stream.put({ get: what, slot, ...question })) asked.set(key, { now, slot });
    };
    if (people?.frames && !this.peopleAt(t)) {
      const k = this.frameAt(t);
      for (const f of [k, Math.min(k + 1, people.frames - 1)]) if (!this.people.has(f)) ask('people', f, { after: f });
    }
    if (kind && !this.waterAt(t)) {
      const before = [...this.water[kind].values()].find((m) => this.covers(m, t)), at = before ? before.time + before.lasts : t;
      ask(kind, at, { t: at });
    }
    return complete;
  }

  /** Asks for the present and, of a replay, for the second of wall time that comes. */
  needs(t, until, speed, stream) {
    this.near = t;
    this.need(t, stream);
    if (!(until > t)) return;
    const step = this.stepOf(speed), end = Math.min(until, t + Math.max(2 * step, speed));
    for (let k = Math.floor(t / step + 1e-6) + 1, many = 0; (k - 1) * step < end && many < 60; ++k, ++many) this.need(Math.min(until, k * step), stream);
  }

  newestWater() {
    return [...this.water.live.values()].pop() ?? null;
  }

  /** The newest water of a run that goes on, of a time with known people, or null. Where there are no people: the newest. */
  newestLive() {
    const people = this.status?.people, last = people?.frames ? people.last : Infinity;
    return [...this.water.live.values()].filter((m) => m.time <= last + 1e-6).pop() ?? null;
  }

  /** The last time that people and water are known of. The end of a run that goes on has its people before its snapshots. */
  lastTime(isOver) {
    const s = this.status, people = s?.people?.last ?? 0, water = Math.max(s?.recorded?.last ?? 0, s?.depths?.last ?? 0);
    return isOver || !(water > 0 && s?.people?.frames) ? Math.max(people, water) : Math.min(people, water);
  }

  /** The walkers nearest to a time. */
  walkersAt(t) {
    let best = null;
    for (const m of this.walkers.values()) if (!best || Math.abs(m.time - t) <= Math.abs(best.time - t)) best = m;
    return best;
  }
}

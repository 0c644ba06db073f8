// The page: what is asked of the server, what time it shows, and how one looks at it.

import * as THREE from 'three';
import { OrbitControls } from 'three/orbit';
import { GROUP_COLOURS, castShadows, fit, goalsOf, inner, lightUp, lookDown, makeGround, makeSky, place } from './ground.js';
import { $, Symbols, Traces, cycle, fillHelp, makeRing, rowOf, showCounts, showLegend, showTable } from './panel.js';
import { People } from './people.js';
import { Ground, makeSite } from './site.js';
import { Stream, advance, asPeople, buffer, countStates, endedBy, faster, follow, groundAt, groupOf, heightOf, isLive, lacksGround, lastTime, readAgents, rowsOf, seek, setPlaying, show, showTexts, stateShown, tableOf, takeTaus, wanted } from './run.js';
import { Water, boundsOf } from './water.js';

const calm = matchMedia('(prefers-reduced-motion: reduce)').matches; // nothing moves that the user has not started
const plain = wanted.get('quality') === 'low'; // half the pixels along each side, 10 pictures a second, no shadows, no smooth edges
const renderer = new THREE.WebGLRenderer({ antialias: !plain, powerPreference: 'high-performance' });
renderer.shadowMap.enabled = !plain;
renderer.shadowMap.type = THREE.PCFShadowMap;
renderer.toneMapping = THREE.NoToneMapping;
$('view').append(renderer.domElement);
renderer.domElement.tabIndex = 0;
renderer.domElement.setAttribute('role', 'application');
renderer.domElement.setAttribute('aria-label', 'the scene: people, water and ground; keys move the camera, ? lists them');

const stage = new THREE.Scene(), sky = makeSky(false), sun = new THREE.DirectionalLight(), ambient = new THREE.HemisphereLight('#dcebf7', '#8a8065');
stage.add(sky, sun, sun.target, ambient);
const free = new THREE.PerspectiveCamera(46, 1, 0.1, 2000), top = new THREE.OrthographicCamera(-1, 1, 1, -1, 0.1, 2000);
let camera = free;
const controls = new OrbitControls(free, renderer.domElement);
controls.enableDamping = !calm;
controls.dampingFactor = 0.12;
controls.maxPolarAngle = 0.495 * Math.PI;
controls.addEventListener('start', () => (show.isMoved = true));
const topControls = new OrbitControls(top, renderer.domElement);
Object.assign(topControls, { enableRotate: false, enabled: false, screenSpacePanning: true, mouseButtons: { LEFT: THREE.MOUSE.PAN, MIDDLE: THREE.MOUSE.DOLLY, RIGHT: THREE.MOUSE.PAN }, touches: { ONE: THREE.TOUCH.PAN, TWO: THREE.TOUCH.DOLLY_PAN } });
show.symbols = new Symbols(stage);
show.ring = makeRing(stage);

let stream = null, runRevision = '', late = 0, painted = 0, newestAt = 0, awake = 9; // pictures to draw though nothing moves

// ---------------------------------------------------------------- what the server has

const handlers = {
  came: () => (awake = Math.max(awake, 2)), // something else than before
  opened: () => load(),
  closed: () => {
    lose(true);
    buffer.disconnect();
  },
  status: (status) => {
    const first = !show.status;
    show.status = status;
    lose(false);
    buffer.know(status);
    const revision = `${status.outcome} ${status.live?.state}`;
    if (revision !== runRevision && !first) load();
    runRevision = revision;
    if (first && !show.sought) follow();
    takeTaus(status.events ?? '');
  },
  ground: (message) => {
    show.ground = new Ground(message);
    build();
  },
  water: (message) => {
    const isRecorded = message.lasts > 0 || Math.abs(message.time - (show.status?.recorded?.last ?? Infinity)) < 1e-6;
    makeWater(message);
    buffer.takeWater(isRecorded ? 'water' : 'live', message);
  },
  depths: (message) => buffer.takeWater('depths', message),
  people: (message) => buffer.takePeople(message),
  walkers: (message) => buffer.takeWalkers(message),
  paths: (message) => {
    show.traces?.take(message, (id) => (show.groups > 1 ? 1 + (groupOf(id) % GROUP_COLOURS.length) : 0), period());
  },
  text: (answer) => {
    if (answer.terms !== undefined && answer.id === show.selected) show.terms = answer.terms ? rowOf(answer.terms) : null;
    if (answer.course !== undefined) show.course = { id: answer.id, rows: rowsOf(answer.course) };
    if (answer.changes) show.changes.push(...answer.changes);
    if (answer.command !== undefined) $('said').textContent = answer.problem || `sent: ${answer.command}`;
    if (answer.error) console.warn(answer.error);
    if (answer.water !== undefined) buffer.damaged(answer.water);
  },
};

function lose(is) {
  if (is === show.lost) return;
  show.lost = is;
  awake = 6;
  showTexts();
}

async function load() {
  try {
    const run = await (await fetch('/run.json')).json(), manifest = JSON.parse(run.files?.['manifest.json'] || '{}');
    show.run = run;
    show.scene = JSON.parse(run.scene || 'null') ?? manifest.resolved_scene ?? null;
    readAgents(run.files?.['agents.csv'] ?? '');
    build();
  } catch (error) {
    console.warn(`the description of the run cannot be read: ${error.message}`);
  }
}

// ---------------------------------------------------------------- the stage

function build() {
  $('name').textContent = show.scene?.name ? `${show.scene.name}` : show.run.name;
  document.title = `${show.scene?.name ?? show.run.name} \u2013 Wade`;
  if (lacksGround()) return void stream.ask('ground');
  if (show.world || !show.scene) return theme(show.dark);
  const scene = show.scene;
  show.world = show.ground ? makeSite(scene, show.run.site, show.ground) : makeGround(scene);
  stage.add(show.world);
  makeWater(null);
  makePeople();
  frameCamera(scene.world.length_m, scene.world.width_m);
  const groups = $('tau-group');
  groups.replaceChildren(new Option('all', ''), ...scene.crowd.groups.map((g) => new Option(`group ${g.name}`, `group ${g.name}`)), new Option('the person picked', 'agent'));
  $('tau').classList.toggle('on', show.run.commands);
  theme(show.dark);
  if (wanted.get('view') === 'top') look('top');
  if (wanted.has('form')) $('form').value = wanted.get('form');
  if (wanted.has('mode')) $('mode').value = wanted.get('mode');
  setWater();
}

function makeWater(message) {
  if (show.water) return;
  const bounds = show.scene ? null : boundsOf(message);
  if (bounds) frameCamera(bounds.x_max_m, bounds.z_max_m);
  show.water = new Water(stage, show.scene, bounds, show.ground, show.ground ? show.run.site.gates : []);
  theme(show.dark);
  setWater();
}

const period = () => (show.scene?.world.ends === 'periodic' ? show.scene.world.length_m : 0);

function makePeople() {
  if (show.people) return;
  show.groups = show.scene?.crowd.groups.length ?? 1;
  show.people = new People(stage, heightOf, (id) => (show.groups > 1 ? groupOf(id) : -1), groundAt, period());
  show.traces = new Traces(stage, ['#d7261e', ...GROUP_COLOURS], groundAt);
}

function frameCamera(length, width) {
  const centre = place(0.52 * length, groundAt(0.52 * length, 0.47 * width), 0.47 * width), reach = Math.max(0.62 * length, 1.1 * width);
  free.position.copy(centre).add(new THREE.Vector3(-0.42 * reach, 0.42 * reach, 0.72 * reach));
  controls.target.copy(centre);
  const centreOf = (rings) => rings.flat();
  show.corners = [[0, 0], [length, 0], [0, width], [length, width], [length / 2, 0], [length / 2, width]].concat(
    show.scene ? goalsOf(show.scene).filter((g) => show.scene.world.ends !== 'periodic' || (g.x >= 0 && g.x <= length)).map((g) => [g.x, g.z]) : [],
    (show.run?.site?.shelters ?? []).flatMap(({ rings }) => centreOf(rings)),
  ).flatMap(([x, z]) => [0, 2].map((y) => place(x, groundAt(x, z) + y, z)));
  const eye = wanted.get('eye')?.split(',').map(Number); // x, y, z of the eye, then of what it looks at
  if (eye?.length === 6 && eye.every(Number.isFinite)) {
    free.position.copy(place(...eye.slice(0, 3)));
    controls.target.copy(place(...eye.slice(3)));
    show.isMoved = true;
  }
  show.extent = [length, width, show.ground?.high ?? 0];
  const size = Math.max(length, width);
  free.near = Math.min(1, Math.max(0.1, 0.002 * size));
  free.far = Math.max(2000, 8 * size);
  sky.position.copy(centre);
  sky.scale.setScalar(Math.max(1, size / 250));
  castShadows(sun, centre, reach, 0.62 * Math.hypot(length, width));
  resize();
}

function theme(dark) {
  show.dark = dark;
  document.documentElement.classList.toggle('dark', dark);
  const l = lightUp(stage, sky, sun, ambient, dark, Math.max(...(show.extent ?? [0]).slice(0, 2)));
  show.water?.light(l.high, l.low, dark ? 0.55 : 1, l.sunColour);
}

function resize() {
  const wide = innerWidth, high = innerHeight;
  renderer.setPixelRatio(plain ? 0.5 : Math.min(devicePixelRatio, 2));
  renderer.setSize(wide, high);
  free.aspect = wide / high;
  free.fov = wide < high ? 62 : 46;
  free.updateProjectionMatrix();
  const line = $('line').getBoundingClientRect(), part = inner(wide, high, Math.min(0.4 * high, $('title').getBoundingClientRect().bottom), Math.min(0.4 * high, high - line.top));
  lookDown(top, show.extent ?? [100, 50], wide / high, part);
  if (show.corners && !show.isMoved) firstView(part);
}

/** The view that holds the whole world, all goals and all shelters; the direction shows them largest. */
function firstView(part) {
  const middle = show.corners.reduce((sum, p) => sum.add(p), new THREE.Vector3()).divideScalar(show.corners.length);
  const areaOf = () => {
    const [a, b, c, d] = [0, 4, 6, 2].map((k) => show.corners[k].clone().project(free));
    return Math.abs((c.x - a.x) * (d.y - b.y) - (d.x - b.x) * (c.y - a.y));
  };
  const usual = new THREE.Vector3(-0.42, 0.46, 0.72), others = innerWidth < innerHeight ? [new THREE.Vector3(0.8, 0.7, 0.1), new THREE.Vector3(-0.8, 0.7, 0.1)] : [];
  let best = usual, most = -1;
  for (const direction of [usual, ...others]) {
    fit(free, show.corners, direction, part);
    if (areaOf() > 1.15 * most) [best, most] = [direction, areaOf()];
  }
  fit(free, show.corners, best, part);
  // Goals and shelters stand beside the panel at the right, not behind it.
  const panel = $('look').getBoundingClientRect(), isBehind = (p) => {
    const v = p.clone().project(free), x = ((v.x + 1) / 2) * innerWidth, y = ((1 - v.y) / 2) * innerHeight;
    return x > panel.left - 12 && x < panel.right && y > panel.top && y < panel.bottom + 12;
  };
  if (innerWidth > 720 && show.corners.slice(12).some(isBehind)) fit(free, show.corners, best, [part[0], (2 * (panel.left - 12)) / innerWidth - 1, part[2], part[3]]);
  const ahead = new THREE.Vector3();
  free.getWorldDirection(ahead);
  controls.target.copy(free.position).addScaledVector(ahead, ahead.dot(middle.sub(free.position)));
  controls.update();
}

function look(kind) {
  camera = kind === 'top' ? top : free;
  controls.enabled = kind !== 'top';
  topControls.enabled = kind === 'top';
  show.follows = kind === 'follow';
  $('camera').value = kind;
}

function setWater() {
  if (!show.water) return;
  show.water.as($('form').value);
  show.water.setMode($('mode').value);
  newLegend();
}

function newLegend() {
  const water = show.water, legend = water?.legend(), key = legend && `${legend.name} ${legend.full} ${legend.isBeyond} ${water.mode} ${water.hasVelocity}`;
  if (!legend || key === show.legend) return;
  show.legend = key;
  showLegend(legend, water.mode, water.hasVelocity);
}

// ---------------------------------------------------------------- questions

// Asks for what this time needs and is not there.
function askForAll() {
  const s = show.status;
  if (!s || show.lost || !show.run) return;
  if (lacksGround()) return void stream.ask('ground');
  if (show.live && s.live) {
    stream.ask('live', { after: buffer.newestWater()?.frame ?? -1 });
    if (show.pending) buffer.need(show.pending.time, stream);
    // Beyond the last number the server gives the newest frame.
    if (s.people?.frames && performance.now() - newestAt > 80 && stream.put({ get: 'people', slot: 15, after: 1e9 })) newestAt = performance.now();
  } else {
    const from = show.target ?? show.time;
    buffer.needs(from, show.playing ? lastTime() : from, show.speed, stream);
  }
  if (s.walkers && !s.people?.frames) stream.ask('walkers', { after: [...buffer.walkers.keys()].pop() ?? -1 });
  if (s.people?.frames) {
    const until = show.traces?.until ?? 0;
    if (show.tracesOn && show.traces && s.people.last > until + (until < 0 ? 0 : 1) && stream.ask('paths', { t: Math.max(0, until) })) show.traces.until = s.people.last;
  }
  if ((s.changes ?? 0) > show.changes.length) stream.ask('changes', { after: show.changes.length });
  const whose = `${show.selected} ${Math.round(5 * show.time)}`;
  if (show.selected >= 0 && whose !== show.termsOf && stream.ask('terms', { id: show.selected, t: show.time })) show.termsOf = whose;
  const course = `${show.selected} ${isLive() ? Math.floor(lastTime() / 5) : ''}`; // of a run that goes on each 5 s anew
  if (show.selected >= 0 && course !== show.courseOf && stream.ask('course', { id: show.selected })) show.courseOf = course;
}

// ---------------------------------------------------------------- a picture

function drawPeople(step, clock) {
  const s = show.status;
  if (!s) return;
  let { before = null, after = null, share = 0 } = buffer.peopleAt(show.time) ?? {}, poses = s.people?.poses;
  const walkers = s.people?.frames ? null : buffer.walkersAt(show.time);
  if (walkers) {
    before = asPeople(walkers, show.time - walkers.time);
    poses = false;
  }
  if (!before) return;
  makePeople();
  show.peopleTime = walkers ? show.time : before.time + share * (after ? after.time - before.time : 0);
  show.people.update(before, after, share, { states: show.run.states, postures: show.run.postures, poses }, step, clock);
  const counts = countStates();
  showCounts(counts);
  show.symbols.points.visible = show.symbolsOn;
  const marks = show.people.shown.map((p) => ({ x: p.x, y: p.y + (p.posture === 'upright' ? 0.62 * p.height : 0.75), z: p.z, state: stateShown(p) }));
  for (const end of endedBy(show.time)) if (!show.people.shown.some((p) => p.id === end.id)) marks.push({ x: end.x, y: groundAt(end.x, end.z) + 0.3, z: end.z, state: end.state });
  show.symbols.show(marks, camera === top, renderer.getPixelRatio());
}

// The water of the time that is shown.
function drawWater() {
  if (!show.status || !show.water) return;
  const live = show.shownLive?.time === show.time && show.shownLive; // also once it is paused
  const gates = show.water.shutGates(show.time);
  const { kind, before, after, share = 0 } = live ? { kind: 'water', before: live } : buffer.waterAt(show.time) ?? {};
  if (!before) return;
  const key = `${kind} ${before.frame} ${before.time} ${share}`;
  if (key === show.waterKey && !gates) return;
  show.waterKey = key;
  if (kind === 'water') show.water.take(before.shows ?? before);
  else show.water.takeDepths(before, after, share);
  newLegend();
}

function tick(now) {
  const wall = Math.min(0.25, Math.max(0, (now - show.last) / 1000));
  show.last = now;
  const before = show.shownTime;
  advance(wall);
  askForAll();
  drawWater();
  drawPeople(before < 0 ? -1 : show.time - before, show.time);
  show.shownTime = show.time;
  const person = show.people?.shown.find((p) => p.id === show.selected);
  show.ring.visible = Boolean(person);
  if (person) {
    show.ring.position.copy(place(person.x, groundAt(person.x, person.z) + Math.max(0.08, show.water?.grid.at(person.x, person.z) ?? 0), person.z));
    if (show.follows) {
      const to = place(person.x, groundAt(person.x, person.z) + 1, person.z), move = to.clone().sub(controls.target).multiplyScalar(Math.min(1, 4 * wall + (show.drawn < 5 ? 1 : 0)));
      controls.target.add(move);
      free.position.add(move);
    }
  }
  if (controls.update()) awake = Math.max(awake, 2);
  if (show.drawn % 10 === 0 || awake > 0) showTexts();
  tabulate();
  // A picture that would be the one before is not drawn.
  if (--awake <= 0 && !show.live && !show.playing && show.time === before) return;
  if (plain && now - painted < 100) return;
  painted = now;
  paint(now);
}

function paint(now) {
  show.world?.userData.at?.(show.time);
  const clock = !calm && (isLive() || show.playing) ? now / 1000 : show.time; // a time that was sought always looks the same
  for (const star of show.world?.userData.stars ?? []) star.rotation.y = clock / 1.8;
  show.water?.animate(clock, innerHeight * renderer.getPixelRatio() * 0.5);
  if (show.traces) {
    show.traces.uniforms.now.value = show.time;
    show.traces.uniforms.screen.value.set(innerWidth / 2, innerHeight / 2);
    show.traces.uniforms.lift.value = camera === top ? 2.5 : 0.07;
    show.traces.uniforms.faint.value = camera === top ? 0.3 : 1;
    show.traces.uniforms.width.value = camera === top ? 1.1 : 1.6;
    show.traces.mesh.visible = show.tracesOn;
  }
  renderer.render(stage, camera);
  ++show.drawn;
}

/** Draws a time as soon as all that it needs is there, and from then on nothing else; as the address of a PNG. */
async function picture(time) {
  renderer.setAnimationLoop(null);
  clearInterval(late);
  setPlaying(false);
  while (!show.status) await new Promise((done) => setTimeout(done, 20));
  seek(time);
  const asked = ['ground', 'changes', ...(lastTime() > 0 && show.status.people?.frames > 1 ? ['paths'] : [])];
  for (let calm = 0; calm < 3 || !wade.ready(); calm = show.target !== null || asked.some((kind) => stream.waits.has(kind)) ? 0 : calm + 1) {
    askForAll();
    advance(0);
    drawWater();
    if (show.target === null) drawPeople(-1, show.time);
    await new Promise((done) => setTimeout(done, 5));
  }
  drawPeople(show.shownTime < 0 ? -1 : show.time - show.shownTime, show.time);
  show.shownTime = show.time;
  controls.update();
  showTexts();
  paint(0);
  return renderer.domElement.toDataURL();
}

// ---------------------------------------------------------------- hands

// Where a point of the scene is seen, in pixels of the window.
function project(x, y, z) {
  const v = place(x, y, z).project(camera);
  return [((v.x + 1) / 2) * innerWidth, ((1 - v.y) / 2) * innerHeight, v.z];
}
const seenAt = (p) => project(p.x, p.y, p.z);

function pick(event) {
  let best = 28, found = -1;
  for (const p of show.people?.shown ?? []) {
    const [x, y, z] = seenAt(p), d = Math.hypot(x - event.clientX, y - event.clientY);
    if (z < 1 && d < best) [best, found] = [d, p.id];
  }
  select(found);
}

function select(id) {
  show.selected = id;
  show.terms = show.termsOf = null;
  show.traces?.rebuild(id);
  showTexts();
}

function neighbour(way) {
  const ids = (show.people?.shown ?? []).map((p) => p.id).sort((a, b) => a - b);
  if (ids.length) select(ids[(ids.indexOf(show.selected) + way + ids.length) % ids.length]);
}

let down = null;
renderer.domElement.addEventListener('pointerdown', (e) => (down = [e.clientX, e.clientY]));
renderer.domElement.addEventListener('pointerup', (e) => down && Math.hypot(e.clientX - down[0], e.clientY - down[1]) < 5 && e.button === 0 && pick(e));
addEventListener('resize', resize);
for (const name of ['pointerdown', 'keydown', 'input', 'change', 'resize', 'click']) addEventListener(name, () => (awake = 6), true);
const frameStep = (way) => {
  setPlaying(false);
  const rate = show.status?.people?.frames ? show.status.people.rate : 30;
  seek((Math.round((show.target ?? show.time) * rate) + way) / rate);
};
// Turns the camera round what it looks at, rad; moves it, and what it looks at, by a fraction of their distance; comes nearer.
function turn(round, up) {
  const offset = free.position.clone().sub(controls.target), s = new THREE.Spherical().setFromVector3(offset);
  s.theta += round;
  s.phi = Math.min(controls.maxPolarAngle, Math.max(0.05, s.phi - up));
  free.position.copy(controls.target).add(offset.setFromSpherical(s));
  show.isMoved = true;
}
function pan(right, ahead) {
  const used = camera === top ? topControls : controls, reach = camera === top ? (top.top - top.bottom) / top.zoom : free.position.distanceTo(controls.target);
  const x = new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, 0).setY(0).normalize(), z = new THREE.Vector3(0, 1, 0).cross(x);
  const move = x.multiplyScalar(right * reach).addScaledVector(z, ahead * reach);
  camera.position.add(move);
  used.target.add(move);
  show.isMoved ||= camera !== top;
}
function nearer(factor) {
  if (camera === top) return void ((top.zoom = Math.min(50, Math.max(0.5, top.zoom * factor))), top.updateProjectionMatrix());
  free.position.sub(controls.target).divideScalar(factor).add(controls.target);
  show.isMoved = true;
}
function begin() {
  show.isMoved = false;
  top.zoom = 1;
  resize();
}
function help(isOpen) {
  $('help').classList.toggle('open', isOpen);
  $(isOpen ? 'help-close' : 'ask').focus();
}
// The table of people follows the clock, in steps that can be read.
let tabledAt = -Infinity;
function tabulate() {
  const now = performance.now();
  if (!$('people').classList.contains('open') || (now - tabledAt < 2000 && (show.playing || show.live))) return;
  const key = `${show.time} ${show.changes.length} ${show.agents.size}`;
  if (key === show.tabled) return;
  [tabledAt, show.tabled] = [now, key];
  showTable(tableOf(), show.time, select);
}
function table(isOpen) {
  $('people').classList.toggle('open', isOpen);
  show.tabled = '';
  tabledAt = -Infinity;
  tabulate();
  $(isOpen ? 'people-close' : 'people-open').focus();
}
const KEYS = {
  ' ': () => setPlaying(!show.playing), ',': () => frameStep(-1), '.': () => frameStep(1), ArrowLeft: () => frameStep(-1), ArrowRight: () => frameStep(1), '-': () => faster(-1), '+': () => faster(1),
  Home: () => seek(0), End: () => seek(lastTime()), l: follow, w: () => cycle('form'), c: () => cycle('mode'), t: () => look(camera === top ? 'free' : 'top'),
  f: () => look('follow'), n: () => neighbour(1), p: () => neighbour(-1), r: () => (show.tracesOn = !show.tracesOn), s: () => (show.symbolsOn = !show.symbolsOn),
  d: () => theme(!show.dark), '?': () => help(!$('help').classList.contains('open')), i: () => table(!$('people').classList.contains('open')),
  Escape: () => ($('help').classList.contains('open') ? help(false) : $('people').classList.contains('open') ? table(false) : select(-1)),
  'Shift+ArrowLeft': () => turn(-0.1, 0), 'Shift+ArrowRight': () => turn(0.1, 0), 'Shift+ArrowUp': () => turn(0, 0.07), 'Shift+ArrowDown': () => turn(0, -0.07),
  ArrowUp: () => pan(0, 0.05), ArrowDown: () => pan(0, -0.05), '[': () => pan(-0.05, 0), ']': () => pan(0.05, 0), PageUp: () => nearer(1.15), PageDown: () => nearer(1 / 1.15), 0: begin,
};
addEventListener('keydown', (event) => {
  if (['SELECT', 'INPUT'].includes(event.target.tagName) && !['?', 'Escape'].includes(event.key)) return;
  if (event.target.tagName === 'BUTTON' && [' ', 'Enter'].includes(event.key)) return; // they press it
  if (event.target.closest('#people') && /^(Arrow|Page|Home|End)/.test(event.key)) return; // they scroll it
  const key = event.shiftKey && event.key.startsWith('Arrow') ? `Shift+${event.key}` : event.key;
  if (event.ctrlKey || event.metaKey || event.altKey || !KEYS[key]) return;
  event.preventDefault();
  KEYS[key]();
});
const on = (id, name, does) => $(id).addEventListener(name, does);
on('play', 'click', () => (show.live ? (show.live = false, setPlaying(false)) : setPlaying(!show.playing)));
on('back', 'click', () => frameStep(-1));
on('on', 'click', () => frameStep(1));
on('live', 'click', follow);
on('theme', 'click', () => theme(!show.dark));
on('ask', 'click', KEYS['?']);
on('help-close', 'click', KEYS['?']);
on('people-open', 'click', () => table(true));
on('people-close', 'click', () => table(false));
on('more', 'click', () => $('look').classList.toggle('open'));
on('time', 'input', () => seek(+$('time').value));
on('speed', 'change', () => (show.speed = +$('speed').value));
on('form', 'change', setWater);
on('mode', 'change', setWater);
on('camera', 'change', () => (show.selected < 0 && $('camera').value === 'follow' && neighbour(1), look($('camera').value)));
on('tau-value', 'input', () => ($('tau-shown').textContent = (+$('tau-value').value).toFixed(2)));
on('tau-set', 'click', () => {
  const whose = $('tau-group').value === 'agent' ? `agent ${show.selected}` : $('tau-group').value;
  stream.command(`tau ${$('tau-value').value} ${whose}`.trim());
});
on('run-pause', 'click', () => stream.command(show.status?.live?.state === 'paused' ? 'resume' : 'pause'));
on('run-step', 'click', () => stream.command('step'));

/** For tests and for scripts that drive the page. */
window.wade = {
  show, project, select, look, camera: () => camera, eye: () => free.position.toArray(), theme, setPlaying, stream: () => stream,
  seek: (time) => (seek(time), (awake = 6)),
  picture, paint: () => paint(0),
  counts: () => show.counts ?? {},
  placeOf: (id) => seenAt(show.people.shown.find((p) => p.id === id)),
  ready: () => Boolean((show.peopleTime !== undefined || show.status?.people?.frames === 0 || show.ground) && show.water?.time !== undefined),
  at: () => ({ time: show.time, people: show.people?.count ?? 0, peopleTime: show.peopleTime, water: show.water?.time, target: show.target, particles: show.water?.message?.count ?? 0 }),
  cost: () => ({ calls: renderer.info.render.calls, triangles: renderer.info.render.triangles, bytes: (show.water?.bytes ?? 0) + (show.people?.bytes ?? 0), received: stream.bytes, drawn: show.drawn }),
};

fillHelp();
if (calm && !wanted.has('play')) show.playing = false;
theme(wanted.has('dark') ? wanted.get('dark') === '1' : matchMedia('(prefers-color-scheme: dark)').matches);
setPlaying(show.playing);
resize();
stream = new Stream(handlers);
if (!wanted.has('still')) renderer.setAnimationLoop(tick); // else for wade.picture() alone
// Some browsers hold frames back for seconds where they draw by software; the page answers none the less.
// The server speaks twice a second.
setInterval(() => !document.hidden && show.status && performance.now() - stream.heard > 3000 && lose(true), 500);
late = setInterval(() => !wanted.has('still') && !document.hidden && performance.now() - show.last > 250 && tick(performance.now()), 100);

// Tests the viewer's page in Debian's chromium with software rendering: an ended run, a live run and a recording.
// node view_page.mjs MODULES PICTURES; PICTURES, a folder or -, adds the long tests. JSON on stdin: addresses of pages (ended,
// recorded, site), contents of outcome.json with its folder (wanted), and two runs with waiting crowds (running): page,
// process of the server, folder, and command of the water.

import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import { legible, opened } from './view_browser.mjs';

const [modules, folder] = process.argv.slice(2), pictures = folder === '-' ? '' : folder;
const { ended, recorded, site, running, wanted } = JSON.parse(fs.readFileSync(0));
const { browser, open, patient, problems } = await opened(modules), waters = []; // processes

const picture = (page, name) => page.screenshot({ path: path.join(pictures, `${name}.png`) });
const wantedPicture = async (page, name) => pictures && picture(page, name); // each waits for some frames
// Clicks on an element at once; the click of playwright waits until the element has stopped moving.
const click = (page, id) => page.evaluate((what) => document.querySelector(what).click(), id);

// Sets the size of the window and waits until the page has taken it.
const resize = async (page, width, height) => {
  await page.setViewportSize({ width, height });
  await page.waitForFunction(([wide, high]) => innerWidth === wide && innerHeight === high && document.querySelector('#view canvas').clientWidth === wide, [width, height], patient);
};

// Returns the root mean square of the second differences of the drawn surface along both axes, m.
const roughness = (page) => page.evaluate(() => {
  const { grid, rowLength, surface } = wade.show.water, { nx, nz } = grid, y = surface.geometry.attributes.position.array;
  const height = (i, j) => y[3 * (j * rowLength + rowLength - nx + i) + 1];
  let sum = 0, count = 0;
  for (let j = 1; j + 1 < nz; ++j)
    for (let i = 1; i + 1 < nx; ++i, count += 2)
      sum += (height(i - 1, j) - 2 * height(i, j) + height(i + 1, j)) ** 2 + (height(i, j - 1) - 2 * height(i, j) + height(i, j + 1)) ** 2;
  return Math.sqrt(sum / count);
});
// Largest roughness of a surface of particles, m: a tenth of their spacing of 0.5 m. Heights of particles in a flat river differ by a
// few hundredths of the spacing.
const smooth = 0.05;

// Records the times of people, water and clock and the positions of people of each picture, up to the end or for `many` pictures.
const watch = async ({ speed, from, end, many = Infinity }) => {
  const seen = [];
  if (speed) {
    wade.setPlaying(false);
    wade.seek(from);
    while (wade.at().target !== null) await new Promise((done) => setTimeout(done, 20));
    wade.show.speed = speed;
    wade.setPlaying(true);
  }
  const note = () => {
    const at = wade.at();
    if (seen.at(-1)?.time !== at.time) seen.push({ ...at, places: wade.show.people.shown.map(({ id, x, z }) => [id, x, z]) });
  };
  note();
  let shown = wade.show.shownTime; // the page sets it after each picture
  Object.defineProperty(wade.show, 'shownTime', { configurable: true, get: () => shown, set: (time) => ((shown = time), note()) });
  while (seen.length < many && (!speed || wade.at().time < end - 1e-6)) await new Promise((done) => setTimeout(done, 20));
  Object.defineProperty(wade.show, 'shownTime', { configurable: true, writable: true, value: shown });
  return seen;
};
const furthest = (seen, of) => seen.reduce((most, at) => Math.max(most, Math.abs(of(at))), 0);
const told = (seen) => `${seen.length} pictures, people ${furthest(seen, (at) => at.time - at.peopleTime).toFixed(3)} s, water ${furthest(seen, (at) => at.time - at.water).toFixed(3)} s from the clock`;
// Checks that people, water and clock of all pictures are of one time. Poses come each 0.1 s. Motion needs three pictures: a step takes
// at most 0.25 s of wall time, so that 8 s at 16 x have one between their ends. apart: limit between water and clock, s; the surface
// of snapshots changes ten times a second.
function together(seen, what, apart = 0.1) {
  assert.ok(seen.length >= 3, `${what}: ${seen.length} pictures`);
  for (const at of seen) {
    assert.ok(Math.abs(at.peopleTime - at.time) < 1e-3, `${what}: people of ${at.peopleTime} s at ${at.time} s`);
    assert.ok(Math.abs(at.water - at.time) < apart + 1e-6, `${what}: water of ${at.water} s at ${at.time} s`);
  }
}
// Checks that the people of each picture are all those of poses.csv at the time of the clock and no others, that positions equal the
// interpolation between two rows, and that people move. A row holds until the next frame less 0.0001 frames for rounding, as in the
// page. Rows are rounded to millimetres, positions of the page to floats. period: length of a periodic world, m.
function walking(seen, file, period, what) {
  const [head, ...lines] = fs.readFileSync(file, 'utf8').trim().split('\n').map((line) => line.split(',')), frames = [];
  const [number, t, id, x, z] = ['frame', 'time_s', 'id', 'x_m', 'z_m'].map((name) => head.indexOf(name));
  for (const row of lines) (frames[row[number]] ??= { time: +row[t], people: new Map() }).people.set(+row[id], [+row[x], +row[z]]);
  const near = (d) => d - period * Math.round(d / period);
  let most = 0, moved = 0;
  for (const { time, places } of seen) {
    const k = Math.floor(10 * time + 1e-4), before = frames[k], after = frames[k + 1], there = before ? [...before.people.keys()] : [];
    assert.deepEqual(places.map(([who]) => who).sort((a, b) => a - b), there, `${what}: people at ${time} s`);
    assert.ok(there.length > 0, `${what}: no people at ${time} s`);
    const share = after ? Math.max(0, (time - before.time) / (after.time - before.time)) : 0;
    for (const [who, px, pz] of places) {
      const a = before.people.get(who), b = after?.people.get(who) ?? a;
      most = Math.max(most, Math.abs(near(a[0] + share * near(b[0] - a[0]) - px)), Math.abs(a[1] + share * (b[1] - a[1]) - pz));
    }
  }
  for (const [who, px, pz] of seen[0].places) for (const [other, x2, z2] of seen.at(-1).places) if (who === other) moved = Math.max(moved, Math.hypot(near(x2 - px), z2 - pz));
  console.log(`${what}: people at most ${(1000 * most).toFixed(1)} mm from their file, moved by up to ${moved.toFixed(1)} m`);
  assert.ok(most < 0.003 && moved > 0.1, `${what}: people ${most} m from poses.csv, moved by ${moved} m`);
}
// Returns the people, goals and corners of shelters of the first view that a panel covers.
const covered = (page, goals) => page.evaluate((goals) => {
  const { show } = wade, canvas = document.querySelector('#view canvas'), height = (x, z) => show.ground?.at(x, z) ?? 0;
  const places = [...goals, ...(show.run.site?.shelters ?? []).flatMap((s) => s.rings.flat()), ...show.people.shown.map((p) => [p.x, p.z])];
  return places.map(([x, z]) => wade.project(x, height(x, z), z)).filter(([x, y]) => document.elementFromPoint(x, y) !== canvas).length;
}, goals);

try {
  // Ended run: the last picture has the counts of outcome.json.
  let page = await open(ended, 'play=0&t=2&dark=0&quality=low', { width: 560, height: 360 });
  assert.equal(await page.textContent('#state'), 'ended');
  const first = await page.screenshot();
  await page.evaluate((end) => wade.seek(end), wanted.end);
  await page.waitForFunction((want) => (wade.counts().arrived ?? 0) === want.arrived && (wade.counts().dead ?? 0) === want.dead, wanted, patient);
  assert.equal(await page.getAttribute('#counts [data-state=arrived]', 'data-count').catch(() => '0'), String(wanted.arrived));
  const last = await page.screenshot();
  assert.notDeepEqual(first, last, 'the picture changes with the time');

  // axe-core finds no violation, with and without the help and the panel of a person; live regions change rarely.
  const axe = fs.readFileSync(path.join(modules, 'node_modules', 'axe-core', 'axe.min.js'), 'utf8');
  const audit = async (what) => {
    await page.evaluate((code) => window.axe ?? (0, eval)(code), axe);
    const found = await page.evaluate(async () => (await axe.run()).violations.map((v) => `${v.id}: ${v.nodes.map((node) => node.target).join(' ')}`));
    assert.deepEqual(found, [], `axe-core, ${what}`);
  };
  await audit('page');
  await page.evaluate(() => wade.select(wade.show.people.shown[0]?.id ?? 0));
  await page.keyboard.press('?');
  assert.equal(await page.evaluate(() => document.activeElement.id), 'help-close');
  await audit('help and a person');
  await page.keyboard.press('Escape');
  await page.keyboard.press('Escape');
  // The table of people has the counts of outcome.json; the keyboard selects the first person.
  await page.keyboard.press('i');
  const states = await page.evaluate(() => [...document.querySelectorAll('#rows tr')].map((row) => row.cells[2].textContent));
  assert.equal(states.length, 6);
  for (const state of ['arrived', 'dead']) assert.equal(states.filter((one) => one === state).length, wanted[state]);
  await audit('table of people');
  await page.keyboard.press('Tab');
  await page.keyboard.press('Enter');
  assert.match(await page.textContent('#who'), new RegExp(`^person ${await page.textContent('#rows tr th')}\\D`));
  await page.keyboard.press('Escape');
  await page.keyboard.press('Escape');
  const live_changes = await page.evaluate(async (end) => {
    let changes = 0;
    const watcher = new MutationObserver(() => ++changes), began = performance.now();
    for (const region of document.querySelectorAll('[aria-live], [role=status], [role=alert], [role=log], output')) watcher.observe(region, { childList: true, characterData: true, subtree: true });
    wade.seek(0);
    wade.show.speed = 4;
    wade.setPlaying(true);
    while (wade.at().time < end - 1e-6) await new Promise((done) => setTimeout(done, 20));
    wade.setPlaying(false); // else the clock goes on from where a later step sets it
    return changes / Math.max(1, Math.ceil((performance.now() - began) / 5000));
  }, wanted.end);
  assert.ok(live_changes <= 1, `live regions change ${live_changes} times in 5 s`);

  // Keys move the camera; 0 restores the first view, which contains all people and goals at three sizes.
  const eye = () => page.evaluate(() => wade.eye().map((v) => +v.toFixed(6)));
  for (const [width, height] of [[1280, 720], [800, 600], [400, 800]]) {
    await resize(page, width, height);
    await page.keyboard.press('0');
    await page.waitForFunction(() => wade.at().target === null, null, patient);
    assert.equal(await covered(page, [[14, 12]]), 0, `people and goals outside of the first view at ${width} x ${height}`);
  }
  const begun = await eye();
  for (const key of ['Shift+ArrowLeft', 'Shift+ArrowUp', 'ArrowUp', ']', 'PageUp']) {
    const before = await eye();
    await page.keyboard.press(key);
    assert.notDeepEqual(await eye(), before, `${key} moves the camera`);
  }
  await page.keyboard.press('0');
  assert.deepEqual(await eye(), begun);
  await resize(page, 560, 360);

  // Time slider by mouse; a click on a person shows the terms of its equations.
  await page.fill('#time', '3');
  await page.waitForFunction(() => Math.abs(wade.at().time - 3) < 0.02 && Math.abs(wade.at().water - 3) <= 0.5, null, patient);
  await page.waitForFunction(() => wade.at().people === 6, null, patient);
  const [x, y] = await page.evaluate(() => wade.placeOf(wade.show.people.shown[2].id));
  await page.mouse.click(x, y);
  await page.waitForSelector('#who.open');
  await page.waitForFunction(() => /Eq. 9/.test(document.querySelector('#who').textContent), null, patient);
  assert.match(await page.textContent('#who'), /tau .*0\.20/);
  await page.waitForFunction(() => /tau to 0.2 ,.*m\/s from/.test(document.querySelector('#who .course')?.ariaLabel), null, patient);

  // Keys: next frame, water as points and as a surface, help, dark colours, view from above.
  const time = await page.evaluate(() => wade.at().time);
  await page.locator('#view canvas').press('.');
  await page.waitForFunction((t) => wade.at().time > t + 0.05, time, patient);
  await page.keyboard.press('?');
  assert.equal(await page.isVisible('#help'), true);
  await page.keyboard.press('Escape');
  await page.keyboard.press('t');
  await page.keyboard.press('d');
  await page.keyboard.press('c');
  assert.match(await page.textContent('#legend'), /depth of the water, m/);
  await page.waitForTimeout(100);
  await wantedPicture(page, 'above');
  await resize(page, 400, 360);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 400, `the page is ${wide} wide at 400`);
  await wantedPicture(page, 'narrow');

  // Three linked people of different heights: palms of neighbours meet.
  const apart = await page.evaluate(() => {
    const { show } = wade, heading = 0.7, c = Math.cos(heading), s = Math.sin(heading), heights = [0, 1, 2].map((id) => show.people.heights(id));
    const arrays = Array.from({ length: 16 }, (_, f) => [0, 1, 2].map((k) => [k, 5 + 0.6 * k * s, 5 - 0.6 * k * c, 0, 0, heading][f] ?? (f === 9 ? 0.9 : f === 15 ? [1, 2, -1][k] : 0)));
    show.people.update({ count: 3, arrays, time: 3 }, null, 0, { states: ['standing'], postures: ['upright'], poses: true }, -1, 0);
    const { iArms, iBody } = show.people.arrays;
    const palm = (k, right) => {
      const at = 4 * k + (right ? 1 : 0), arm = 0.385 * heights[k], side = (right ? 1 : -1) * (0.108 * heights[k] + arm * Math.sin(iBody[at]));
      const ahead = arm * Math.sin(iArms[at]) * Math.cos(iBody[at]);
      return [arrays[1][k] + ahead * c + side * s, arrays[2][k] + ahead * s - side * c];
    };
    return [0, 1].map((k) => Math.hypot(...[0, 1].map((axis) => palm(k, true)[axis] - palm(k + 1, false)[axis])));
  });
  assert.ok(apart.every((d) => d < 0.01), `hands that hold are ${apart} m apart`);

  // States: of the list, not told by the files, and not in the list. The legend names the last.
  const words = await page.evaluate(() => {
    const arrays = Array.from({ length: 16 }, (_, f) => [0, 1, 2, 3].map((k) => (f === 0 ? k : f === 3 ? [0, -1, -2, 99][k] : 0)));
    wade.show.people.update({ count: 4, arrays, time: 3 }, null, 0, { states: ['standing'], postures: ['upright'], poses: true }, -1, 0);
    return wade.show.people.shown.map((p) => p.state);
  });
  assert.deepEqual(words, ['standing', 'active', 'unknown', 'unknown']);
  assert.match(await page.textContent('#symbols'), /state unknown/);

  if (folder) { // A hundred thousand particles and five thousand figures: what goes to the graphics card a picture.
    const cost = await page.evaluate(() => {
      const n = 100000, m = 5000, { show } = wade, fill = (count, of) => Float32Array.from({ length: count }, (_, k) => of((k * 0.618034) % 1, k));
      show.water.as('points');
      show.water.take({ count: n, stride: 1, time: 3, frame: 90, arrays: [fill(n, (r) => 20 * r), fill(n, (r) => r), fill(n, (r, k) => 3 + (k % 400) / 100), ...[1, 2, 3].map(() => fill(n, (r) => r)), fill(n, () => 0.001)] });
      const arrays = Array.from({ length: 16 }, (_, f) => fill(m, (r, k) => [k, 20 * r, k % 10][f] ?? (f === 9 ? 0.9 : f === 15 ? -1 : 0)));
      show.people.update({ count: m, arrays, time: 3 }, null, 0, { states: ['walking'], postures: ['upright'], poses: true }, -1, 0);
      const began = performance.now();
      wade.paint();
      return { ...wade.cost(), figures: show.people.count, ms: performance.now() - began };
    });
    console.log(`100,000 particles, ${cost.figures} figures: ${cost.calls} draw calls, ${cost.triangles} triangles, ${cost.bytes} bytes`);
    // Limits of bytes and draw calls per picture: 2 ms at 1 GB/s and 0.4 ms at 10 us per call, of 33 ms (30 pictures per second).
    assert.ok(cost.figures === 5000 && cost.calls < 40 && cost.bytes < 2.2e6 && cost.triangles < 4e6, JSON.stringify(cost));
  }
  await page.close();

  // Phone: the first view contains all people, goals and shelters of a site; panels cover at most 40 % of it.
  const phone = { isMobile: true, hasTouch: true, deviceScaleFactor: 2, reducedMotion: 'reduce' };
  page = await open(site, 't=20&dark=0&quality=low', { width: 360, height: 740 }, null, phone);
  await page.waitForFunction(() => wade.at().target === null && wade.at().people > 0, null, patient);
  // Reduced motion: the page starts no motion by itself.
  assert.equal(await page.evaluate(() => wade.show.playing), false);
  const drawn = await page.evaluate(async () => {
    const frames = async (n) => { for (; n > 0; --n) await new Promise(requestAnimationFrame); };
    await frames(12); // until all has come
    const before = [wade.cost().drawn, wade.at().time];
    await frames(12);
    return [before, [wade.cost().drawn, wade.at().time], document.getAnimations().length];
  });
  assert.deepEqual(drawn, [drawn[0], drawn[0], 0]);
  for (const [width, height] of [[360, 740], [740, 360]]) {
    await resize(page, width, height);
    assert.equal(await covered(page, []), 0, `people and shelters outside of the first view at ${width} x ${height}`);
    const free = await page.evaluate(() => {
      const canvas = document.querySelector('#view canvas');
      let seen = 0;
      for (let k = 0; k < 400; ++k) seen += document.elementFromPoint((innerWidth * ((k % 20) + 0.5)) / 20, (innerHeight * (Math.floor(k / 20) + 0.5)) / 20) === canvas;
      return seen / 400;
    });
    assert.ok(free > 0.6, `panels cover ${1 - free} of ${width} x ${height}`);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
    await wantedPicture(page, `phone_${width}`);
  }
  // View from above: the mark of each person is at least 5 pixels wide at any pixel density.
  const marks = await page.evaluate(() => {
    const { show } = wade, n = 500, c = new OffscreenCanvas(1, 1).getContext('2d', { willReadFrequently: true }), canvas = document.querySelector('#view canvas');
    wade.look('top');
    show.tracesOn = false;
    const list = Array.from({ length: n }, (_, k) => ({ x: 4 + 8 * (k % 25), y: show.ground.high + 1, z: 4 + 6.6 * Math.floor(k / 25), state: 'walking' }));
    const pixels = (marked) => {
      show.symbols.show(marked, true, canvas.width / innerWidth);
      wade.paint();
      Object.assign(c.canvas, { width: canvas.width, height: canvas.height });
      c.drawImage(canvas, 0, 0);
      return c.getImageData(0, 0, canvas.width, canvas.height).data;
    };
    const without = pixels([]), marked = pixels(list);
    let changed = 0;
    for (let k = 0; k < without.length; k += 4) changed += without[k] !== marked[k] || without[k + 1] !== marked[k + 1];
    const [x] = wade.project(4, 0, 4), [next] = wade.project(12, 0, 4);
    return { wide: Math.sqrt((changed / n) * (4 / Math.PI)) / (canvas.width / innerWidth), apart: next - x };
  });
  assert.ok(marks.wide >= 5 || marks.wide > 0.9 * marks.apart, `marks of people from above: ${JSON.stringify(marks)}`);
  await page.close();

  // People, water and clock of each picture are of one time at any speed: recording, snapshots, and a server with 200 ms of delay.
  const late = { ms: 0, mute: false };
  const play = async (kind) => {
    for (late.ms of [0, 200])
      for (const [speed, from] of [[1, wanted.end - 1.5], [4, wanted.end - 4], [16, 0]]) {
        const seen = await page.evaluate(watch, { speed, from, end: wanted.end }), what = `${kind}, ${late.ms} ms late, ${speed} x`;
        console.log(`${what}: ${told(seen)}`);
        together(seen, what);
        walking(seen, path.join(wanted.folder, 'poses.csv'), 1e9, what);
      }
    late.ms = 0;
  };
  page = await open(recorded, 'play=0&t=0&dark=0&quality=low', { width: 320, height: 240 }, late);
  await play('a recording');

  // The page reports a silent server by itself.
  late.mute = true;
  await page.waitForFunction(() => document.querySelector('#state').textContent === 'no server', null, patient);
  late.mute = false;
  await page.waitForFunction(() => document.querySelector('#state').textContent === 'ended', null, patient);

  // Recording as a surface: smooth, and at most 8 of 255 levels on average from the picture of the snapshot. Ripples, which follow the
  // velocity, differ between the two; foam on spikes gives 60 levels.
  await resize(page, 560, 360);
  const particles = await page.evaluate(() => wade.picture(4));
  assert.equal(await page.evaluate(() => wade.at().particles), 640);
  const rough = await roughness(page);
  // Colours equal the legend within 3 %; 8 bits of a colour resolve about 1 %.
  for (const camera of ['free', 'top']) await legible(page, { modes: ['depth', 'speed'], camera, time: 4 });
  await page.close();
  page = await open(ended, 'play=0&t=0&dark=0&quality=low', { width: 320, height: 240 }, late);
  await play('snapshots');
  await resize(page, 560, 360);
  const apartOf = await page.evaluate(async (particles) => {
    const pixels = async (address) => {
      const image = await createImageBitmap(await (await fetch(address)).blob()), canvas = new OffscreenCanvas(image.width, image.height), c = canvas.getContext('2d');
      c.drawImage(image, 0, 0);
      return c.getImageData(0, 0, image.width, image.height).data;
    };
    const one = await pixels(particles), other = await pixels(await wade.picture(4));
    return one.reduce((sum, v, k) => sum + Math.abs(v - other[k]), 0) / one.length;
  }, particles);
  const reference = await roughness(page);
  // Without velocities the mode for speeds is off, with its reason.
  assert.equal(await page.evaluate(() => document.querySelector('#mode [value=speed]').disabled), true);
  await page.keyboard.press('c');
  assert.equal(await page.inputValue('#mode'), 'depth');
  await page.keyboard.press('c');
  assert.equal(await page.inputValue('#mode'), 'clear');
  assert.match(await page.textContent('#mode'), /speed: not recorded/);
  // Water behind a closed gate: all triangles lie on one side of the gate and reach it.
  const behind = await page.evaluate(async () => {
    const { Water } = await import('/water.js'), three = await import('three'), line = [[10.2, -1], [12.7, 13]];
    const scene = { channel: { flow: 'closed', x_min_m: 0, x_max_m: 20, z_min_m: 0, z_max_m: 12 }, fluid: { shallow_water: { cell_size_m: 1 } }, world: {} };
    const water = new Water(new three.Group(), scene, null, { at: (x) => -0.1 * x }, [{ opens_at: 5, line }]);
    const beyond = (x, z) => ((line[1][0] - line[0][0]) * (z - line[0][1]) - (line[1][1] - line[0][1]) * (x - line[0][0])) / Math.hypot(2.5, 14);
    const depths = Float32Array.from({ length: 240 }, (_, k) => (beyond((k % 20) + 0.5, Math.floor(k / 20) + 0.5) > 0 ? 2 : 0)).map((d, k) => d && 2 + 0.1 * (k % 20));
    return [0, 6].map((time) => {
      water.shutGates(time);
      water.takeDepths({ kind: 'depths', count: 240, columns: 20, cell: 1, x0: 0, z0: 0, time, arrays: [depths] });
      const { index, attributes: { position: p, state } } = water.surface.geometry;
      const sides = [];
      for (let k = 0; k < index.count; k += 3) {
        const corners = [0, 1, 2].map((m) => index.getX(k + m));
        if (corners.every((v) => v < 240) && corners.some((v) => state.getX(v) > 1)) sides.push(...corners.map((v) => [beyond(p.getX(v), -p.getZ(v)), p.getY(v)]));
      }
      return { nearest: Math.min(...sides.map(([d]) => d)), lowest: Math.min(...sides.map(([, y]) => y)) };
    });
  });
  assert.ok(Math.abs(behind[0].nearest) < 1e-4 && behind[0].lowest > 0.5, `water past a closed gate: ${JSON.stringify(behind)}`);
  assert.ok(behind[1].nearest < -0.3, `water held by an open gate: ${JSON.stringify(behind)}`);
  console.log(`roughness of the surface: particles ${rough.toFixed(4)} m, depths ${reference.toFixed(4)} m; pictures ${apartOf.toFixed(1)} levels apart`);
  assert.ok(rough < smooth + reference, `the surface of a recording is rough: ${rough} m, of its depths ${reference} m`);
  assert.ok(apartOf < 8, `the pictures of particles and depths are ${apartOf} levels apart`);
  await page.close();

  // Live run, at full speed and in real time: particles arrive, time advances, tau changes, the run pauses.
  for (const clock of ['fast', 'real_time']) {
    const { address, folder, water } = running[clock];
    waters.push(spawn(water[0], water.slice(1), { stdio: 'ignore' }));
    page = await open(address, 'dark=1&form=points&quality=low', { width: 740, height: 240 }, late);
    await page.waitForFunction(() => wade.at().particles === 640 && document.querySelector('#state').textContent === 'running', null, patient);
    for (late.ms of [0, 200]) {
      const seen = await page.evaluate(watch, { many: 8 }), what = `live, clock ${clock}, ${late.ms} ms late`;
      console.log(`${what}: ${told(seen)}`);
      together(seen, what, 0);
      walking(seen, path.join(folder, 'poses.csv'), 20, what);
    }
    late.ms = 0;
    if (clock === 'fast') {
      waters.pop().kill('SIGKILL');
      await page.close();
    }
  }
  // A paused picture and the picture of the last known time are of one time, too.
  const held = await page.evaluate(async () => {
    const frames = async (n) => { for (; n > 0; --n) await new Promise(requestAnimationFrame); };
    document.querySelector('#play').click();
    await frames(5);
    const paused = wade.at();
    wade.seek(Infinity);
    while (wade.at().target !== null) await frames(1);
    await frames(2);
    return [paused, wade.at()];
  });
  for (const [k, at] of held.entries()) {
    assert.ok(Math.abs(at.peopleTime - at.time) < 1e-3 && Math.abs(at.water - at.time) < 0.1 * k + 1e-6, `a live run, paused or at its last known time: ${JSON.stringify(at)}`);
  }
  await click(page, '#live');
  const then = await page.evaluate(() => wade.at());
  await page.waitForFunction((t) => wade.at().time > t.time && wade.at().water > t.water, then, patient);
  await page.selectOption('#form', 'surface');
  await page.waitForFunction((t) => wade.at().water > t.water, await page.evaluate(() => wade.at()), patient);
  assert.ok((await roughness(page)) < smooth + reference, 'the surface of a run that goes on is smooth');
  await page.fill('#tau-value', '0.9');
  await page.selectOption('#tau-group', 'group walkers');
  await click(page, '#tau-set');
  await page.waitForFunction(() => wade.show.taus.length === 1, null, patient);
  await click(page, '#run-pause');
  await page.waitForFunction(() => document.querySelector('#state').textContent === 'paused', null, patient);
  await wantedPicture(page, 'live');
  await click(page, '#run-pause');
  await page.waitForFunction(() => document.querySelector('#state').textContent === 'running', null, patient);

  // The page reports killed water, and then a killed server, by itself.
  waters[0].kill('SIGKILL');
  await page.waitForFunction(() => document.querySelector('#state').textContent === 'killed', null, patient);
  assert.deepEqual(problems, []);
  process.kill(running.real_time.server, 'SIGKILL');
  await page.waitForFunction(() => document.querySelector('#state').textContent === 'no server', null, patient);
} finally {
  for (const water of waters) water.kill('SIGKILL');
  await browser.close();
}

// What the tests of the viewer's page share: Debian's chromium, drawn by software, and the colours of water read back to values.

import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import path from 'node:path';

const SLACK = 0.03; // of the scale; 8 bits of a colour resolve about 1 %

/** The browser, a function that opens a page, how long to wait, and the list of problems that the pages have told. */
export async function opened(modules) {
  const { chromium } = createRequire(path.join(modules, 'x'))('playwright-core');
  const browser = await chromium.launch({
    executablePath: '/usr/bin/chromium', args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  });
  const patient = { timeout: 120000, polling: 100 }; // a net for busy machines; nothing here measures time
  const problems = [];
  // late: ms, the delay of the server's messages, and mute, that none come; both may change. context: more options of the page.
  const open = async (address, hash, viewport, late = null, context = {}) => {
    const page = await browser.newPage({ viewport, bypassCSP: true, ...context });
    if (late) await page.routeWebSocket(/stream$/, (socket) => socket.connectToServer().onMessage((m) => late.mute || setTimeout(() => socket.send(m), late.ms)));
    page.on('console', (message) => ['error', 'warning'].includes(message.type()) && !/GPU stall|ReadPixels/.test(message.text()) && problems.push(message.text()));
    page.on('pageerror', (error) => problems.push(error.message));
    page.on('requestfailed', (request) => !request.url().includes('?key=') && problems.push(`failed: ${request.url()}`));
    page.on('request', (request) => !/^(https?|ws):\/\/127\.0\.0\.1|^data:|^blob:/.test(request.url()) && problems.push(`not from here: ${request.url()}`));
    page.setDefaultTimeout(120000);
    await page.goto(`${address}#${hash}`);
    await page.waitForFunction((still) => window.wade && (still || wade.ready()), hash.includes('still'), patient);
    return page;
  };
  return { browser, open, patient, problems };
}

// Reads a hundred random wet points of a picture back through the legend of each mode: the largest difference from the data, of the
// full scale. A ray through the middle of the pixel finds the point, or something that hides the water there.
const misread = (page, modes, camera, time) => page.evaluate(async ({ modes, camera, time }) => {
  const three = await import('three'), choose = (id, value) => {
    document.querySelector(id).value = value;
    document.querySelector(id).dispatchEvent(new Event('change'));
  };
  choose('#mode', modes[0]);
  choose('#camera', camera);
  await wade.picture(time);
  const { show } = wade, { water } = show, { grid, message, surface } = water, canvas = document.querySelector('#view canvas'), { width, height } = canvas;
  for (const thing of [show.people?.mesh, show.symbols.points, show.ring, show.traces?.mesh]) if (thing) thing.visible = false; // they stand before the water
  show.tracesOn = false;
  const read = (wide, high, draw) => {
    const c = new OffscreenCanvas(wide, high).getContext('2d');
    draw(c);
    return c.getImageData(0, 0, wide, high).data;
  };
  // The data: what the columns of a message hold in each cell; of particles in three dimensions the page's own sums.
  const { nx, nz, cell, x0, z0 } = grid, sums = ['depth', 'vx', 'vz'].map(() => new Float32Array(nx * nz));
  if (water.inColumns && message) {
    const [x, , z, vx, , vz, volume] = message.arrays;
    for (let k = 0; k < message.count; ++k) {
      const c = Math.floor((z[k] - z0) / cell) * nx + Math.floor((x[k] - x0) / cell);
      [1, vx[k], vz[k]].forEach((v, f) => (sums[f][c] += (v * volume[k]) / cell ** 2));
    }
    for (let c = 0; c < nx * nz; ++c) if (sums[0][c] > 0) (sums[1][c] /= sums[0][c]), (sums[2][c] /= sums[0][c]);
  } else [grid.depth, grid.vx, grid.vz].forEach((field, f) => sums[f].set(field));
  const ray = new three.Raycaster(), lens = wade.camera(), solid = show.world ? [show.world, surface] : [surface], points = [];
  surface.geometry.boundingSphere = null;
  let random = 7, hidden = 0;
  for (let k = 0; k < 20000 && points.length < 100; ++k) {
    random = (random * 1664525 + 1013904223) % 4294967296;
    const c = Math.floor((random / 4294967296) * nx * nz), i = c % nx, j = Math.floor(c / nx);
    if (sums[0][c] < 0.02 || i < 1 || j < 1 || i + 2 > nx || j + 2 > nz) continue;
    const [x, y] = wade.project(x0 + cell * (i + 0.5), grid.bed[c] + water.even[c], z0 + cell * (j + 0.5));
    const px = Math.floor((x * width) / innerWidth), py = Math.floor((y * height) / innerHeight);
    if (px < 0 || py < 0 || px >= width || py >= height) continue;
    ray.setFromCamera(new three.Vector2((2 * (px + 0.5)) / width - 1, 1 - (2 * (py + 0.5)) / height), lens);
    const [hit] = ray.intersectObjects(solid);
    const gx = hit && (hit.point.x - x0) / cell - 0.5, gz = hit && (-hit.point.z - z0) / cell - 0.5, a = Math.floor(gx), b = Math.floor(gz);
    const near = hit?.object === surface && a >= 0 && b >= 0 && a + 1 < nx && b + 1 < nz ? [0, 1, nx, nx + 1].map((o) => b * nx + a + o) : [];
    if (near.length && near.every((o) => sums[0][o] > 0.02)) points.push({ near, pixel: py * width + px });
    else ++hidden; // or at the edge, where the colour of the wet cells goes on
  }
  const found = modes.map((mode) => {
    choose('#mode', mode);
    wade.paint();
    const picture = read(width, height, (c) => c.drawImage(canvas, 0, 0)), parts = 1000;
    const colours = getComputedStyle(document.querySelector('#bar')).backgroundImage.match(/rgb\([^)]*\)/g);
    const scale = read(parts, 1, (c) => {
      const along = c.createLinearGradient(0, 0, parts, 0);
      colours.forEach((colour, k) => along.addColorStop(k / (colours.length - 1), colour));
      c.fillStyle = along;
      c.fillRect(0, 0, parts, 1);
    });
    const full = parseFloat([...document.querySelectorAll('#ticks span')].pop().textContent);
    const worst = { off: 0 };
    for (const { near, pixel } of points) {
      const apart = (m) => [0, 1, 2].reduce((sum, k) => sum + (scale[4 * m + k] - picture[4 * pixel + k]) ** 2, 0);
      let best = 0;
      for (let m = 1; m < parts; ++m) if (apart(m) < apart(best)) best = m;
      // The triangles interpolate between the middles of these four cells.
      const values = near.map((o) => (mode === 'speed' ? Math.hypot(sums[1][o], sums[2][o]) : sums[0][o])), value = ((best + 0.5) / parts) * full;
      const off = Math.max(Math.min(...values) - value, value - Math.max(...values), 0) / full;
      if (off > worst.off) Object.assign(worst, { off, value, values, pixel });
    }
    return { mode, full, worst };
  });
  if (show.people?.mesh) show.people.mesh.visible = true;
  return { found, seen: points.length, hidden };
}, { modes, camera, time });

/** Holds the colours of a picture in each mode against the legend. */
export async function legible(page, { modes, camera, time, name = '' }) {
  const { found, seen, hidden } = await misread(page, modes, camera, time);
  for (const { mode, full, worst } of found) {
    console.log(`${name}${mode}, camera ${camera}: ${seen} points, at most ${(100 * worst.off).toFixed(2)} % of ${full} from the data (${hidden} hidden or at an edge)`);
    assert.ok(seen === 100 && worst.off < SLACK, `colours of ${name}${mode}, camera ${camera}: at ${seen} points; ${JSON.stringify(worst)}`);
  }
}

// The page of the viewer in Debian's chromium, drawn by software: a run that has ended and one that goes on.
// node view_page.mjs MODULES PORT_ENDED PORT_LIVE WANTED PICTURES

import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import path from 'node:path';

const [modules, ended, live, wantedText, pictures] = process.argv.slice(2);
const { chromium } = createRequire(path.join(modules, 'x'))('playwright-core');
const wanted = JSON.parse(wantedText);
const browser = await chromium.launch({
  executablePath: '/usr/bin/chromium', args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
const patient = { timeout: 120000, polling: 100 }; // a net for busy machines; nothing here measures time
const problems = [];

async function open(port, hash, size) {
  const page = await browser.newPage({ viewport: size, bypassCSP: true });
  page.on('console', (message) => ['error', 'warning'].includes(message.type()) && !/GPU stall|ReadPixels/.test(message.text()) && problems.push(message.text()));
  page.on('pageerror', (error) => problems.push(error.message));
  page.on('requestfailed', (request) => problems.push(`failed: ${request.url()}`));
  page.on('request', (request) => !/^(https?|ws):\/\/127\.0\.0\.1|^data:|^blob:/.test(request.url()) && problems.push(`not from here: ${request.url()}`));
  page.setDefaultTimeout(120000);
  await page.goto(`http://127.0.0.1:${port}/#${hash}`);
  await page.waitForFunction(() => window.wade?.ready(), null, patient);
  return page;
}

const picture = (page, name) => page.screenshot({ path: path.join(pictures, `${name}.png`) });

try {
  // A run that has ended: its end has the counts of outcome.json.
  let page = await open(ended, 'play=0&t=2&dark=0', { width: 640, height: 400 });
  assert.equal(await page.textContent('#state'), 'ended');
  const first = await picture(page, 'begin');
  await page.evaluate((end) => wade.seek(end), wanted.end);
  await page.waitForFunction((want) => (wade.counts().arrived ?? 0) === want.arrived && (wade.counts().dead ?? 0) === want.dead, wanted, patient);
  assert.equal(await page.getAttribute('#counts [data-state=arrived]', 'data-count').catch(() => '0'), String(wanted.arrived));
  const last = await picture(page, 'end');
  assert.notDeepEqual(first, last, 'the picture changes with the time');

  // Scrub by hand; then a click on a person shows its terms.
  await page.fill('#time', '3');
  await page.waitForFunction(() => Math.abs(wade.at().time - 3) < 0.02 && Math.abs(wade.at().water - 3) <= 0.5, null, patient);
  await page.waitForFunction(() => wade.at().people === 6, null, patient);
  const [x, y] = await page.evaluate(() => wade.placeOf(wade.show.people.shown[2].id));
  await page.mouse.click(x, y);
  await page.waitForSelector('#who.open');
  await page.waitForFunction(() => /Eq. 9/.test(document.querySelector('#who').textContent), null, patient);
  assert.match(await page.textContent('#who'), /tau .*0\.20/);

  // Keys: one frame on, points and back, help, dark, from above.
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
  await page.waitForTimeout(300);
  await picture(page, 'above');
  await page.setViewportSize({ width: 400, height: 640 });
  await page.waitForTimeout(300);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 400, `the page is ${wide} wide at 400`);
  await picture(page, 'narrow');
  await page.close();

  // A run that goes on: particles come, time goes, tau changes, it pauses.
  page = await open(live, 'dark=1&form=points', { width: 800, height: 560 });
  await page.waitForFunction(() => wade.at().particles === 640 && document.querySelector('#state').textContent === 'running', null, patient);
  const then = await page.evaluate(() => wade.at());
  await page.waitForFunction((t) => wade.at().time > t.time && wade.at().water > t.water, then, patient);
  await page.fill('#tau-value', '0.9');
  await page.selectOption('#tau-group', 'group walkers');
  await page.click('#tau-set');
  await page.waitForFunction(() => wade.show.taus.length === 1, null, patient);
  await page.click('#run-pause');
  await page.waitForFunction(() => document.querySelector('#state').textContent === 'paused', null, patient);
  await picture(page, 'live');
  await page.click('#run-pause');
  await page.waitForFunction(() => document.querySelector('#state').textContent === 'running', null, patient);
  assert.deepEqual(problems, []);
} finally {
  await browser.close();
}

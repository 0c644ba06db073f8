// The colours of the water in the viewer's page against its legend, for scenes of different kinds and three cameras.
// node view_colours.mjs MODULES; JSON on stdin: a list of name, address, time (s) of each.

import assert from 'node:assert/strict';
import fs from 'node:fs';
import { legible, opened } from './view_browser.mjs';

const { browser, open, problems } = await opened(process.argv[2]), modes = ['depth', 'speed'];
try {
  for (const { name, address, time } of JSON.parse(fs.readFileSync(0))) {
    const page = await open(address, 'still&play=0&dark=0&quality=low', { width: 1280, height: 720 });
    for (const camera of ['free', 'top']) await legible(page, { name: `${name}, `, modes, camera, time });
    // Nearer and from another side.
    await page.evaluate(() => document.activeElement.blur());
    for (const key of ['t', ...Array(3).fill('PageUp'), ...Array(6).fill('Shift+ArrowLeft')]) await page.keyboard.press(key);
    await legible(page, { name: `${name}, near, `, modes, camera: 'free', time });
    await page.close();
  }
  assert.deepEqual(problems, []);
} finally {
  await browser.close();
}

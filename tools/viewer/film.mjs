// Pictures of the viewer's page at given times, one PNG after another on stdout: tools/wade film --eye.
// node film.mjs MODULES; JSON on stdin: url (with the key of the page), times (s), width, height (pixels), hash (of the page), bare (no panels),
// browser (the program).

import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';

const [modules] = process.argv.slice(2), options = JSON.parse(fs.readFileSync(0));
const { chromium } = createRequire(path.join(path.resolve(modules), 'x'))('playwright-core');
const browser = await chromium.launch({
  executablePath: options.browser, args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
const patient = { timeout: 120000, polling: 20 };
try {
  const page = await browser.newPage({ viewport: { width: options.width, height: options.height }, bypassCSP: true });
  page.on('pageerror', (error) => {
    console.error(error.message);
    process.exitCode = 1;
  });
  await page.goto(`${options.url}#still&play=0&${options.hash}`);
  await page.waitForFunction(() => window.wade, null, patient);
  for (const time of options.times) {
    const drawn = await page.evaluate((t) => wade.picture(t), time);
    const picture = options.bare ? Buffer.from(drawn.split(',')[1], 'base64') : await page.screenshot({ timeout: 120000 });
    if (!process.stdout.write(picture)) await new Promise((drained) => process.stdout.once('drain', drained));
  }
} finally {
  await browser.close();
}

// The HTML report in Chromium: opened as a file, as people do, without a server.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';
import { noShared, noTool, readGlb, sample, scratch, sharedFile, tool } from './support.mjs';

const executablePath = process.env.NMC_CHROMIUM ?? '/usr/bin/chromium';
const noChromium = existsSync(executablePath) ? false : `needs Chromium (${executablePath}); set NMC_CHROMIUM`;
const folder = join(scratch, 'reports');
const skip = noTool || noChromium;
let browser;

before(async () => {
  if (skip) return;
  mkdirSync(folder, { recursive: true });
  // A page of the test alone is loaded; Chromium's sandbox does not start for root.
  browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'] });
});

after(() => browser?.close());

const made = new Map();

/** The report of compressing a file, and of verifying the result, each with its JSON; made once. */
function reportOf(name, original, tolerance = '0.1%') {
  if (made.has(name)) return made.get(name);
  const [small, compress, verify] = ['glb', 'html', 'verify.html'].map((end) => join(folder, `${name}.${end}`));
  const run = (...args) => JSON.parse(execFileSync(tool, [...args, '--json'], { encoding: 'utf8', maxBuffer: 2 ** 28 }));
  const report = {
    small,
    compress: { page: compress, json: run(original, small, '--effort', '1', '--tolerance', tolerance, '--report', compress) },
    verify: { page: verify, json: run('verify', original, small, '--tolerance', tolerance, '--report', verify) },
  };
  made.set(name, report);
  return report;
}

/** Opens a report and returns the page and everything that it complains about or asks for. */
async function open(file, options = {}) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 }, ...options });
  const complaints = [];
  const isAboutRendering = (text) => /GPU stall|swiftshader|GL Driver Message/i.test(text);
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('console', (message) => !isAboutRendering(message.text()) && complaints.push(`${message.type()}: ${message.text()}`));
  page.on('request', (request) => /^(data|blob|file):/.test(request.url()) || complaints.push(`request: ${request.url()}`));
  await page.goto(pathToFileURL(file).href);
  await page.waitForFunction(() => document.documentElement.dataset.ready, null, { timeout: 60000 });
  return { page, complaints };
}

const human = () => reportOf('humanoid', sample('humanoid_30hz.glb'));

/** Pixels of the drawing once what was asked for is drawn, which is with the browser's next frame. */
const picture = (page) =>
  page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(document.getElementById('canvas').toDataURL())))));

test('the report loads, plays and scrubs', { skip }, async () => {
  const { page, complaints } = await open(human().compress.page);
  const still = await picture(page);
  assert.ok(still.length > 5000, 'nothing is drawn');
  await page.click('#play');
  await page.waitForFunction(() => window.nmcReport.player.frames.length > 10);
  assert.equal(await page.getAttribute('#play', 'aria-label'), 'Pause');
  await page.click('#play');
  const time = await page.evaluate(() => window.nmcReport.player.time);
  assert.ok(time > 0, 'time stands still');
  assert.notEqual(await picture(page), still);
  await page.focus('#scrub');
  await page.keyboard.press('Home');
  assert.equal(await page.evaluate(() => window.nmcReport.player.time), 0);
  assert.equal(await picture(page), still);
  assert.deepEqual(complaints, []);
  await page.close();
});

test('what the page decodes is within the tolerance of what it shows as the original', { skip }, async () => {
  const { page } = await open(human().compress.page);
  const worst = await page.evaluate(() => {
    const { data, player } = window.nmcReport;
    return data.clips.map((clip) => {
      player.choose(clip);
      let largest = 0;
      for (let k = 0; k <= 50; ++k) {
        player.seek(player.start + ((player.end - player.start) * k) / 50);
        largest = Math.max(largest, ...player.errors);
      }
      return largest;
    });
  });
  assert.equal(worst.length, 9);
  // In units of the tolerance; the keys of the original in the page are rounded to 16 bits.
  for (const error of worst) assert.ok(error > 0.05 && error <= 1.02, `${error}`);
  await page.close();
});

test('the keyboard does everything', { skip }, async () => {
  const { page, complaints } = await open(human().compress.page);
  const player = (what) => page.evaluate((key) => window.nmcReport.player[key], what);
  await page.focus('#stage');
  const first = await picture(page);
  await page.keyboard.press('ArrowLeft');
  assert.notEqual(await picture(page), first, 'turning');
  await page.keyboard.press('0');
  assert.equal(await picture(page), first, 'the view comes back');
  await page.keyboard.press('+');
  assert.notEqual(await picture(page), first, 'zooming');
  await page.keyboard.press('.');
  assert.ok(Math.abs((await player('time')) - 1 / 30) < 1e-3, 'a frame forwards');
  await page.keyboard.press(',');
  assert.ok((await player('time')) < 1e-6, 'a frame back');
  await page.keyboard.press(' ');
  assert.equal(await player('playing'), true);
  await page.keyboard.press(' ');
  assert.equal(await player('playing'), false);
  await page.focus('#clip-list');
  await page.keyboard.press('ArrowDown');
  assert.equal(await page.evaluate(() => window.nmcReport.player.clip.name), 'walk_root_motion');
  assert.equal(await page.getAttribute('#clip-list [aria-selected="true"]', 'title'), 'walk_root_motion');
  assert.deepEqual(complaints, []);
  await page.close();
});

/** A column of the table as it is shown, by its title. */
async function column(page, title) {
  return page.evaluate((wanted) => {
    const titles = Array.from(document.querySelectorAll('#table thead th'), (cell) => cell.textContent);
    const index = titles.indexOf(wanted);
    return Array.from(document.querySelectorAll('#table tbody tr'), (row) => row.cells[index].textContent);
  }, title);
}

test('the numbers are those of the JSON report', { skip }, async () => {
  const { compress, verify } = human();
  const { page } = await open(compress.page);
  const { json } = compress;
  // The page was written by the run that printed the JSON.
  assert.deepEqual(await page.evaluate(() => window.nmcReport.data.report), json);
  const group = (n) => String(n).replace(/\B(?=(\d{3})+$)/g, ',');
  assert.deepEqual(await column(page, 'animation'), json.animations.map(({ name }) => name));
  assert.deepEqual(await column(page, 'frames'), json.animations.map(({ frames }) => group(frames)));
  assert.deepEqual(await column(page, 'bytes before'), json.animations.map((row) => group(row.bytes_before)));
  assert.deepEqual(await column(page, 'after'), json.animations.map((row) => group(row.bytes_after)));
  assert.deepEqual(await column(page, 'length'), json.animations.map((row) => `${row.duration_seconds.toFixed(2)} s`));
  const errors = (await column(page, 'max error')).map((text) => parseFloat(text) / 100);
  json.animations.forEach(({ error }, i) => assert.ok(Math.abs(errors[i] - error.max_fraction_of_size) <= 0.0006 * errors[i], `${i}`));
  const facts = await page.innerText('#facts');
  assert.ok(facts.includes(group(json.file_bytes_before)) && facts.includes(group(json.file_bytes_after)), facts);
  assert.ok(facts.includes(group(json.totals.bytes_before)) && facts.includes(group(json.totals.bytes_after)), facts);
  // The parts are all of the file.
  const parts = await page.evaluate(() => window.nmcReport.data.parts);
  for (const [which, total] of [['before', json.file_bytes_before], ['after', json.file_bytes_after]])
    assert.equal(parts.reduce((sum, part) => sum + part[which], 0), total);
  const shown = await page.evaluate(() => Array.from(document.querySelectorAll('.parts tbody td:nth-child(2)'), (cell) => Number(cell.textContent.replaceAll(',', ''))));
  assert.equal(shown.reduce((a, b) => a + b, 0), json.file_bytes_before);
  await page.close();

  const second = await open(verify.page);
  assert.deepEqual(await second.page.evaluate(() => window.nmcReport.data.report), verify.json);
  assert.deepEqual(await column(second.page, 'holds'), verify.json.animations.map(({ holds }) => (holds ? 'yes' : 'no')));
  assert.deepEqual(second.complaints, []);
  await second.page.close();
});

test('the curve of each clip ends where the report says', { skip }, async () => {
  const { compress } = human();
  const { page } = await open(compress.page);
  const largest = await page.evaluate(() => window.nmcReport.data.clips.map(({ profile }) => Math.max(...profile.max)));
  compress.json.animations.forEach(({ error }, i) => assert.ok(Math.abs(largest[i] - error.max_world_units) < 1e-6 * error.max_world_units + 1e-9));
  // Single points are never worse than the worst one.
  const below = await page.evaluate(() =>
    window.nmcReport.data.clips.every(({ profile }) => profile.worst.length > 0 && profile.worst.every(({ error }) => error.every((e, k) => e <= profile.max[k] * 1.0001))),
  );
  assert.ok(below);
  await page.close();
});

test('the table sorts, and shows the animation of a row', { skip }, async () => {
  const { page } = await open(human().compress.page);
  const { json } = human().compress;
  await page.click('#table thead button:text-is("bytes before")');
  const sorted = [...json.animations].sort((a, b) => b.bytes_before - a.bytes_before).map(({ name }) => name);
  assert.deepEqual(await column(page, 'animation'), sorted);
  assert.equal(await page.getAttribute('#table th[aria-sort]', 'aria-sort'), 'descending');
  await page.click('#table thead button:text-is("bytes before")');
  assert.deepEqual(await column(page, 'animation'), sorted.reverse());
  await page.click('#table thead button:text-is("animation")');
  assert.deepEqual(await column(page, 'animation'), json.animations.map(({ name }) => name).sort());
  await page.click('#table tbody tr:nth-child(2) th button');
  assert.equal(await page.evaluate(() => window.nmcReport.player.clip.name), [...json.animations].map(({ name }) => name).sort()[1]);
  await page.close();
});

test('a clip has the frequencies of its stream', { skip }, async () => {
  const { page } = await open(human().compress.page);
  const inspected = JSON.parse(execFileSync(tool, ['inspect', human().small, '--json'], { encoding: 'utf8' }));
  const expected = inspected.clip_sets.flatMap(({ clips }) => clips);
  for (const { animation, nonzero_weights, corrections } of expected) {
    await page.evaluate((index) => window.nmcReport.player.choose(window.nmcReport.data.clips[index]), animation);
    const caption = (await page.textContent('#spectrum-caption')).replaceAll(',', '');
    assert.ok(caption.startsWith(`${nonzero_weights} weights`), caption);
    assert.ok(caption.includes(`and ${corrections} corrections`), caption);
  }
  await page.close();
});

for (const width of [390, 820, 1280]) {
  for (const colorScheme of ['light', 'dark']) {
    test(`${width} pixels wide, ${colorScheme}`, { skip }, async () => {
      const { page, complaints } = await open(human().compress.page, { viewport: { width, height: 900 }, colorScheme });
      const overflow = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
      assert.ok(overflow <= 0, `the page is ${overflow} pixels too wide`);
      const [red] = await page.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g).map(Number));
      assert.equal(red < 128, colorScheme === 'dark');
      await page.evaluate(() => window.nmcReport.player.seek(0.5));
      await picture(page);
      await page.screenshot({ path: join(folder, `humanoid_${width}_${colorScheme}.png`), fullPage: true });
      assert.deepEqual(complaints, []);
      await page.close();
    });
  }
}

test('exceptions from the tolerance have a line of their own', { skip }, async () => {
  const original = sample('humanoid_30hz.glb');
  const { json } = readGlb(readFileSync(original));
  const hand = json.nodes[json.skins[0].joints.at(-1)].name;
  const [first, second] = json.animations.map(({ name }) => name);
  const file = join(folder, 'exceptions.html');
  const options = ['--effort', '1', '--tolerance', '1%', '--tolerance', `0.2%,joint=${hand},clip=${first}`, '--tolerance', `0.5%,clip=${second}`];
  const report = JSON.parse(execFileSync(tool, [original, join(folder, 'exceptions.glb'), ...options, '--json', '--report', file], { encoding: 'utf8' }));
  const shares = report.animations.map((row) => [row.tolerance_world_units, row.finest_tolerance_world_units].map((length) => length / report.size_world_units));
  const near = (actual, expected) => actual.forEach((share, i) => assert.ok(Math.abs(share - expected[i]) < 1e-9, `${actual}`));
  near(shares[0], [0.01, 0.002]);
  near(shares[1], [0.005, 0.005]);
  near(shares[2], [0.01, 0.01]);
  const { page, complaints } = await open(file);
  const legend = page.getByText('the finest of an exception');
  assert.equal(await legend.count(), 1);
  await page.evaluate(() => window.nmcReport.player.choose(window.nmcReport.data.clips[1]));
  assert.equal(await legend.count(), 0);
  assert.deepEqual(complaints, []);
  await page.close();
});

// The knight's bound is there to be quick.
for (const [name, file, tolerance] of [['fox', 'game/fox.glb', '0.1%'], ['knight', 'game/knight_76clips.glb', '5%']]) {
  test(`the report of ${name}`, { skip: skip || noShared(file) }, async (t) => {
    const { compress } = reportOf(name, sharedFile(file), tolerance);
    const { page, complaints } = await open(compress.page);
    await page.click('#play');
    await page.waitForFunction(() => window.nmcReport.player.frames.length >= 60, null, { timeout: 60000 });
    const [frames, intervals] = await page.evaluate(() => ['frames', 'intervals'].map((key) => [...window.nmcReport.player[key]].sort((a, b) => a - b)));
    const middle = (values) => values[values.length >> 1].toFixed(1);
    t.diagnostic(`${name}: a frame is ready after ${middle(frames)} ms and ${middle(intervals)} ms after the one before (medians)`);
    // The skin is drawn: what is behind the skeleton has many colours.
    const colours = await page.evaluate(() => {
      const canvas = document.getElementById('skin-canvas');
      const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d');
      copy.drawImage(canvas, 0, 0);
      return new Set(new Uint32Array(copy.getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size;
    });
    assert.ok(colours > 500, `${colours} colours`);
    // What was tried is there, and the smallest of what keeps the bound was taken.
    const tried = await page.evaluate(() => window.nmcReport.data.clips.map(({ candidates }) => candidates));
    for (const candidates of tried) {
      const kept = candidates.filter((one) => one.kept);
      const chosen = candidates.filter((one) => one.chosen);
      assert.equal(chosen.length, 1);
      assert.equal(chosen[0].bytes, Math.min(...kept.map(({ bytes }) => bytes)));
      for (const { error } of kept) assert.ok(error <= compress.json.tolerance_world_units);
    }
    await page.screenshot({ path: join(folder, `${name}.png`), fullPage: true });
    assert.equal(await page.evaluate(() => window.nmcReport.data.clips.length), compress.json.animations.length);
    assert.deepEqual(complaints, []);
    await page.close();
  });
}

// The plug-ins in Chromium: original and compressed file side by side, their joints measured and their pictures compared and kept.
import assert from 'node:assert/strict';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';
import { after, before, test } from 'node:test';
import { chromium } from 'playwright-core';
import { compressed, noShared, noTool, root, sample, scratch, sharedFile, snippets, streams } from './support.mjs';

const executablePath = process.env.NMC_CHROMIUM ?? '/usr/bin/chromium';
const noChromium = existsSync(executablePath) ? false : `needs Chromium (${executablePath}); set NMC_CHROMIUM`;
const tolerance = 0.001;
const allowed = tolerance + 1e-4;
const pictures = join(scratch, 'pictures');
const types = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.glb': 'model/gltf-binary' };

let server;
let browser;
const served = new Map();
/** Empty pages that a Content-Security-Policy binds. */
const policies = new Map([
  ['/strict', "script-src 'self'"],
  ['/wasm', "script-src 'self' 'wasm-unsafe-eval'"],
]);

/** Modules that are made here. */
const modules = new Map([['/snippets/playcanvas.mjs', asFunction(snippets.get('playcanvas'))]]);

/** A piece of docs/engines.md as a module with a function of what stands around it there. */
function asFunction(code) {
  const [imports, body] = code.split('\n\n');
  return `${imports}\nexport async function load(pc, app, file) {\n${body.replaceAll("'character.glb'", 'file')}return asset;\n}\n`;
}

/** Gives a file of any folder an address on the test's server. */
function address(file) {
  const path = `/files/${served.size}.glb`;
  served.set(path, file);
  return path;
}

before(async () => {
  if (noChromium || noTool) return;
  mkdirSync(pictures, { recursive: true });
  server = createServer((request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, 'http://localhost').pathname));
    if (policies.has(path)) return response.writeHead(200, { 'content-type': 'text/html', 'content-security-policy': policies.get(path) }).end();
    if (modules.has(path)) return response.writeHead(200, { 'content-type': types['.mjs'] }).end(modules.get(path));
    const file = served.get(path) ?? join(root, path);
    if (!existsSync(file)) return response.writeHead(404).end();
    response.writeHead(200, { 'content-type': types[extname(file)] ?? 'application/octet-stream' }).end(readFileSync(file));
  });
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  // Pages of the test alone are loaded; Chromium's sandbox does not start for root. Software rendering works everywhere.
  browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'] });
});

after(async () => {
  await browser?.close();
  server?.close();
});

const characters = [
  { name: 'humanoid', file: () => sample('humanoid_30hz.glb'), clips: 9, skip: false },
  { name: 'fox', file: () => sharedFile('game/fox.glb'), clips: 3, skip: noShared('game/fox.glb') },
  { name: 'knight', file: () => sharedFile('game/knight_76clips.glb'), clips: 76, skip: noShared('game/knight_76clips.glb') },
];

const engines = [
  ['three.js', 'three', false],
  ['three.js, evaluating while playing', 'three', true],
  ['Babylon.js', 'babylon'],
  ['PlayCanvas', 'playcanvas'],
];

for (const { name, file, clips, skip } of characters) {
  for (const [engine, page, ...options] of engines) {
    test(`${name} in ${engine}`, { skip: noTool || noChromium || skip }, async () => {
      const [original, other] = [file(), compressed(file(), '--tolerance', '0.1%', '--effort', '1')];
      const files = [original, other].map(address);
      const opened = await open(page);
      // A page that was handed a broken file plays the next one. One character is enough to see that.
      if (name === 'humanoid') await refuses(opened, [original, damaged(other)].map(address), options);
      const { result, messages, different } = await play(opened, files, options, `${name}_${page}${options[0] ? '_streaming' : ''}.png`);
      assert.deepEqual(messages, []);
      assert.equal(result.clips, clips);
      assert.ok(result.motion > 0.1, 'nothing moves');
      assert.ok(result.difference > 0 && result.difference <= allowed, `the joints differ by ${result.difference} of the size`);
      // A thousandth of the size is less than a pixel here, so only pixels at edges may change.
      assert.ok(different < 0.02, `${different} of the pixels differ`);
    });
  }
}

for (const [address, decoder] of [
  ['/strict', 'js'],
  ['/wasm', 'wasm'],
]) {
  test(`under the policy "${policies.get(address)}" the decoder is ${decoder}`, { skip: noTool || noChromium }, async () => {
    const [stream] = streams(readFileSync(compressed(sample('humanoid_30hz.glb'), '--tolerance', '0.1%', '--effort', '1')));
    const page = await browser.newPage();
    const errors = [];
    page.on('pageerror', (error) => errors.push(String(error)));
    await page.goto(`http://127.0.0.1:${server.address().port}${address}`);
    const [auto, expected, keys] = await page.evaluate(openInPage, [[...stream], decoder]);
    await page.close();
    assert.deepEqual(errors, []);
    assert.equal(auto, expected);
    assert.ok(keys > 1000);
  });
}

/** Which kind of set the package opens by itself, and which one the named decoder opens; runs in the page. */
async function openInPage([numbers, decoder]) {
  const { openSet } = await import('/gltf_ext/js/src/index.js');
  const [auto, named] = [undefined, decoder].map((one) => openSet(Uint8Array.from(numbers), { decoder: one }));
  const keys = auto.clips.flatMap((clip) => clip.decode()).reduce((sum, { values }) => sum + values.length, 0);
  return [auto.constructor.name, named.constructor.name, keys];
}

/** Opens a page, and collects what it complains about. */
async function open(name) {
  const page = await browser.newPage({ viewport: { width: 808, height: 404 } });
  const uncaught = [];
  const written = [];
  page.on('pageerror', (error) => uncaught.push(String(error)));
  page.on(
    'console',
    (message) => ['error', 'warning'].includes(message.type()) && !isAboutRendering(message.text()) && written.push(message.text()),
  );
  await page.goto(`http://127.0.0.1:${server.address().port}/tests/js/pages/${name}.html`);
  await page.waitForFunction(() => window.ready, null, { timeout: 60000 });
  return { page, uncaught, written };
}

async function play({ page, uncaught, written }, files, options, picture) {
  const result = await page.evaluate(([urls, ...rest]) => window.play(urls, ...rest), [files, ...options]);
  await page.screenshot({ path: join(pictures, picture) });
  const different = await page.evaluate(differentPixels);
  await page.close();
  return { result, messages: [...uncaught, ...written], different };
}

/** The page must reject a damaged file with the decoder's own error, and may write about it. */
async function refuses({ page, written }, files, options) {
  const code = await page.evaluate(errorCode, [files, ...options]);
  assert.equal(code, 'checksum');
  written.length = 0;
}

/** The code of the NmcError that a page's play rejects with, directly or inside of an error of the engine; runs in the page. */
function errorCode([urls, ...rest]) {
  return window.play(urls, ...rest).then(
    () => 'plays',
    (error) => (error.innerError ?? error).code ?? String(error),
  );
}

/** A copy of a compressed file with a wrong bit in its first stream. */
function damaged(file) {
  const bytes = readFileSync(file);
  const at = bytes.indexOf(streams(bytes)[0]);
  bytes[at + 100] ^= 1;
  const out = join(scratch, 'damaged.glb');
  writeFileSync(out, bytes);
  return out;
}

/** What Chromium says about drawing without a graphics card. */
function isAboutRendering(text) {
  return /GPU stall|swiftshader|GL Driver Message/i.test(text);
}

/** The share of the pixels of both canvases that differ visibly; runs in the page. Refuses empty pictures. */
function differentPixels() {
  const [a, b] = Array.from(document.querySelectorAll('canvas'), (canvas) => {
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d');
    copy.drawImage(canvas, 0, 0);
    return copy.getImageData(0, 0, canvas.width, canvas.height).data;
  });
  const far = (p, q, i, j) => Math.abs(p[i] - q[j]) + Math.abs(p[i + 1] - q[j + 1]) + Math.abs(p[i + 2] - q[j + 2]) > 48;
  let different = 0;
  let drawn = 0;
  for (let i = 0; i < a.length; i += 4) {
    if (far(a, b, i, i)) ++different;
    if (far(a, a, i, 0)) ++drawn;
  }
  return drawn * 4 > a.length * 0.01 ? (different * 4) / a.length : 1;
}

// The code of docs/engines.md, run as it stands there: extracted, and put into a folder in which the package is installed.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { playCanvasModel } from './measure.mjs';
import { compressed, installPackage, newPlayCanvas, noTool, readGlb, root, sample, scratch, snippets, streams } from './support.mjs';

const text = readFileSync(join(root, 'docs/engines.md'), 'utf8');

let folder;
let server;
let bytes;

before(async () => {
  if (noTool) return;
  folder = mkdtempSync(join(scratch, 'docs-'));
  installPackage(folder);
  bytes = readFileSync(compressed(sample('humanoid_30hz.glb'), '--tolerance', '0.1%', '--effort', '1'));
  server = createServer((request, response) => response.writeHead(200, { 'content-type': 'model/gltf-binary' }).end(bytes));
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
});

after(() => {
  server?.close();
  if (folder) rmSync(folder, { recursive: true, force: true });
});

/**
 * Runs a snippet with what stands around it in an application.
 * @param {string} name of the snippet
 * @param {string[]} results the names of its constants that the test wants
 * @param {{lines?: string, values?: object}} [context] code before it, and values that it finds under their names
 */
async function run(name, results, { lines = '', values = {} } = {}) {
  const code = snippets
    .get(name)
    .replaceAll("character.glb')", `http://127.0.0.1:${server.address().port}/character.glb')`)
    .replaceAll("'character.glb', scene", `'http://127.0.0.1:${server.address().port}/character.glb', scene`);
  globalThis.snippetValues = values;
  const file = join(folder, `${name}.mjs`);
  writeFileSync(
    file,
    `${lines}\nconst { ${Object.keys(values).join(', ')} } = globalThis.snippetValues;\n${code}\nexport { ${results.join(', ')} };\n`,
  );
  return import(pathToFileURL(file).href);
}

test('there is a snippet for each engine, of under ten lines', () => {
  assert.deepEqual([...snippets.keys()], ['three', 'babylon', 'gltf-transform', 'playcanvas', 'expand', 'decoder']);
  for (const [name, code] of snippets) assert.ok(code.split('\n').length <= 10, name);
  assert.equal(text.match(/```js/g).length, snippets.size);
});

test('three.js', { skip: noTool }, async () => {
  // Node has no ProgressEvent, which three.js' loader of files tells its progress with.
  globalThis.ProgressEvent ??= Event;
  const { animations, scene } = await run('three', ['animations', 'scene']);
  assert.equal(animations.length, 9);
  assert.ok(scene.children.length > 0);
  assert.ok(animations[0].tracks.length > 50);
});

test('Babylon.js', { skip: noTool }, async () => {
  // Node has no XMLHttpRequest, with which Babylon.js loads files.
  globalThis.XMLHttpRequest ??= FetchRequest;
  const lines = `import { NullEngine } from '@babylonjs/core/Engines/nullEngine.js';
    import { Scene } from '@babylonjs/core/scene.js';
    import { LoadAssetContainerAsync } from '@babylonjs/core/Loading/sceneLoader.js';
    const scene = new Scene(new NullEngine());`;
  const { container } = await run('babylon', ['container'], { lines });
  assert.equal(container.animationGroups.length, 9);
  assert.ok(container.animationGroups[0].targetedAnimations.length > 50);
});

test('glTF-Transform', { skip: noTool }, async () => {
  const { document } = await run('gltf-transform', ['document']);
  const animations = document.getRoot().listAnimations();
  assert.equal(animations.length, 9);
  assert.ok(animations[0].listChannels().length > 50);
});

test('PlayCanvas', { skip: noTool }, async () => {
  const pc = await import('playcanvas/build/playcanvas.mjs');
  const app = newPlayCanvas(pc);
  const { asset } = await run('playcanvas', ['asset'], { values: { pc, app } });
  const { tracks } = await playCanvasModel(app, asset);
  assert.equal(tracks.length, 9);
  assert.ok(tracks[0].curves.length > 50);
  app.destroy();
});

test('any other loader', { skip: noTool }, async () => {
  const { plain } = await run('expand', ['plain']);
  const { json } = readGlb(new Uint8Array(plain));
  assert.equal(json.extensionsUsed, undefined);
  assert.equal(json.animations.length, 9);
});

test('poses without an engine', { skip: noTool }, async (t) => {
  const log = t.mock.method(console, 'log', () => {});
  const { pose, set } = await run('decoder', ['pose', 'set'], { values: { bytes: streams(bytes)[0] } });
  log.mock.restore();
  assert.equal(log.mock.callCount(), set.targets.length);
  assert.ok(pose.every(Number.isFinite) && pose.some((value) => value !== 0));
});

/** As much of XMLHttpRequest as Babylon.js uses. */
class FetchRequest extends EventTarget {
  static DONE = 4;
  readyState = 0;
  status = 0;
  open(method, url) {
    this.url = url;
  }
  setRequestHeader() {}
  getResponseHeader(name) {
    return this.headers.get(name);
  }
  abort() {}
  async send() {
    const response = await fetch(this.url);
    this.headers = response.headers;
    this.status = response.status;
    this.responseURL = response.url;
    this.response = this.responseType === 'arraybuffer' ? await response.arrayBuffer() : await response.text();
    this.readyState = 4;
    for (const type of ['readystatechange', 'load', 'loadend']) this.dispatchEvent(new Event(type));
  }
}

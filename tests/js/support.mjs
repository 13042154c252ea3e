// Shared by the JavaScript tests: where things are, fixtures made once per tool, and reading plain animations out of a GLB file.
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, readFileSync, renameSync, symlinkSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

export const root = resolve(dirname(fileURLToPath(import.meta.url)), '../..');
const build = resolve(root, process.env.NMC_BUILD ?? 'build');
export const tool = resolve(root, process.env.NMC_TOOL ?? join(build, 'gltf-nmc'));
const makeCharacters = resolve(root, process.env.NMC_MAKE_CHARACTERS ?? join(build, 'make_characters'));
export const scratch = join(build, 'js');
const shared = resolve(root, '../shared/data');
mkdirSync(scratch, { recursive: true });

/** Why tests that need the tool cannot run, or false. */
export const noTool = existsSync(tool) ? false : `needs the built tool (${tool}); set NMC_TOOL`;

/** Why tests that need a file of the shared data cannot run, or false. */
export function noShared(name) {
  return existsSync(join(shared, name)) ? false : `needs ../shared/data/${name}`;
}

export function sharedFile(name) {
  return join(shared, name);
}

/** A file of samples/, made on first use. */
export function sample(name) {
  const folder = join(scratch, 'samples');
  if (!existsSync(join(folder, name))) execFileSync(makeCharacters, [folder]);
  return join(folder, name);
}

/** The file compressed with these options; kept in the build folder until the tool changes. */
export function compressed(file, ...options) {
  const key = createHash('sha256')
    .update(readFileSync(tool))
    .update(readFileSync(file))
    .update(options.join(' '))
    .digest('hex')
    .slice(0, 16);
  const folder = join(scratch, 'compressed');
  mkdirSync(folder, { recursive: true });
  const out = join(folder, `${key}.glb`);
  if (existsSync(out)) return out;
  runTool('compress', file, `${out}.part.glb`, '--quiet', ...options);
  renameSync(`${out}.part.glb`, out);
  return out;
}

export function runTool(...args) {
  return execFileSync(tool, args, { encoding: 'utf8' });
}

/** The pieces of JavaScript in docs/engines.md, by name. */
export const snippets = new Map(
  Array.from(
    readFileSync(join(root, 'docs/engines.md'), 'utf8').matchAll(/<!-- snippet: (.*?) -->\n```js\n(.*?)```/gs),
    ([, name, code]) => [name, code],
  ),
);

/** What a test compresses: name, file and options. The time of a test run is spent here, so effort is low. */
export const fixtures = [
  ...['0.1%', '1%'].map((tolerance) => fixture(`humanoid at ${tolerance}`, () => sample('humanoid_30hz.glb'), tolerance)),
  fixture('all channels', () => sample('humanoid_all_channels.glb'), '1%'),
  fixture('props', () => sample('props.glb'), '0.1%'),
  ...['game/fox.glb', 'game/stag.glb', 'game/cesium_man.glb', 'mocap/cmuamc_02_01.glb'].flatMap((name) => sharedFixtures(name, '0.1%', '1%')),
  // The larger of the two is there to be quick.
  ...sharedFixtures('game/knight_76clips.glb', '0.1%', '5%'),
  { ...fixture('fox, paper', () => sharedFile('game/fox.glb'), '1%', '--profile', 'paper'), skip: noTool || noShared('game/fox.glb') },
  fixture('quadruped, paper', () => sample('quadruped_30hz.glb'), '5%', '--profile', 'paper', '--max-frequencies', '3'),
];

function sharedFixtures(name, ...tolerances) {
  const skip = noTool || noShared(name);
  return tolerances.map((tolerance) => ({ ...fixture(`${name} at ${tolerance}`, () => sharedFile(name), tolerance), skip }));
}

function fixture(name, original, tolerance, ...options) {
  const effort = options.includes('paper') ? [] : ['--effort', '1'];
  return { name, original, skip: noTool, file: () => compressed(original(), '--tolerance', tolerance, ...effort, ...options) };
}

/** The document and the BIN chunk of a GLB file. Reads the container on its own, not through the package. */
export function readGlb(bytes) {
  const file = Buffer.from(bytes.buffer ?? bytes, bytes.byteOffset ?? 0, bytes.byteLength);
  const size = file.readUInt32LE(12);
  return { json: JSON.parse(file.subarray(20, 20 + size)), bin: Uint8Array.from(file.subarray(28 + size)) };
}

/** The streams of a compressed GLB file. */
export function streams(bytes) {
  const { json, bin } = readGlb(bytes);
  return json.extensions.NMC_animation_compression.clipSets.map(({ bufferView }) => {
    const { byteOffset = 0, byteLength } = json.bufferViews[bufferView];
    return bin.slice(byteOffset, byteOffset + byteLength);
  });
}

/** Per animation of a plain GLB file its channels: "path node" to times and values. Float accessors without stride. */
export function channels(bytes) {
  const { json, bin } = readGlb(bytes);
  const floats = (index) => {
    const { bufferView, byteOffset = 0, count, type } = json.accessors[index];
    const begin = (json.bufferViews[bufferView].byteOffset ?? 0) + byteOffset;
    return new Float32Array(bin.buffer.slice(begin, begin + 4 * count * { SCALAR: 1, VEC3: 3, VEC4: 4 }[type]));
  };
  return json.animations.map(({ name, channels: list, samplers }) => ({
    name,
    channels: new Map(
      list
        .filter(({ target, sampler }) => target.node !== undefined && json.accessors[samplers[sampler].output].componentType === 5126)
        .map(({ target, sampler }) => [
          `${target.path} ${target.node}`,
          {
            times: floats(samplers[sampler].input),
            values: floats(samplers[sampler].output),
            interpolation: samplers[sampler].interpolation ?? 'LINEAR',
          },
        ]),
    ),
  }));
}

/** The largest difference, relative to the larger of 1 and the value. */
export function largestDifference(expected, actual) {
  let largest = expected.length === actual.length ? 0 : Infinity;
  for (let i = 0; i < expected.length; ++i) {
    const difference = Math.abs(expected[i] - actual[i]) / Math.max(1, Math.abs(expected[i]));
    if (!(difference <= largest)) largest = difference;
  }
  return largest;
}

/** Packs the npm package and installs it in a folder, as an application would; the engines there are those of the tests. */
export function installPackage(folder) {
  const tarball = execFileSync('npm', ['pack', '--silent', '--pack-destination', folder, join(root, 'gltf_ext/js')], {
    encoding: 'utf8',
  }).trim();
  writeFileSync(join(folder, 'package.json'), '{"private": true, "type": "module"}');
  const options = ['--silent', '--offline', '--no-audit', '--no-fund', '--legacy-peer-deps'];
  execFileSync('npm', ['install', ...options, join(folder, tarball)], { cwd: folder, stdio: 'inherit' });
  const engines = join(root, 'tests/node_modules');
  for (const name of ['three', '@babylonjs', '@gltf-transform', 'playcanvas', 'property-graph'])
    symlinkSync(join(engines, name), join(folder, 'node_modules', name));
}

/** Imports as an application in this folder would. */
export function importIn(folder, name) {
  const entry = join(folder, `${name.replace(/\W/g, '_')}.mjs`);
  writeFileSync(entry, `export * from '${name}';\n`);
  return import(pathToFileURL(entry).href);
}

/** A PlayCanvas application that draws nothing and reads no pictures. */
export function newPlayCanvas(pc) {
  const canvas = { addEventListener() {}, removeEventListener() {} };
  const app = new pc.AppBase(canvas);
  const options = new pc.AppOptions();
  options.graphicsDevice = new pc.NullGraphicsDevice(canvas);
  options.componentSystems = [pc.RenderComponentSystem, pc.AnimComponentSystem];
  options.resourceHandlers = [pc.ContainerHandler, pc.AnimationHandler];
  app.init(options);
  return app;
}

// The plug-ins in Node: the package as npm packs and installs it, in three.js, Babylon.js and glTF-Transform.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { measureBabylon, measurePlayCanvas, measureThree, playCanvasModel } from './measure.mjs';
import {
  channels,
  compressed,
  importIn,
  installPackage,
  largestDifference,
  newPlayCanvas,
  noTool,
  readGlb,
  runTool,
  sample,
  scratch,
} from './support.mjs';

const tolerance = 0.001;
const allowed = tolerance + 1e-4;
let folder;
let files;

const load = (name) => importIn(folder, name);

function checkMeasured({ clips, difference, motion }) {
  assert.equal(clips, 9);
  assert.ok(motion > 0.1, 'nothing moves');
  assert.ok(difference > 0 && difference <= allowed, `${difference}`);
}

before(async () => {
  folder = mkdtempSync(join(scratch, 'consumer-'));
  installPackage(folder);
  const { registerGLTFExtension } = await load('@babylonjs/loaders/glTF/2.0/index.js');
  const { EXTENSION, nmcExtension } = await load('gltf-nmc/babylon');
  registerGLTFExtension(EXTENSION, true, nmcExtension);
  if (noTool) return;
  files = [sample('humanoid_30hz.glb'), compressed(sample('humanoid_30hz.glb'), '--tolerance', '0.1%', '--effort', '1')];
});

after(() => rmSync(folder, { recursive: true, force: true }));

test('the packed package holds what it needs and nothing else', async () => {
  const names = readdirSync(join(folder, 'node_modules/gltf-nmc')).sort();
  assert.deepEqual(names, ['LICENSE', 'README.md', 'bin', 'package.json', 'src']);
  assert.deepEqual(Object.keys(await load('gltf-nmc')).sort(), ['NmcError', 'expand', 'expandJson', 'openSet']);
});

for (const streaming of [false, true]) {
  test(`three.js plays a compressed file${streaming ? ', evaluating while playing' : ''}`, { skip: noTool }, async () => {
    const three = await load('three');
    const { GLTFLoader } = await load('three/addons/loaders/GLTFLoader.js');
    const { nmcPlugin } = await load('gltf-nmc/three');
    const [original, other] = await Promise.all(
      files.map((file) => {
        const bytes = readFileSync(file);
        return new GLTFLoader()
          .register(nmcPlugin({ streaming }))
          .parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), '');
      }),
    );
    original.animations.forEach(({ duration }, i) => assert.equal(other.animations[i].duration, duration));
    checkMeasured(measureThree(three, original, other));
    const keys = other.animations[0].tracks.reduce((sum, { times }) => sum + times.length, 0);
    assert.ok(streaming ? keys <= 2 * other.animations[0].tracks.length : keys > 1000);
  });
}

test('Babylon.js plays a compressed file', { skip: noTool }, async () => {
  const { NullEngine } = await load('@babylonjs/core/Engines/nullEngine.js');
  const { Scene } = await load('@babylonjs/core/scene.js');
  const { LoadAssetContainerAsync } = await load('@babylonjs/core/Loading/sceneLoader.js');
  const scene = new Scene(new NullEngine());
  const containers = [];
  for (const file of files)
    containers.push(await LoadAssetContainerAsync(new Uint8Array(readFileSync(file)), scene, { pluginExtension: '.glb' }));
  for (const container of containers) container.addAllToScene();
  checkMeasured(measureBabylon(...containers));
  scene.getEngine().dispose();
});

test('PlayCanvas plays a compressed file that was expanded', { skip: noTool }, async () => {
  const pc = await load('playcanvas/build/playcanvas.mjs');
  const { expand } = await load('gltf-nmc');
  const app = newPlayCanvas(pc);
  const models = files.map((file) => {
    // Resources with the same address are loaded once.
    const asset = new pc.Asset('character', 'container', { url: file, contents: expand(new Uint8Array(readFileSync(file))) });
    app.assets.add(asset);
    app.assets.load(asset);
    return playCanvasModel(app, asset);
  });
  checkMeasured(measurePlayCanvas(...(await Promise.all(models))));
  app.destroy();
});

/** Every way to read a compressed file, with a choice of the decoder. Each gives the number of channels of the first animation. */
async function readers(bytes) {
  const { expand, expandJson } = await load('gltf-nmc');
  const { GLTFLoader } = await load('three/addons/loaders/GLTFLoader.js');
  const { nmcPlugin } = await load('gltf-nmc/three');
  const { registerGLTFExtension } = await load('@babylonjs/loaders/glTF/2.0/index.js');
  const { EXTENSION, nmcExtension, nmcExtensionWith } = await load('gltf-nmc/babylon');
  const { LoadAssetContainerAsync } = await load('@babylonjs/core/Loading/sceneLoader.js');
  const { NullEngine } = await load('@babylonjs/core/Engines/nullEngine.js');
  const { Scene } = await load('@babylonjs/core/scene.js');
  const { WebIO } = await load('@gltf-transform/core');
  const { NMCAnimationCompression } = await load('gltf-nmc/gltf-transform');
  const { json, bin } = readGlb(bytes);
  const transform = async (Extension) => {
    const document = await new WebIO().registerExtensions([Extension]).readBinary(bytes);
    return document.getRoot().listAnimations()[0].listChannels().length;
  };
  return {
    expand: async (decoder) => readGlb(expand(bytes, { decoder })).json.animations[0].channels.length,
    expandJson: async (decoder) => expandJson(json, [bin], { decoder }).animations[0].channels.length,
    'three.js': async (decoder) =>
      (await new GLTFLoader().register(nmcPlugin({ decoder })).parseAsync(bytes.slice().buffer, '')).animations[0].tracks.length,
    async 'Babylon.js'(decoder) {
      registerGLTFExtension(EXTENSION, true, nmcExtensionWith({ decoder }));
      try {
        const container = await LoadAssetContainerAsync(bytes, new Scene(new NullEngine()), { pluginExtension: '.glb' });
        return container.animationGroups[0].targetedAnimations.length;
      } catch (error) {
        throw error.innerError ?? error;
      } finally {
        registerGLTFExtension(EXTENSION, true, nmcExtension);
      }
    },
    async 'glTF-Transform'(decoder) {
      const before = NMCAnimationCompression.decoder;
      NMCAnimationCompression.decoder = decoder;
      try {
        return await transform(NMCAnimationCompression);
      } finally {
        NMCAnimationCompression.decoder = before;
      }
    },
    'glTF-Transform, with a class of its own': (decoder) =>
      transform(
        class extends NMCAnimationCompression {
          static decoder = decoder;
        },
      ),
  };
}

test('every reader takes each decoder, and refuses one that there is not in the same words', { skip: noTool }, async () => {
  const { Instance } = WebAssembly;
  let instances = 0;
  WebAssembly.Instance = class extends Instance {
    constructor(...what) {
      super(...what);
      ++instances;
    }
  };
  try {
    for (const [name, read] of Object.entries(await readers(new Uint8Array(readFileSync(files[1]))))) {
      for (const decoder of [undefined, 'auto', 'js', 'wasm']) {
        instances = 0;
        assert.equal(await read(decoder), 53, `${name}, ${decoder}`);
        assert.equal(instances, decoder === 'js' ? 0 : 1, `${name}, ${decoder}`);
      }
      await assert.rejects(() => read('fast'), { name: 'NmcError', code: 'argument', message: 'there is no decoder fast' }, name);
    }
  } finally {
    WebAssembly.Instance = Instance;
  }
});

test('glTF-Transform reads a compressed file and writes a plain one', { skip: noTool }, async () => {
  const { WebIO } = await load('@gltf-transform/core');
  const { NMCAnimationCompression } = await load('gltf-nmc/gltf-transform');
  const io = new WebIO().registerExtensions([NMCAnimationCompression]);
  const document = await io.readBinary(new Uint8Array(readFileSync(files[1])));
  const written = await io.writeBinary(document);
  assert.equal(readGlb(written).json.extensionsUsed, undefined);
  const decoded = join(folder, 'decoded.glb');
  runTool('decode', files[1], decoded);
  const expected = channels(readFileSync(decoded));
  const actual = channels(written);
  assert.equal(actual.length, expected.length);
  const nodeNames = [readFileSync(decoded), written].map((bytes) => readGlb(bytes).json.nodes.map(({ name }) => name));
  expected.forEach((animation, i) => {
    assert.equal(actual[i].channels.size, animation.channels.size);
    for (const [target, { times, values }] of animation.channels) {
      const [path, node] = target.split(' ');
      const other = actual[i].channels.get(`${path} ${nodeNames[1].indexOf(nodeNames[0][node])}`);
      assert.deepEqual(other.times, times);
      assert.ok(largestDifference(values, other.values) <= 1e-5);
    }
  });
  // The tool's own measure of the error, which sees the file only.
  writeFileSync(join(folder, 'written.glb'), written);
  runTool('verify', files[0], join(folder, 'written.glb'), '--tolerance', '0.1%');
});

for (const option of ['--optional', '--fallback']) {
  test(`a file written with ${option} in every loader`, { skip: noTool }, async () => {
    const original = sample('quadruped_30hz.glb');
    const file = compressed(original, '--tolerance', '5%', '--effort', '1', option);
    const bytes = readFileSync(file);
    const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
    const fallback = option === '--fallback';
    const { GLTFLoader } = await load('three/addons/loaders/GLTFLoader.js');
    const { nmcPlugin } = await load('gltf-nmc/three');
    const without = await new GLTFLoader().parseAsync(buffer.slice(0), '');
    const plugged = await new GLTFLoader().register(nmcPlugin()).parseAsync(buffer.slice(0), '');
    assert.equal(without.animations[0].tracks.length, fallback ? plugged.animations[0].tracks.length : 1);
    assert.equal(without.animations[0].duration, plugged.animations[0].duration);
    assert.ok(plugged.animations[0].tracks.length > 30);

    const { expand } = await load('gltf-nmc');
    const plain = channels(new Uint8Array(expand(bytes)));
    const { WebIO } = await load('@gltf-transform/core');
    const { NMCAnimationCompression } = await load('gltf-nmc/gltf-transform');
    const document = await new WebIO().registerExtensions([NMCAnimationCompression]).readBinary(new Uint8Array(bytes));
    const { LoadAssetContainerAsync } = await load('@babylonjs/core/Loading/sceneLoader.js');
    const { NullEngine } = await load('@babylonjs/core/Engines/nullEngine.js');
    const { Scene } = await load('@babylonjs/core/scene.js');
    const container = await LoadAssetContainerAsync(new Uint8Array(bytes), new Scene(new NullEngine()), { pluginExtension: '.glb' });
    document
      .getRoot()
      .listAnimations()
      .forEach((animation, i) => {
        assert.equal(animation.listChannels().length, plain[i].channels.size);
        assert.equal(plugged.animations[i].tracks.length, plain[i].channels.size);
        assert.equal(container.animationGroups[i].targetedAnimations.length, plain[i].channels.size);
      });
    // The original keys, to the bit.
    if (fallback) assert.deepEqual(plain, channels(readFileSync(original)));
  });
}

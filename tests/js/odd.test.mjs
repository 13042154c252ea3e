// Valid but unusual files that nobody here wrote, in three.js: what comes out of compress, and out of decode after it, plays as the input does.
import assert from 'node:assert/strict';
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync } from 'node:fs';
import { basename, dirname, extname, join, relative } from 'node:path';
import { after, before, test } from 'node:test';
import { importIn, installPackage, noShared, noTool, readGlb, runTool, scratch, sharedFile } from './support.mjs';

const timesPerClip = 20;
const pointsPerMesh = 30;
const folder = sharedFile('odd');
const files = existsSync(folder)
  ? readdirSync(folder, { recursive: true })
      .filter((name) => ['.glb', '.gltf'].includes(extname(name)))
      .sort()
      .map((name) => join(folder, name))
  : [];
let made;
let three;
let newLoader;

/** What three.js reports while it reads a URI; Node has none. */
globalThis.ProgressEvent ??= class extends Event {
  constructor(type, fields) {
    super(type);
    Object.assign(this, fields);
  }
};

before(async () => {
  made = mkdtempSync(join(scratch, 'odd-'));
  installPackage(made);
  three = await importIn(made, 'three');
  const { GLTFLoader } = await importIn(made, 'three/addons/loaders/GLTFLoader.js');
  const { MeshoptDecoder } = await importIn(made, 'three/addons/libs/meshopt_decoder.module.js');
  const { nmcPlugin } = await importIn(made, 'gltf-nmc/three');
  newLoader = () => new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).register(nmcPlugin());
});

after(() => rmSync(made, { recursive: true, force: true }));

/** The document and its buffers, each as bytes or undefined. */
function readAny(file) {
  const folderOf = dirname(file);
  if (extname(file) === '.glb') {
    const { json, bin } = readGlb(readFileSync(file));
    return { json, buffers: json.buffers?.map(({ uri, byteLength }) => (uri ? bytesOf(uri, folderOf) : bin.slice(0, byteLength))) };
  }
  const json = JSON.parse(readFileSync(file, 'utf8'));
  return { json, buffers: json.buffers?.map(({ uri }) => uri && bytesOf(uri, folderOf)) };
}

function bytesOf(uri, folderOf) {
  if (uri.startsWith('data:')) return Buffer.from(uri.slice(uri.indexOf(',') + 1), 'base64');
  return readFileSync(join(folderOf, decodeURIComponent(uri)));
}

/** What GLTFLoader makes of a file without its pictures, which Node cannot show. */
async function load(file) {
  const { json, buffers } = readAny(file);
  for (const name of ['images', 'textures', 'materials', 'samplers']) delete json[name];
  for (const { primitives } of json.meshes ?? []) for (const primitive of primitives) delete primitive.material;
  json.buffers?.forEach((buffer, i) => {
    if (buffers[i]) buffer.uri = `data:application/octet-stream;base64,${Buffer.from(buffers[i]).toString('base64')}`;
  });
  return newLoader().parseAsync(JSON.stringify(json), '');
}

function isPlainRotation({ ValueTypeName, createInterpolant }) {
  return ValueTypeName === 'quaternion' && !createInterpolant.isInterpolantFactoryMethodGLTFCubicSpline;
}

/** Keys of eight bits are not of length one, and three.js would show them as a scale; its spherical interpolation forgets their length. */
function withUnitRotations(clip) {
  for (const { name, values } of clip.tracks.filter(isPlainRotation))
    for (let i = 0; i < values.length; i += 4) {
      const length = Math.hypot(...values.slice(i, i + 4));
      assert.ok(Math.abs(length - 1) < 0.01, name);
      for (let k = i; k < i + 4; ++k) values[k] /= length;
    }
}

function player(gltf) {
  const scene = gltf.scene ?? gltf.scenes[0];
  const meshes = [];
  scene.traverse((object) => object.isMesh && meshes.push(object));
  const mixer = new three.AnimationMixer(scene);
  const point = new three.Vector3();
  return {
    /** World positions of some of each mesh's vertices, morphed and skinned. */
    points(clip, seconds) {
      mixer.stopAllAction();
      const action = mixer.clipAction(clip).setLoop(three.LoopOnce);
      action.clampWhenFinished = true;
      action.reset().play();
      mixer.setTime(seconds);
      scene.updateMatrixWorld(true);
      return meshes.flatMap((mesh) => {
        const count = mesh.geometry.attributes.position.count;
        const step = Math.max(1, Math.floor(count / pointsPerMesh));
        const found = [];
        for (let i = 0; i < count; i += step) found.push(...mesh.getVertexPosition(i, point).applyMatrix4(mesh.matrixWorld).toArray());
        return found;
      });
    },
  };
}

function largestDistance(a, b) {
  assert.equal(a.length, b.length);
  let largest = 0;
  for (let i = 0; i < a.length; i += 3) {
    const distance = Math.hypot(a[i] - b[i], a[i + 1] - b[i + 1], a[i + 2] - b[i + 2]);
    if (!(distance <= largest)) largest = distance;
  }
  return largest;
}

for (const file of files) {
  const name = relative(folder, file);
  test(`three.js plays ${name} as before`, { skip: noTool || noShared('odd') }, async (context) => {
    let original;
    try {
      original = await load(file);
    } catch (error) {
      return context.skip(`three.js does not load the input: ${error.message}`);
    }
    const packed = join(made, `${basename(file)}.packed.glb`);
    const plain = join(made, `${basename(file)}.plain.glb`);
    const { tolerance_world_units: tolerance, size_world_units: size } = JSON.parse(runTool(file, packed, '--effort', '1', '--json'));
    runTool('decode', packed, plain, '--quiet');
    original.animations.forEach(withUnitRotations);
    const before = player(original);
    const others = [];
    for (const made of [packed, plain]) {
      const gltf = await load(made);
      assert.deepEqual(
        gltf.animations.map((clip) => clip.name),
        original.animations.map((clip) => clip.name),
      );
      others.push({ name: basename(made), clips: gltf.animations, player: player(gltf) });
    }
    original.animations.forEach((clip, index) => {
      for (let i = 0; i < timesPerClip; ++i) {
        const seconds = (clip.duration * i) / (timesPerClip - 1);
        const expected = before.points(clip, seconds);
        for (const other of others) {
          const distance = largestDistance(expected, other.player.points(other.clips[index], seconds));
          assert.ok(distance <= tolerance + 1e-4 * size, `${other.name}, ${clip.name} at ${seconds} s: ${distance} against ${tolerance}`);
        }
      }
    });
  });
}

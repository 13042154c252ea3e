// The decoders and expand against the reference decoder: `gltf-nmc decode` runs it. The one in JavaScript shares no code with it.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { test } from 'node:test';
import { expand, openSet } from '../../gltf_ext/js/src/index.js';
import { channels, fixtures, largestDifference, readGlb, runTool, scratch, streams } from './support.mjs';

// The conformance section of gltf_ext/README.md.
const tolerance = 1e-5;
const decoders = ['js', 'wasm'];

const validator = createRequire(import.meta.url)('gltf-validator');

function decodedByTool(file) {
  const out = join(scratch, 'decoded.glb');
  runTool('decode', file, out);
  return readFileSync(out);
}

async function errors(bytes) {
  const { issues } = await validator.validateBytes(new Uint8Array(bytes));
  return issues.messages.filter(({ severity }) => severity === 0);
}

function sameChannels(expected, actual) {
  assert.deepEqual(
    actual.map(({ name }) => name),
    expected.map(({ name }) => name),
  );
  expected.forEach((animation, i) => {
    assert.deepEqual([...actual[i].channels.keys()].sort(), [...animation.channels.keys()].sort(), animation.name);
    for (const [target, { times, values, interpolation }] of animation.channels) {
      const other = actual[i].channels.get(target);
      assert.deepEqual(new Uint32Array(other.times.buffer), new Uint32Array(times.buffer), `key times of ${target} of ${animation.name}`);
      assert.equal(other.interpolation, interpolation);
      const difference = largestDifference(values, other.values);
      assert.ok(difference <= tolerance, `${target} of ${animation.name} differs by ${difference}`);
    }
  });
}

for (const { name, original, file, skip } of fixtures) {
  test(`${name}: expand gives what the reference decoder gives`, { skip }, async () => {
    const bytes = readFileSync(file());
    const [plain, other] = decoders.map((decoder) => new Uint8Array(expand(bytes, { decoder })));
    const expected = channels(decodedByTool(file()));
    for (const one of [plain, other]) sameChannels(expected, channels(one));
    const { json } = readGlb(plain);
    assert.ok(!JSON.stringify(json).includes('NMC_animation_compression'));
    // What is wrong with the original stays wrong.
    assert.deepEqual(await errors(plain), await errors(readFileSync(original())));
  });

  test(`${name}: a pose at a key is that key, between keys it is LINEAR's`, { skip }, () => {
    const sets = streams(readFileSync(file())).flatMap((stream) => decoders.map((decoder) => openSet(stream, { decoder })));
    for (const set of sets) {
      const pose = new Float32Array(set.slots);
      for (const clip of set.clips) {
        const tracks = clip.decode().filter(({ values, times }) => values.length > 0 && times === clip.times);
        for (let n = 0; n < clip.times.length; n += 1 + (n % 3)) {
          clip.evaluate(clip.times[n], pose);
          for (const { target, values } of tracks) {
            const { slot, width, path } = set.targets[target];
            assert.ok(poseDifference(path, values.subarray(n * width, (n + 1) * width), pose.subarray(slot, slot + width)) <= 1e-6);
          }
          if (n + 1 === clip.times.length) continue;
          const u = 0.3;
          clip.evaluate(clip.times[n] * (1 - u) + clip.times[n + 1] * u, pose);
          for (const { target, values } of tracks) {
            const { slot, width, path } = set.targets[target];
            const expected = between(
              path,
              values.subarray(n * width, (n + 1) * width),
              values.subarray((n + 1) * width, (n + 2) * width),
              u,
            );
            // The time above is rounded twice more than the key times.
            assert.ok(poseDifference(path, expected, pose.subarray(slot, slot + width)) <= 1e-4);
          }
        }
      }
    }
  });
}

/** Of a rotation the opposite quaternion is the same. */
function poseDifference(path, expected, actual) {
  const difference = largestDifference(expected, actual);
  if (path !== 'rotation') return difference;
  return Math.min(difference, largestDifference(expected.map((value) => -value), actual));
}

/** What glTF's appendix C says, in the plainest words. */
function between(path, a, b, u) {
  if (path !== 'rotation') return a.map((value, i) => value * (1 - u) + b[i] * u);
  const dot = a.reduce((sum, value, i) => sum + value * b[i], 0);
  const angle = Math.acos(Math.min(Math.abs(dot), 1));
  if (angle < 1e-4) return a.map((value, i) => value * (1 - u) + Math.sign(dot) * b[i] * u);
  return a.map((value, i) => (value * Math.sin((1 - u) * angle) + Math.sign(dot) * b[i] * Math.sin(u * angle)) / Math.sin(angle));
}

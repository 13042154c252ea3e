// The streams of tests/golden, which the C decoder reads in tests/codec/golden_test.cpp: the good ones say what closed forms say, the bad ones
// are refused with the code that their names begin with. Both decoders of the package.
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { NmcError, openSet } from '../../gltf_ext/js/src/index.js';
import { badStreams } from '../golden/make_bad.mjs';
import { largestDifference, root } from './support.mjs';

// The conformance section of gltf_ext/README.md.
const tolerance = 1e-5;

const folder = join(root, 'tests/golden');
const list = (kind, suffix) => readdirSync(join(folder, kind)).filter((name) => name.endsWith(suffix));
const read = (kind, name) => new Uint8Array(readFileSync(join(folder, kind, name)));

/** Code to sentence, from the table "Refusals" of the specification. */
const specification = readFileSync(join(root, 'gltf_ext/README.md'), 'utf8');
const sentences = new Map([...specification.matchAll(/^\| `(\w+)` \| \d \| (.*?) \|/gm)].map(([, code, sentence]) => [code, sentence]));

const decoders = ['js', 'wasm'];
const each = (kind) => list(kind, '.nmc').flatMap((file) => decoders.map((decoder) => ({ file, decoder })));

for (const { file, decoder } of each('good')) {
  test(`good: ${file}, ${decoder}`, () => {
    const expected = JSON.parse(readFileSync(join(folder, 'good', file.replace('.nmc', '.json')), 'utf8'));
    const set = openSet(read('good', file), { decoder });
    assert.deepEqual(set.targets.map(({ path, width }) => ({ path, width })), expected.targets);
    assert.equal(set.clips.length, expected.clips.length);
    const pose = new Float32Array(set.slots);
    expected.clips.forEach(({ times, states, poses }, i) => {
      const clip = set.clips[i];
      assert.deepEqual([...clip.times], times);
      assert.deepEqual([...clip.states], states);
      for (const { seconds, values } of poses) {
        const difference = largestDifference(values, clip.evaluate(seconds, pose));
        assert.ok(difference <= tolerance, `clip ${i} at ${seconds} differs by ${difference}`);
      }
    });
  });
}

for (const { file, decoder } of each('bad')) {
  test(`bad: ${file}, ${decoder}`, () => {
    const [, code] = /^([a-z]+)/.exec(file);
    assert.ok(sentences.has(code));
    assert.throws(
      () => openSet(read('bad', file), { decoder }),
      (error) => {
        assert.ok(error instanceof NmcError);
        assert.equal(error.code, code, error.detail);
        assert.equal(error.message, sentences.get(code));
        assert.ok(error.detail.length > 0);
        return true;
      },
    );
  });
}

test('every code of a stream has a bad stream, and every bad stream is in the tree as it was', () => {
  const files = list('bad', '.nmc');
  for (const code of sentences.keys()) assert.ok(code === 'argument' || files.some((file) => file.startsWith(code)), code);
  const made = badStreams();
  assert.deepEqual(Object.keys(made).map((name) => `${name}.nmc`).sort(), files.sort());
  for (const [name, bytes] of Object.entries(made)) assert.deepEqual(read('bad', `${name}.nmc`), Uint8Array.from(bytes), name);
});

// The decoder in WebAssembly against the one in JavaScript, which shares no code with it; who is chosen; and that the binary in the tree is what
// its source gives.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { openSet } from '../../gltf_ext/js/src/index.js';
import { RUNS, readDecisions } from '../../gltf_ext/js/src/payload.js';
import { Encoder, sign, stream } from './encoder.mjs';
import { compressed, largestDifference, noTool, root, sample, scratch, streams } from './support.mjs';

// The conformance section of gltf_ext/README.md. Each decoder is as far from the truth.
const tolerance = 2e-5;

const golden = join(root, 'tests/golden/good');
const readGolden = (name) => new Uint8Array(readFileSync(join(golden, name)));
const humanoid = () => streams(readFileSync(compressed(sample('humanoid_30hz.glb'), '--tolerance', '0.1%', '--effort', '1')))[0];
const paper = ['--profile', 'paper', '--max-frequencies', '3', '--tolerance', '5%'];
const inputs = [
  ...readdirSync(golden)
    .filter((name) => name.endsWith('.nmc'))
    .map((name) => ({ name, skip: false, read: () => readGolden(name) })),
  { name: 'humanoid', skip: noTool, read: humanoid },
  { name: 'network', skip: noTool, read: () => streams(readFileSync(compressed(sample('quadruped_30hz.glb'), ...paper)))[0] },
];

/** A generator of numbers from 0 to 1; always the same. */
function random() {
  let state = 1;
  return () => (state = (state * 48271) % 2147483647) / 2147483647;
}

const both = (bytes) => ['js', 'wasm'].map((decoder) => openSet(bytes, { decoder }));

/** The stream with more of the zeros that stand behind every stream anyway. */
const longer = (bytes) => sign([...bytes, ...new Uint8Array(512)]);

/** At a time, in both: a pose that was there before must not shine through. */
function samePose(clips, seconds) {
  const poses = clips.map((clip, i) => clip.evaluate(seconds, new Float32Array(clip.slots).fill(i)));
  const difference = largestDifference(...poses);
  assert.ok(difference <= tolerance, `at ${seconds} they differ by ${difference}`);
}

for (const { name, skip, read } of inputs) {
  test(`${name}: both decoders give the same keys`, { skip }, () => {
    const [js, wasm] = both(read());
    assert.deepEqual(wasm.targets, js.targets);
    assert.equal(wasm.slots, js.slots);
    assert.equal(wasm.clips.length, js.clips.length);
    js.clips.forEach((clip, c) => {
      const other = wasm.clips[c];
      for (const property of ['slots', 'times', 'states', 'end']) assert.deepEqual(other[property], clip[property], property);
      const tracks = [clip, other].map((one) => one.decode());
      assert.deepEqual(tracks[1].map(({ target }) => target), tracks[0].map(({ target }) => target));
      tracks[0].forEach(({ times, values }, i) => {
        assert.deepEqual(tracks[1][i].times, times);
        assert.equal(tracks[1][i].times === other.times, times === clip.times);
        const difference = largestDifference(values, tracks[1][i].values);
        assert.ok(difference <= tolerance, `track ${i} differs by ${difference}`);
      });
    });
  });

  test(`${name}: both decoders give the same poses, at any times in any order of clips`, { skip }, () => {
    const [js, wasm] = both(read());
    const next = random();
    for (let i = 0; i < 300; ++i) {
      const c = Math.floor(next() * js.clips.length);
      const [begin] = js.clips[c].times;
      const length = js.clips[c].end - begin;
      samePose([js.clips[c], wasm.clips[c]], begin + (next() * 1.2 - 0.1) * length);
      // Playing on from there: what was evaluated before is used again.
      for (let k = 1; k < 5; ++k) samePose([js.clips[c], wasm.clips[c]], begin + ((i + k / 5) % 1) * length);
    }
    js.clips.forEach((clip, c) => {
      for (const seconds of [-Infinity, Infinity, ...clip.times.slice(0, 10)]) samePose([clip, wasm.clips[c]], seconds);
    });
  });
}

/** One target of morph weights that go from their references, all 0, up to a number of steps of their own over all samples. */
function manyWeights(width, samples) {
  const slots = Array.from({ length: width }, (_, a) => a);
  const flags = [0, 0, 0];
  const target = [3, width, slots.map(() => [0, 0])];
  const clip = [samples, [0, 0, 10], 1, 2, 1, 2, 0, slots.map(() => 0), slots.map((a) => a % 7), 0, 0];
  const encoder = new Encoder([flags, 0.5, 0, target, clip].flat(Infinity), RUNS);
  const header = { slots: width, targets: 1, clips: 1, samples, windows: 1, anchors: 2 * width, weights: 0, atoms: 0, maxFeatures: 0, dense: 0 };
  readDecisions(encoder, header);
  return stream(Object.values(header), encoder.finish());
}

test('more keys than one call of the module decodes', () => {
  for (const [width, samples] of [
    [20000, 8],
    [65535, 3],
    [3, 30000],
  ]) {
    const [{ values }] = openSet(manyWeights(width, samples), { decoder: 'wasm' }).clips[0].decode();
    assert.equal(values.length, width * samples);
    for (let n = 0; n < samples; ++n)
      for (const a of [0, 1, 2, width >> 1, width - 1]) {
        const expected = ((a % 7) * 0.5 * n) / (samples - 1);
        assert.ok(Math.abs(values[n * width + a] - expected) <= tolerance, `${a} at ${n}: ${values[n * width + a]}, not ${expected}`);
      }
  }
});

test('many sets at once do not disturb each other', () => {
  const files = inputs.filter(({ skip, name }) => !skip && name.endsWith('.nmc'));
  const sets = Array.from({ length: 200 }, (_, i) => both(files[i % files.length].read()));
  for (const [js, wasm] of sets) js.clips.forEach((clip, c) => samePose([clip, wasm.clips[c]], clip.end / 3));
  for (const [js, wasm] of sets.reverse()) js.clips.forEach((clip, c) => samePose([clip, wasm.clips[c]], clip.end / 2));
});

test('arguments are checked', () => {
  const bytes = readGolden('times_rate.nmc');
  assert.throws(() => openSet(bytes, { decoder: 'fast' }), { name: 'NmcError', code: 'argument' });
  assert.throws(() => openSet([78, 77, 67], { decoder: 'wasm' }), { name: 'NmcError', code: 'argument' });
  const [clip] = openSet(bytes, { decoder: 'wasm' }).clips;
  assert.throws(() => clip.evaluate(0, new Float32Array(1)), { name: 'NmcError', code: 'argument' });
  assert.throws(() => clip.evaluate(NaN, new Float32Array(clip.slots)), { name: 'NmcError', code: 'argument' });
});

test('a broken stream has the same detail whoever finds it', () => {
  const details = ['js', 'wasm'].map((decoder) => {
    try {
      return openSet(Uint8Array.of(78, 77, 67, 1, 0, 0, 0, 0, 1), { decoder });
    } catch (error) {
      return error.detail;
    }
  });
  assert.deepEqual(details, Array(2).fill('the stream ends in its header'));
});

// What a page may find in place of WebAssembly: nothing, a policy that forbids compiling, no address space for an instance.
for (const [name, change] of [
  ['is missing', 'delete globalThis.WebAssembly;'],
  ['may not compile', "WebAssembly.Module = function () { throw new WebAssembly.CompileError('forbidden'); };"],
  ['may not compile so much at once', "WebAssembly.Module = function () { throw new RangeError('too large'); };"],
  ['has no room for an instance', "WebAssembly.Instance = function () { throw new RangeError('out of memory'); };"],
]) {
  test(`JavaScript decodes where WebAssembly ${name}`, () => {
    const bytes = longer(readGolden('sine.nmc'));
    const lines = `import { openSet } from '${join(root, 'gltf_ext/js/src/index.js')}';
      ${change}
      const bytes = Uint8Array.of(${bytes});
      const code = (() => { try { return openSet(bytes, { decoder: 'wasm' }); } catch (error) { return error.code; } })();
      const sets = [{}, { decoder: 'auto' }, { decoder: 'js' }].map((options) => openSet(bytes, options));
      const poses = sets.map(({ slots, clips }) => [...clips[0].evaluate(0.1, new Float32Array(slots))]);
      console.log(JSON.stringify({ code, poses }));`;
    const { code, poses } = JSON.parse(execFileSync(process.execPath, ['--input-type=module', '--eval', lines], { encoding: 'utf8' }));
    assert.equal(code, 'argument');
    const { slots, clips } = openSet(bytes, { decoder: 'js' });
    for (const pose of poses) assert.deepEqual(pose, [...clips[0].evaluate(0.1, new Float32Array(slots))]);
  });
}

test('WebAssembly is chosen for what is not tiny', () => {
  const names = (bytes) => ['auto', 'js', 'wasm'].map((decoder) => openSet(bytes, { decoder }).constructor.name);
  const tiny = readGolden('sine.nmc');
  assert.ok(tiny.length < 512);
  for (const bytes of [tiny, longer(tiny)]) {
    const [auto, js, wasm] = names(bytes);
    assert.notEqual(js, wasm);
    assert.equal(auto, bytes === tiny ? js : wasm);
  }
});

test('the binary is what wasm/build.sh makes', (t) => {
  const made = join(scratch, 'wasm_binary.js');
  const kept = readFileSync(join(root, 'gltf_ext/js/src/wasm_binary.js'), 'utf8');
  const maker = (text) => /clang \d+\.\d+\.\d+/.exec(text)?.[0];
  try {
    const found = maker(execFileSync('clang', ['--version'], { encoding: 'utf8' }).replace('version ', ''));
    if (found !== maker(kept)) return t.skip(`needs ${maker(kept)}, not ${found}`);
    execFileSync('wasm-ld', ['--version']);
  } catch {
    return t.skip('needs clang and wasm-ld (Debian: clang, lld)');
  }
  execFileSync(join(root, 'gltf_ext/js/wasm/build.sh'), [made]);
  assert.equal(readFileSync(made, 'utf8'), kept);
});

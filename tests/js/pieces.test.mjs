// The pieces of the decoder against closed forms: the range coder, numbers, key times, and the poses of streams made by hand.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Decisions } from '../../gltf_ext/js/src/decisions.js';
import { openSet } from '../../gltf_ext/js/src/index.js';
import { RUNS, readDecisions } from '../../gltf_ext/js/src/payload.js';
import { exponential, fillFeatures, lastAtOrBefore, multiply, slerp } from '../../gltf_ext/js/src/pose.js';
import { Encoder, stream } from './encoder.mjs';

const close = (actual, expected, tolerance = 1e-6) =>
  Array.from(expected, (value, i) => assert.ok(Math.abs(value - actual[i]) <= tolerance, `${i}: ${actual[i]}, not ${value}`));

/** A generator of numbers from 0 to 1; always the same. */
function random() {
  let state = 1;
  return () => (state = (state * 48271) % 2147483647) / 2147483647;
}

test('raw bits are the bits of the stream, inverted: half of the range is one shift', () => {
  const bytes = Uint8Array.of(0xa5, 0x00, 0xff, 0x12, 0x34, 0x56, 0x78, 0x9a);
  const decisions = new Decisions(bytes, 0, 1);
  assert.equal(decisions.raw(32), ~0xa500ff12 >>> 0);
  assert.equal(decisions.raw(16), ~0x3456 & 0xffff);
});

test('one decision, by hand', () => {
  // p = 49152: the lowest three quarters of the codes are a 1.
  for (const [code, bit] of [[0x00000000, 1], [0xbfffffff, 1], [0xc0000000, 0], [0xffffffff, 0]]) {
    const decisions = new Decisions(Uint8Array.of(code >>> 24, (code >>> 16) & 255, (code >>> 8) & 255, code & 255), 0, 1);
    assert.equal(decisions.decide(49152), bit, code.toString(16));
  }
});

test('a model learns at the rate 1 / (n + 1.5) and stays within its bounds', () => {
  const decisions = new Decisions(new Uint8Array(4), 0, 1);
  let p = 32768;
  let n = 0;
  for (let i = 0; i < 400; ++i) {
    assert.equal(decisions.plain(0), 1);
    p = Math.min(p + Math.floor(((65535 - p) * Math.floor(131072 / (2 * n + 3))) / 65536), 65503);
    n = Math.min(n + 1, 30);
    assert.equal(decisions.models[0] >> 8, p);
  }
  assert.equal(p, 65503);
});

test('numbers come back, mixed of any models', () => {
  const next = random();
  const calls = Array.from({ length: 3000 }, () => {
    const count = [1, 2, 3, 6][Math.floor(next() * 4)];
    const value = Math.floor(2 ** (next() * 22)) - 1;
    const runs = Array.from({ length: count }, () => Math.floor(next() * 8));
    return { count, value: next() < 0.5 ? value : -value, runs, group: Math.floor(next() * 6) };
  });
  const run = (decisions) => calls.map(({ count, runs, group }) => (decisions.runs.set(runs), decisions.signed(group, count, 0)));
  const encoder = new Encoder(calls.map(({ value }) => value), 8);
  const expected = calls.map(({ value }) => value + 0);
  assert.deepEqual(run(encoder).map((value) => value + 0), expected);
  assert.deepEqual(run(new Decisions(Uint8Array.from(encoder.finish()), 0, 8)).map((value) => value + 0), expected);
});

test('simple numbers have up to 32 bits, and signs in the lowest', () => {
  const numbers = [0, 1, 2, 3, 255, 65535, 2 ** 31, 2 ** 32 - 1];
  const signed = [0, -1, 1, -2, 2, 2 ** 31 - 1, -(2 ** 31)];
  const read = (decisions) => [...numbers.map(() => decisions.simple(0)), ...signed.map(() => decisions.simpleSigned(1))];
  const encoder = new Encoder([...numbers, ...signed], 2);
  read(encoder);
  assert.deepEqual(read(new Decisions(Uint8Array.from(encoder.finish()), 0, 2)), [...numbers, ...signed]);
});

test('exp of a vector is the rotation about it by its length', () => {
  const q = [0, 0, 0, 0];
  exponential([0, 0, 0], 0, q);
  assert.deepEqual(q, [0, 0, 0, 1]);
  exponential([0, Math.PI / 2, 0], 0, q);
  close(q, [0, Math.SQRT1_2, 0, Math.SQRT1_2], 1e-15);
  exponential([9, 3e-5, -4e-5, 0], 1, q);
  close(q, [0.6 * Math.sin(2.5e-5), -0.8 * Math.sin(2.5e-5), 0, Math.cos(2.5e-5)], 1e-16);
  const two = [0, 0, 0, 0];
  multiply(q, 0, q, two, 0);
  exponential([6e-5, -8e-5, 0], 0, q);
  close(two, q, 1e-15);
});

test('slerp turns evenly on the short arc', () => {
  const about = (angle) => [0, 0, Math.sin(angle / 2), Math.cos(angle / 2)];
  const out = [0, 0, 0, 0];
  for (const angle of [1e-7, 1e-3, 0.5, 2, 3.1]) {
    slerp(about(0.2), about(0.2 + angle), 0, 0.25, out);
    close(out, about(0.2 + angle / 4), 1e-12);
    slerp(about(0.2), about(0.2 + angle).map((value) => -value), 0, 0.25, out);
    close(out, about(0.2 + angle / 4), 1e-12);
  }
});

test('features are the cosines and sines of A.5', () => {
  const count = 65535;
  const features = new Float64Array(count + 2);
  for (const [L, m] of [[1, 0], [7, 3], [100, 99], [1000003, 77]]) {
    const bases = [
      (j) => Math.cos((Math.PI * ((j * (2 * m + 1)) % (4 * L))) / (2 * L)),
      (j) => (j % 2 ? Math.cos((Math.PI * (((j + 1) * m) % (2 * L))) / L) : Math.sin((Math.PI * ((j * m) % (2 * L))) / L)),
      (j) => Math.sin((Math.PI * ((j * m) % (2 * L))) / L),
    ];
    bases.forEach((f, basis) => {
      fillFeatures(basis, count, m, L, features);
      for (const j of [1, 2, 3, 10, 1001, 65535]) assert.ok(Math.abs(features[j] - f(j)) < 1e-9, `basis ${basis}, j ${j}, m ${m}, L ${L}`);
    });
  }
});

test('a search finds the last value at or before', () => {
  for (let count = 1; count < 9; ++count) {
    const values = Array.from({ length: count }, (_, i) => 2 * i);
    for (let value = -1; value < 2 * count; ++value) assert.equal(lastAtOrBefore(values, count, value), Math.max(Math.floor(value / 2), 0));
  }
});

// Streams by hand. Counts: slots, targets, clips, samples, windows, anchors, weights, atoms, max_features, dense.
const names = ['slots', 'targets', 'clips', 'samples', 'windows', 'anchors', 'weights', 'atoms', 'maxFeatures', 'dense'];
names.push('hidden0', 'hidden1', 'maxFrequencies');

function make(counts, numbers, decoder = 'js') {
  const header = Object.fromEntries(names.map((name, i) => [name, counts[i] ?? 0]));
  const encoder = new Encoder(numbers.flat(Infinity), RUNS);
  readDecisions(encoder, header);
  return openSet(stream(counts, encoder.finish()), { decoder });
}

const plain = [0, 0, 0];
const baseStep = 0.5;
// One translation whose reference is (2, 4, 6) steps, with the step exponents 0, 2, 2: steps 1/2, 1/4, 1/4.
const translation = [0, 0, 2, 2, 4, 0, 6];
const reference = [1, 1, 1.5];
const set = [plain, baseStep, 0, translation];
const still = [0, 1, 0, [4, -8, 0]];
const stillPose = [reference[0] + 2, reference[1] - 2, reference[2]];
const everyTenth = [0, 0, 10, 1];
const end = [0, 0];

test('key times, bit for bit', () => {
  const f = Math.fround;
  const step = f(0.1);
  const double = 1 / 29.97;
  const cases = [
    [[0, 3, 30], [0, 1, 2].map((n) => f((3 + n) / 30))],
    [[1, -1, step], [0, 1, 2].map((n) => f(f(-1 + n) * step))],
    [[2, f(0.7), double], [0, 1, 2].map((n) => f(f(0.7) + n * double))],
    [[3, f(0.7), step], [f(0.7), f(f(0.7) + step), f(f(f(0.7) + step) + step)]],
  ];
  for (const [formula, expected] of cases) {
    const { times } = make([3, 1, 1, 3, 1, 3, 0, 0, 0, 0], [set, 3, formula, 1, still, end]).clips[0];
    assert.deepEqual([...times], expected);
  }
  // Corrected by the next float after, the same, the one before; in the last form the correction runs on.
  const next = (x, d) => new Float32Array(Int32Array.of(new Int32Array(Float32Array.of(x).buffer)[0] + d).buffer)[0];
  const second = f(next(f(0.7), 1) + step);
  const last = make([3, 1, 1, 3, 1, 3, 0, 0, 0, 0], [set, 3, [3, f(0.7), step], 0, 1, 0, -1, still, end]).clips[0];
  assert.deepEqual([...last.times], [next(f(0.7), 1), second, next(f(second + step), -1)]);
  // Around 0 the order of floats goes on.
  const zero = make([3, 1, 1, 2, 1, 3, 0, 0, 0, 0], [set, 2, [0, 0, 1], 0, -1, 1, still, end]).clips[0];
  assert.deepEqual([...zero.times], [-(2 ** -149), next(1, 1)]);
  assert.throws(() => make([3, 1, 1, 2, 1, 3, 0, 0, 0, 0], [set, 2, [1, 0, 0], 1, still, end]), { code: 'corrupt' });
});

test('a constant clip is the reference and its anchors', () => {
  const clip = make([3, 1, 1, 3, 1, 3, 0, 0, 0, 0], [set, 3, everyTenth, still, end]).clips[0];
  close(clip.evaluate(0.15, new Float32Array(3)), stillPose);
  const [track] = clip.decode();
  assert.deepEqual([...track.times], [0, Math.fround(0.2)]);
  close(track.values, [...stillPose, ...stillPose]);
});

test('a second clip guesses from the first, and absent targets are the reference', () => {
  const second = [2, 1, 1, [0, 1, 0, [1, 0, 0]], end];
  const third = [2, 1, 1, [0, 0, 0], end];
  const { clips } = make([3, 1, 3, 6, 3, 6, 0, 0, 0, 0], [set, 2, everyTenth, still, end, second, third]);
  close(clips[1].evaluate(0, new Float32Array(3)), [stillPose[0] + 0.5, stillPose[1], stillPose[2]]);
  close(clips[2].evaluate(0, new Float32Array(3)), reference);
  assert.deepEqual(clips[2].decode(), []);
});

test('weights in all bases and windows', () => {
  const L = (basis, samples) => (basis === 0 ? samples : samples - 1);
  const levels = [3, 0, -2];
  const bases = [
    (j, m, length) => Math.cos((Math.PI * j * (2 * m + 1)) / (2 * length)),
    (j, m, length) => (j % 2 ? Math.cos((Math.PI * (j + 1) * m) / length) : Math.sin((Math.PI * j * m) / length)),
    (j, m, length) => Math.sin((Math.PI * j * m) / length),
  ];
  bases.forEach((f, basis) => {
    const samples = 6;
    const rows = basis === 0 ? 1 : 2;
    const windows = basis === 2 ? [1] : [];
    // Anchors 0, then one step up in x over the window. Weights in y alone, at the step exponent 4: half a step.
    const anchors = [[0, 0, 0], ...(rows > 1 ? [[1, 0, 0]] : [])];
    const numbers = [set, samples, everyTenth, basis, windows, 2, 0, anchors, 4, [0, 3, levels, 0], 0];
    const clip = make([3, 1, 1, samples, 1, 3 * rows, 2, 0, 3, 0], numbers).clips[0];
    const [{ values }] = clip.decode();
    for (let n = 0; n < samples; ++n) {
      const length = L(basis, samples);
      const wave = levels.reduce((sum, level, i) => sum + level * f(i + 1, n, length), 0) * 0.25 * 0.5 * Math.sqrt(2 / length);
      const ramp = rows > 1 ? (n / length) * 0.5 : 0;
      close(values.subarray(3 * n, 3 * n + 3), [reference[0] + ramp, reference[1] + wave, reference[2]]);
    }
  });
});

test('several windows, even and of given lengths', () => {
  for (const [even, begins] of [[1, [0, 2, 5]], [[0, 3], [0, 3, 5]]]) {
    const anchors = [[0, 0, 0], [2, 0, 0], [2, 0, 0]];
    const weights = [0, [0, 0, 0], [1, 4, 0, 0]];
    const clip = make([3, 1, 1, 6, 2, 9, 1, 0, 1, 0], [set, 6, everyTenth, 2, 2, even, 2, 0, anchors, weights, 0]).clips[0];
    const [{ values }] = clip.decode();
    for (let n = 0; n < 6; ++n) {
      const k = n < begins[1] ? 0 : 1;
      const length = begins[k + 1] - begins[k];
      const m = n - begins[k];
      const wave = k === 1 ? 4 * 0.5 * Math.sqrt(2 / length) * Math.sin((Math.PI * m) / length) : 0;
      close(values.subarray(3 * n, 3 * n + 1), [reference[0] + (k + m / length) + wave]);
    }
  }
});

test('atoms are raised cosines around their sample', () => {
  const atoms = [2, [5, 1, 2, 3], [0, 0, 0, -1]];
  const clip = make([3, 1, 1, 12, 1, 3, 0, 2, 0, 0], [set, 12, everyTenth, 0, 2, 0, [0, 0, 0], 0, atoms]).clips[0];
  const [{ values }] = clip.decode();
  for (let n = 0; n < 12; ++n) {
    const d = Math.abs(n - 5);
    const y = d < 4 ? (3 * 0.25 * (1 + Math.cos((Math.PI * d) / 4))) / 2 : 0;
    close(values.subarray(3 * n, 3 * n + 3), [reference[0] + (n === 5 ? -0.5 : 0), reference[1] + y, reference[2]]);
  }
});

test('atoms on what does not move are refused', () => {
  const counts = [3, 1, 1, 12, 1, 3, 0, 1, 0, 0];
  const numbers = (state, level) => [set, 12, everyTenth, 0, state, 0, [0, 0, 0], 0, 1, [5, 1, 2, level]];
  assert.doesNotThrow(() => make(counts, numbers(2, 3)));
  assert.throws(() => make(counts, numbers(1, 3)), { code: 'corrupt' });
  assert.doesNotThrow(() => make(counts, numbers(2, 2 ** 23 - 1)));
  assert.throws(() => make(counts, numbers(2, 2 ** 23)), { code: 'corrupt' });
});

test('rotations: by vectors around an exact reference, and as quaternions', () => {
  const s = Math.SQRT1_2;
  const exact = [1, 0, 0];
  const one = [exact, 0.25, 0, 1, [s, 0, 0, s]];
  const counts = [4, 1, 1, 2, 1, 3, 0, 0, 0, 0];
  const vector = make(counts, [one, 2, everyTenth, 0, 1, 0, [2, 0, 0], end]).clips[0];
  const angle = Math.PI / 2 + 0.5;
  close(vector.evaluate(0, new Float32Array(4)), [Math.sin(angle / 2), 0, 0, Math.cos(angle / 2)]);
  counts[5] = 4;
  const quaternion = make(counts, [one, 2, everyTenth, 0, 3, 0, [0, 3, 0, -4], end]).clips[0];
  close(quaternion.evaluate(0, new Float32Array(4)), [0, 0.6, 0, -0.8]);
  const nothing = make(counts, [one, 2, everyTenth, 0, 3, 0, [0, 0, 0, 0], end]).clips[0];
  close(nothing.evaluate(0, new Float32Array(4)), [0, 0, 0, 1]);
  assert.throws(() => make(counts, [[exact, 0.25, 0, 1, [1, 0, 0, 1]], 2, everyTenth, 0, 3, 0, [0, 0, 0, 0], end]), { code: 'corrupt' });
});

for (const decoder of ['js', 'wasm'])
  test(`keys of neighbouring rotations have one sign, ${decoder}`, () => {
    const s = Math.SQRT1_2;
    // (0, 0, 0, 1), but minus that at the second sample and (0, 0.6, 0, -0.8) at the last.
    const atoms = [3, [1, 3, 0, -8], [2, 1, 0, 3], [0, 3, 0, -8]];
    const numbers = [[[1, 0, 0], 0.25, 0, 1, [s, 0, 0, s]], 4, everyTenth, 0, 3, 0, [0, 0, 0, 4], 0, atoms];
    const [clip] = make([4, 1, 1, 4, 1, 4, 0, 3, 0, 0], numbers, decoder).clips;
    close(clip.evaluate(clip.times[1], new Float32Array(4)), [0, 0, 0, -1]);
    close(clip.decode()[0].values, [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, -0.6, 0, 0.8]);
  });

test('a network, quantised and not', () => {
  const elu = (x) => (x < 0 ? Math.exp(x) - 1 : x);
  const W0 = [2, -3, 1];
  const b0 = [-1];
  const W1 = [4];
  const b1 = [1];
  const W2 = [1, -2, 3];
  const b2 = [0, 1, 0];
  for (const quantized of [0, 1]) {
    const step = quantized ? 0.5 : 1;
    const tensor = (values) => (quantized ? [step, values] : values);
    // Numbers: 3 + 1 + 1 + 1 + 3 + 3, a frequency, and with steps one more for each of the six tensors.
    const counts = [3, 1, 1, 4, 1, 3, 0, 0, 0, 13 + 6 * quantized, 1, 1, 1];
    const tensors = [1, 5, tensor(W0), tensor(b0), 3, tensor(W1), tensor(b1), tensor(W2), tensor(b2)];
    const body = [0, 1, quantized, baseStep, 0, translation, 4, everyTenth, 0, 2, 0, [0, 0, 0], end, tensors];
    const [{ values }] = make(counts, body).clips[0].decode();
    for (let n = 0; n < 4; ++n) {
      const t = n / 3;
      const z = elu(step * (W0[0] * t + W0[1] * Math.sin(5 * Math.PI * t) + W0[2] * Math.cos(5 * Math.PI * t) + b0[0]));
      const a = elu(step * (W1[0] * z + b1[0]));
      close(values.subarray(3 * n, 3 * n + 3), W2.map((w, i) => reference[i] + step * (w * a + b2[i])));
    }
  }
});

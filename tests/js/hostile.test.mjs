// Bytes that nobody should trust: every one of them decodes, or gives an NmcError, soon; the same with both decoders.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { NmcError, expand, expandJson, openSet } from '../../gltf_ext/js/src/index.js';
import { sign, stream as makeStream } from './encoder.mjs';
import { compressed, noTool, readGlb, sample, streams } from './support.mjs';

const seconds = 2;

function outcome(bytes) {
  const code = outcomeOf(bytes, 'js');
  assert.equal(outcomeOf(bytes, 'wasm'), code);
  return code;
}

/** Opens, evaluates and decodes. Returns the code of the NmcError, or 'fine'. Any other exception, or too long a time, fails the test. */
function outcomeOf(bytes, decoder) {
  const begin = performance.now();
  let code = 'fine';
  try {
    const set = openSet(bytes, { decoder });
    const pose = new Float32Array(set.slots);
    for (const clip of set.clips) {
      clip.evaluate(clip.end / 2, pose);
      assert.ok(clip.times.every((time, n) => Number.isFinite(time) && (n === 0 || time > clip.times[n - 1])));
      clip.decode();
    }
  } catch (error) {
    if (!(error instanceof NmcError)) throw error;
    code = error.code;
  }
  const spent = (performance.now() - begin) / 1000;
  assert.ok(spent < seconds, `took ${spent} s`);
  return code;
}

function count(codes) {
  const counts = {};
  for (const code of codes) counts[code] = (counts[code] ?? 0) + 1;
  return counts;
}

const paper = ['--profile', 'paper', '--max-frequencies', '3', '--tolerance', '5%'];
const inputs = [
  ['sparse layer', () => compressed(sample('quadruped_30hz.glb'), '--tolerance', '1%', '--effort', '1')],
  ['props', () => compressed(sample('props.glb'), '--tolerance', '0.1%', '--effort', '1')],
  ['network', () => compressed(sample('quadruped_30hz.glb'), ...paper)],
];

for (const [name, file] of inputs) {
  const stream = () => streams(readFileSync(file()))[0];

  test(`${name}: a damaged byte is noticed`, { skip: noTool }, () => {
    const bytes = stream();
    const codes = [];
    for (let at = 0; at < bytes.length; at += Math.ceil(bytes.length / 100)) {
      const broken = bytes.slice();
      broken[at] ^= 1 << (at % 8);
      codes.push(outcome(broken));
    }
    assert.ok(!codes.includes('fine'));
  });

  test(`${name}: truncated, with a right checksum`, { skip: noTool }, () => {
    const bytes = stream();
    assert.equal(outcome(bytes), 'fine');
    const codes = [];
    for (let size = 0; size < bytes.length - 8; size += size < 64 ? 1 : Math.ceil(bytes.length / 60))
      codes.push(outcome(size < 9 ? bytes.slice(0, size) : sign(bytes.slice(0, size))));
    assert.ok(!codes.includes('fine'), JSON.stringify(count(codes)));
  });

  test(`${name}: changed bytes behind a right checksum`, { skip: noTool }, (t) => {
    const bytes = stream();
    const codes = [];
    for (let at = 8; at < bytes.length; at += at < 64 ? 1 : Math.ceil(bytes.length / 150)) {
      for (const change of [0xff, 1 << (at % 8)]) {
        const broken = bytes.slice();
        broken[at] ^= change;
        codes.push(outcome(sign(broken)));
      }
    }
    t.diagnostic(JSON.stringify(count(codes)));
    assert.ok(codes.filter((code) => code !== 'fine').length > codes.length / 2);
  });
}

const header = (...counts) => makeStream(counts, [0, 0, 0, 0]);

test('headers are refused before anything is made', () => {
  assert.equal(outcome(new Uint8Array(0)), 'truncated');
  assert.equal(outcome(Uint8Array.of(78, 77, 67, 1)), 'truncated');
  assert.equal(outcome(Uint8Array.of(78, 77, 68, 1)), 'magic');
  assert.equal(outcome(Uint8Array.of(78, 77, 67, 2, 0, 0, 0, 0)), 'version');
  assert.equal(outcome(Uint8Array.of(78, 77, 67, 1, 0, 0, 0, 0, 1)), 'truncated');
  assert.equal(outcome(Uint8Array.of(78, 77, 67, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0)), 'checksum');
  assert.equal(outcome(header(1, 1)), 'truncated');
  // slots, targets, clips, samples, windows, anchors, weights, atoms, max_features, dense
  for (const [place, value] of [
    [0, 65536],
    [1, 4],
    [2, 65536],
    [3, 2 ** 27 + 1],
    [3, 2 ** 32 - 1],
    [4, 3],
    [5, 2 ** 31],
    [6, 2 ** 31],
    [7, 2 ** 31],
    [8, 65536],
    [9, 2 ** 31],
  ]) {
    const counts = [3, 1, 1, 2, 1, 3, 0, 0, 0, 0];
    counts[place] = value;
    if (place === 9) counts.push(1, 1, 1);
    assert.equal(outcome(header(...counts)), 'limit', `count ${place} of ${value}`);
  }
  assert.equal(outcome(header(2 ** 33, 1, 1, 1, 1, 1, 0, 0, 0, 0)), 'limit');
  assert.equal(outcome(sign([78, 77, 67, 1, 0, 0, 0, 0, 255, 255, 255, 255, 255, 255, 1])), 'limit');
});

test('arguments are checked', { skip: noTool }, () => {
  for (const wrong of [undefined, null, 'NMC', [1, 2], new ArrayBuffer(8)])
    assert.throws(() => openSet(wrong), { name: 'NmcError', code: 'argument' });
  for (const wrong of [undefined, null, 'glTF', 3]) assert.throws(() => expand(wrong), { name: 'NmcError', code: 'argument' });
  const clip = openSet(streams(readFileSync(inputs[1][1]()))[0]).clips[0];
  assert.throws(() => clip.evaluate(0, new Float32Array(1)), { code: 'argument' });
  assert.throws(() => clip.evaluate(NaN, new Float32Array(clip.slots)), { code: 'argument' });
});

test('broken containers and broken extension objects', { skip: noTool }, () => {
  const bytes = new Uint8Array(readFileSync(inputs[0][1]()));
  for (let size = 0; size < bytes.length - 1; size += size < 40 ? 1 : 10007) assert.throws(() => expand(bytes.slice(0, size)), NmcError);
  const { json, bin } = readGlb(bytes);
  const name = 'NMC_animation_compression';
  const broken = [
    (document) => delete document.extensions[name],
    (document) => (document.extensions[name].version = 2),
    (document) => (document.extensions[name].clipSets = []),
    (document) => (document.extensions[name].clipSets = 'none'),
    (document) => (document.extensions[name].clipSets[0] = null),
    (document) => (document.extensions[name].clipSets[0].bufferView = 100000),
    (document) => (document.extensions[name].clipSets[0].bufferView = -1),
    (document) => (document.extensions[name].clipSets[0].targets[0].nodes[0] = 100000),
    (document) => (document.extensions[name].clipSets[0].targets[0].nodes[0] = document.extensions[name].clipSets[0].targets[0].nodes[1]),
    (document) => (document.extensions[name].clipSets[0].targets[0].path = 'weights'),
    (document) => document.extensions[name].clipSets[0].targets.pop(),
    (document) => (document.extensions[name].clipSets[0].targets = {}),
    (document) => (document.animations[0].extensions[name].clip = 100),
    (document) => (document.animations[0].extensions[name].clip = 0.5),
    (document) => (document.animations[0].extensions[name].clipSet = 1),
    (document) => (document.animations[0].extensions[name] = 7),
    (document) => delete document.animations[0].samplers,
    (document) => (document.animations[0].channels = {}),
    (document) => (document.animations[0].channels = [null]),
    (document) => (document.animations = 'none'),
    (document) => (document.animations[1] = null),
    (document) => (document.bufferViews[document.extensions[name].clipSets[0].bufferView].byteLength = 2 ** 40),
    (document) => (document.bufferViews[document.extensions[name].clipSets[0].bufferView].buffer = 9),
    (document) => (document.bufferViews[document.extensions[name].clipSets[0].bufferView].byteOffset = 1),
  ];
  assert.doesNotThrow(() => expandJson(json, [bin]));
  for (const edit of broken) {
    const document = structuredClone(json);
    edit(document);
    assert.throws(() => expandJson(document, [bin]), NmcError, edit.toString());
  }
});

// The JSON schemas of the extension: files that the tool writes and the examples of the specification fulfil them, broken ones do not.
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import Ajv from 'ajv/dist/2020.js';
import { expand } from '../../gltf_ext/js/src/index.js';
import { compressed, fixtures, noTool, readGlb, root, sample } from './support.mjs';

const folder = join(root, 'gltf_ext/schema');
const name = 'NMC_animation_compression';
const schemas = readdirSync(folder).map((file) => JSON.parse(readFileSync(join(folder, file), 'utf8')));
const ajv = new Ajv({ schemas, strict: true, allErrors: true });

/** Validates the extension objects of a document; returns how many there were. */
function validate(json) {
  const objects = [['glTF', json.extensions], ...(json.animations ?? []).map((animation) => ['animation', animation.extensions])].filter(
    ([, owner]) => owner?.[name],
  );
  for (const [owner, extensions] of objects) {
    const schema = `${owner}.${name}.schema.json`;
    assert.ok(ajv.validate(schema, extensions[name]), `${schema}: ${ajv.errorsText()}`);
    // glTF allows more properties than a schema names; our files have none.
    const known = ajv.getSchema(schema).schema.properties;
    for (const key of Object.keys(extensions[name])) assert.ok(key in known, `${schema} does not describe ${key}`);
  }
  return objects.length;
}

test('every schema is linked from the specification', () => {
  const text = readFileSync(join(root, 'gltf_ext/README.md'), 'utf8');
  for (const { $id } of schemas) assert.ok(text.includes(`schema/${$id}`), $id);
});

test('the examples of the specification', () => {
  const examples = [...readFileSync(join(root, 'gltf_ext/README.md'), 'utf8').matchAll(/```json\n(.*?)```/gs)].map(([, text]) =>
    JSON.parse(`{${text}}`),
  );
  const [first, second] = examples;
  assert.equal(validate(first), 1);
  assert.equal(validate({ animations: [second] }), 1);
});

for (const { name: fixture, file, skip } of fixtures) {
  test(`${fixture}: the file that the tool writes`, { skip }, () => {
    assert.ok(validate(readGlb(readFileSync(file())).json) >= 2);
  });
}

for (const option of ['--optional', '--fallback']) {
  test(`the file that the tool writes with ${option}`, { skip: noTool }, () => {
    assert.ok(validate(readGlb(readFileSync(compressed(sample('props.glb'), option))).json) >= 2);
  });
}

test('the file that the tool writes with --explain: the record is in extras, and readers ignore it', { skip: noTool }, () => {
  const [explained, plain] = [['--explain'], []].map((options) => readFileSync(compressed(sample('props.glb'), ...options)));
  const { json } = readGlb(explained);
  assert.ok(validate(json) >= 2);
  const clips = json.animations.map((animation) => animation.extensions?.[name]).filter(Boolean);
  assert.ok(clips.length > 0);
  for (const clip of clips) assert.ok(clip.extras.search.tried.length > 0);
  assert.ok(!JSON.stringify(readGlb(plain).json).includes('"tried"'));
  assert.deepEqual(Buffer.from(expand(explained)), Buffer.from(expand(plain)));
});

test('the schemas refuse what the specification forbids', () => {
  const good = { version: 1, clipSets: [{ bufferView: 0, targets: [{ path: 'scale', nodes: [0, 1] }] }] };
  assert.equal(validate({ extensions: { [name]: good } }), 1);
  const edits = [
    (root) => delete root.version,
    (root) => (root.version = 2),
    (root) => delete root.clipSets,
    (root) => (root.clipSets = []),
    (root) => (root.fallback = 1),
    (root) => delete root.clipSets[0].bufferView,
    (root) => (root.clipSets[0].bufferView = -1),
    (root) => (root.clipSets[0].targets = []),
    (root) => (root.clipSets[0].targets[0].path = 'pointer'),
    (root) => (root.clipSets[0].targets[0].nodes = []),
    (root) => (root.clipSets[0].targets[0].nodes = [0, 0]),
    (root) => (root.clipSets[0].targets[0].nodes = [0.5]),
  ];
  for (const edit of edits) {
    const bad = structuredClone(good);
    edit(bad);
    assert.throws(() => validate({ extensions: { [name]: bad } }), edit.toString());
  }
  for (const bad of [
    { clip: 0 },
    { clipSet: 0 },
    { clipSet: -1, clip: 0 },
    { clipSet: 0, clip: '0' },
    { clipSet: 0, clip: 0, stub: 1 },
    { clipSet: 0, clip: 65535 },
  ]) {
    assert.throws(() => validate({ animations: [{ extensions: { [name]: bad } }] }));
  }
});

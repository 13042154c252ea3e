// The schema of settings files says what the tool says of them.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import Ajv from 'ajv/dist/2020.js';
import { noTool, root, sample, scratch, tool } from './support.mjs';

const text = (path) => readFileSync(join(root, path), 'utf8');
const validate = new Ajv({ strict: true, strictTypes: false, strictRequired: false }).compile(JSON.parse(text('docs/settings.schema.json')));

const good = [
  {},
  { $schema: 'settings.schema.json', tolerance: '2 mm', effort: 1, contact_weight: 1.5, time_limit_seconds: 0.5 },
  { tolerance: '5%', rules: [{ joint: 'foot*', tolerance: '1cm' }, { clip: '*', channel: 'scale', keep: true }], exact_ends: false },
  { profile: 'paper', tolerance: '20%', max_frequencies: 1 },
  { exclude: [], optional: true, fallback: false, effort: 1 },
];
const bad = [
  { tolerence: '1%' },
  { tolerance: 1 },
  { tolerance: '1 mile' },
  { rules: [{ joint: 'foot*' }] },
  { rules: [{ joint: '', keep: true }] },
  { rules: [{ joint: 'a', tolerance: '1%', keep: true }] },
  { rules: [{ bone: 'a', keep: true }] },
  { rules: [{ channel: 'turn', keep: true }] },
  { effort: 10 },
  { effort: 1.5 },
  { contact_weight: 0.5 },
  { time_limit_seconds: 0 },
  { target_size: '40' },
  { optional: 'yes' },
  { exclude: 'walk' },
];

/** The tool's exit code for a settings file; a dry run, so that nothing is compressed. */
function exitCode(settings) {
  const file = join(scratch, 'settings.json');
  writeFileSync(file, JSON.stringify(settings));
  return spawnSync(tool, [sample('props.glb'), join(scratch, 'settings.glb'), '--dry-run', '--settings', file]).status;
}

test('schema and tool accept the same settings', { skip: noTool }, () => {
  for (const settings of good) {
    assert.ok(validate(settings), JSON.stringify(settings));
    assert.equal(exitCode(settings), 0, JSON.stringify(settings));
  }
});

test('schema and tool refuse the same settings', { skip: noTool }, () => {
  for (const settings of bad) {
    assert.ok(!validate(settings), JSON.stringify(settings));
    assert.equal(exitCode(settings), 1, JSON.stringify(settings));
  }
});

test('the example of docs/cli.md', () => {
  const [, example] = text('docs/cli.md').match(/### A settings file\n\n((?: {4}.*\n)+)/);
  assert.ok(validate(JSON.parse(example)), JSON.stringify(validate.errors));
});

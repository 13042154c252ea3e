// The command of the npm package, as npm packs and installs it: the compressor in WebAssembly against the native one.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { setTimeout as pause } from 'node:timers/promises';
import { channels, installPackage, largestDifference, noTool, root, runTool, sample, scratch, tool } from './support.mjs';

const built = existsSync(join(root, 'gltf_ext/js/bin/gltf-nmc.wasm'));
const skip = noTool || (built ? false : 'needs gltf_ext/js/bin/gltf-nmc.wasm, which gltf_ext/js/cli/build.sh builds (for many minutes)');
const settings = ['--tolerance', '1%', '--effort', '1'];
// Two builds compute the same with other rounding; the last digits of float32.
const rounding = 1e-4;
let folder;

before(() => {
  if (skip) return;
  folder = mkdtempSync(join(scratch, 'command-'));
  installPackage(folder);
});

after(() => folder && rmSync(folder, { recursive: true, force: true }));

const file = (name) => join(folder, name);
const inFolder = (program, args) => spawnSync(program, args, { cwd: folder, encoding: 'utf8' });
const npx = (...args) => inFolder('npx', ['--loglevel=error', '--no-install', 'gltf-nmc', ...args]);
/** The same without npx between, which takes longer than the command. */
const command = (...args) => inFolder(join(folder, 'node_modules/.bin/gltf-nmc'), args);
const native = (...args) => inFolder(tool, args);

/** Runs the package's command, which must succeed, and returns what it printed. */
function run(...args) {
  const { status, stdout, stderr } = command(...args);
  assert.equal(status, 0, stderr);
  return stdout;
}

/** The largest error in a report of verify, as a fraction of the size. */
const largestError = (report) => Math.max(...JSON.parse(report).animations.map(({ error }) => error.max_fraction_of_size));

/** The same, as the native tool measures it. */
const measured = (original, compressed) => largestError(runTool('verify', original, compressed, '--json', '--tolerance', '1%'));

/** Names in the folder, temporary files among them, that were not there before. */
function newFiles(action) {
  const before = new Set(readdirSync(folder));
  action();
  return readdirSync(folder).filter((name) => !before.has(name));
}

/** Starts the command; `ended` is its exit code or the signal that ended it. */
function start(...args) {
  const child = spawn(join(folder, 'node_modules/.bin/gltf-nmc'), args, { cwd: folder, stdio: 'ignore' });
  const ended = new Promise((resolve) => child.on('exit', (code, signal) => resolve(signal ?? code)));
  return { child, ended };
}

test('npx runs it, and passes its exit code and its streams on', { skip }, () => {
  const version = npx('--version');
  assert.deepEqual([version.status, version.stdout, version.stderr], [0, native('--version').stdout, '']);
  const failure = npx('absent.glb', 'out.glb');
  assert.deepEqual([failure.status, failure.stdout, failure.stderr], [2, '', 'gltf-nmc: absent.glb does not exist.\n']);
});

test('it compresses within the tolerance, as the native tool measures, and prints the same kind of report', { skip }, () => {
  const original = sample('humanoid_30hz.glb');
  const report = JSON.parse(run(original, 'small.glb', '--json', ...settings));
  const nativeReport = JSON.parse(runTool(original, file('native.glb'), '--json', ...settings));
  assert.deepEqual(Object.keys(report), Object.keys(nativeReport));
  assert.equal(report.totals.compressed, nativeReport.totals.compressed);
  const ratio = report.file_bytes_after / nativeReport.file_bytes_after;
  assert.ok(Math.abs(ratio - 1) < 0.02, `${ratio} times the native tool's bytes`);
  assert.equal(readFileSync(file('small.glb')).length, report.file_bytes_after);
  assert.ok(measured(original, file('small.glb')) <= 0.01);
});

test('it gives the same bytes each time, whatever --threads says', { skip }, () => {
  const original = sample('props.glb');
  run(original, 'one.glb', '--quiet', ...settings);
  run(original, 'two.glb', '--quiet', '--threads', '8', ...settings);
  assert.deepEqual(readFileSync(file('one.glb')), readFileSync(file('two.glb')));
});

test('decode and verify agree with the native tool', { skip }, () => {
  const original = sample('humanoid_30hz.glb');
  runTool(original, file('in.glb'), '--quiet', ...settings);
  run('decode', 'in.glb', 'plain.glb');
  runTool('decode', file('in.glb'), file('native_plain.glb'));
  const [ours, theirs] = ['plain.glb', 'native_plain.glb'].map((name) => channels(readFileSync(file(name))));
  assert.equal(ours.length, theirs.length);
  theirs.forEach((animation, i) => {
    assert.deepEqual([...ours[i].channels.keys()], [...animation.channels.keys()]);
    for (const [key, { times, values }] of animation.channels) {
      const other = ours[i].channels.get(key);
      assert.deepEqual(other.times, times);
      assert.ok(largestDifference(values, other.values) < rounding, `${animation.name}, ${key}`);
    }
  });
  const verified = largestError(run('verify', original, 'in.glb', '--json', '--tolerance', '1%'));
  const expected = measured(original, file('in.glb'));
  assert.ok(Math.abs(verified - expected) <= rounding * expected, `${verified}, not ${expected}`);
});

test('failures have the codes and sentences of the native tool, and write nothing', { skip }, () => {
  const original = sample('props.glb');
  writeFileSync(file('text.glb'), 'no glTF');
  writeFileSync(file('cut.glb'), readFileSync(original).subarray(0, 1000));
  const cases = [
    [3, 'text.glb', 'out.glb'],
    [3, 'cut.glb', 'out.glb'],
    [2, 'absent.glb', 'out.glb'],
    [2, original, 'absent/out.glb'],
    [2, '.', 'out.glb'],
    [1, original],
    [1, original, 'out.txt'],
    [1, original, 'out.glb', '--nonsense'],
    [5, 'verify', original, sample('humanoid_30hz.glb')],
  ];
  for (const [status, ...args] of cases) {
    const made = newFiles(() => {
      const [ours, theirs] = [command(...args), native(...args)];
      assert.deepEqual([ours.status, ours.stderr], [theirs.status, theirs.stderr], args.join(' '));
      if (status !== 5) assert.deepEqual([ours.status, ours.stdout], [status, ''], args.join(' '));
    });
    assert.deepEqual(made, [], args.join(' '));
  }
});

test('numbers are read as the native tool reads them', { skip }, () => {
  const texts = ['.5%', '5.%', '2e-1mm', '1E+1%', '1em', '0x1%', '+1%', ' 1%', '-1%', '1e999%', '1e-999m', 'inf%', 'nan%', '%', ''];
  for (const text of texts) {
    const args = [sample('props.glb'), 'out.glb', '--dry-run', '--tolerance', text];
    const [ours, theirs] = [command(...args), native(...args)];
    assert.deepEqual([ours.status, ours.stdout, ours.stderr], [theirs.status, theirs.stdout, theirs.stderr], text);
  }
});

test('a failed run leaves the old output, a good one keeps its permissions', { skip }, () => {
  writeFileSync(file('kept.glb'), 'old', { mode: 0o640 });
  assert.equal(command('text.glb', 'kept.glb').status, 3);
  assert.equal(readFileSync(file('kept.glb'), 'utf8'), 'old');
  const made = newFiles(() => run(sample('props.glb'), 'kept.glb', '--quiet', ...settings));
  assert.deepEqual(made, []);
  assert.equal(spawnSync('stat', ['-c', '%a', file('kept.glb')], { encoding: 'utf8' }).stdout.trim(), '640');
});

test('a .gltf with its buffer, a folder of outputs, and a cache', { skip }, () => {
  copyFileSync(sample('props.glb'), file('a.glb'));
  copyFileSync(sample('props.glb'), file('b.glb'));
  const made = newFiles(() => run('a.glb', 'a.gltf', '--quiet', ...settings));
  assert.equal(made.length, 2, made.join());
  runTool('verify', file('a.glb'), file('a.gltf'), '--tolerance', '1%');
  const compress = () => JSON.parse(run('a.glb', 'b.glb', '-o', 'out', '--cache', 'cache', '--json', ...settings));
  assert.equal(compress().totals.from_cache, 1);
  assert.deepEqual(compress().files.map(({ status }) => status), ['from_cache', 'from_cache']);
  assert.deepEqual(readFileSync(file('out/a.glb')), readFileSync(file('out/b.glb')));
});

test('Draco and meshopt are read, and Draco is written', { skip }, () => {
  const original = sample('humanoid_30hz.glb');
  const draco = ['--draco', '--quiet', ...settings];
  run(original, 'draco.glb', ...draco);
  assert.ok(measured(original, file('draco.glb')) <= 0.01);
  runTool(original, file('native_draco.glb'), ...draco);
  run('verify', original, 'native_draco.glb', '--tolerance', '1%');

  const pack = spawnSync(join(root, 'tests/node_modules/.bin/gltfpack'), ['-i', original, '-o', file('meshopt.glb'), '-cc', '-noq', '-kn', '-km']);
  assert.equal(pack.status, 0, String(pack.stderr));
  run('meshopt.glb', 'from_meshopt.glb', '--quiet', ...settings);
  assert.ok(measured(file('meshopt.glb'), file('from_meshopt.glb')) <= 0.01);
});

test('compare has all methods, with their times', { skip }, () => {
  const args = ['compare', sample('props.glb'), '--json'];
  const [ours, theirs] = [run(...args), runTool(...args)].map((text) => JSON.parse(text));
  const names = ({ methods }) => methods.map(({ name }) => name);
  assert.deepEqual(names(ours), names(theirs));
  for (const { name, atTolerances } of ours.methods) {
    atTolerances.forEach((at, i) => {
      // null where the method does not get below the tolerance.
      if (at) assert.ok(at.maxError <= ours.tolerances[i] && at.encodeSeconds > 0, name);
    });
  }
});

test('import reads BVH', { skip }, () => {
  const joint = (name, inside) => `${name}\n{\nOFFSET 0 10.5 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n${inside}}\n`;
  const skeleton = joint('ROOT Hips', joint('JOINT Chest', 'End Site\n{\nOFFSET 0 1e1 0\n}\n'));
  writeFileSync(file('walk.bvh'), `HIERARCHY\n${skeleton}MOTION\nFrames: 2\nFrame Time: .0333333\n0 +5 0 -1.5e1 0 0\n0 10 0 90. 0 0\n`);
  run('import', 'walk.bvh', 'walk.glb');
  runTool('import', file('walk.bvh'), file('native_walk.glb'));
  const [ours, theirs] = ['walk.glb', 'native_walk.glb'].map((name) => channels(readFileSync(file(name)))[0].channels);
  for (const [key, { values }] of theirs) assert.ok(largestDifference(values, ours.get(key).values) < rounding, key);
});

test('interrupted work ends by the signal and leaves nothing behind', { skip }, async () => {
  const before = readdirSync(folder);
  for (const signal of ['SIGINT', 'SIGTERM']) {
    const { child, ended } = start(sample('humanoid_30hz.glb'), 'never.glb', '--quiet', '--effort', '9');
    await pause(1500);
    child.kill(signal);
    assert.equal(await ended, signal);
    assert.deepEqual(readdirSync(folder), before);
  }
});

test('an interruption while the output is written removes the half of it', { skip }, async () => {
  // A file that takes a while to write: most of it is a buffer that stays as it is.
  const document = JSON.stringify({ asset: { version: '2.0' }, buffers: [{ byteLength: 1 << 28 }] });
  const text = Buffer.from(document.padEnd(Math.ceil(document.length / 4) * 4));
  const head = (length, type) => Buffer.from(Uint32Array.of(length, type).buffer);
  const parts = [head(text.length, 0x4e4f534a), text, head(1 << 28, 0x004e4942), Buffer.alloc(1 << 28)];
  const bytes = parts.reduce((sum, part) => sum + part.length, 12);
  writeFileSync(file('large.glb'), Buffer.concat([Buffer.from(Uint32Array.of(0x46546c67, 2, bytes).buffer), ...parts]));
  const before = readdirSync(folder);
  const { child, ended } = start('large.glb', 'never.glb', '--quiet');
  let seen = false;
  while (!seen && child.exitCode === null) {
    await pause(1);
    seen = readdirSync(folder).some((name) => name.endsWith('.tmp'));
  }
  assert.ok(seen);
  child.kill('SIGINT');
  assert.equal(await ended, 'SIGINT');
  assert.deepEqual(readdirSync(folder), before);
});

// node tests/bench/bench_js.mjs FILE.glb...: how long the decoders of the JavaScript package take for files that gltf-nmc wrote, side by side.
// The least of several rounds, in which the decoders take turns: what else the machine did is not theirs. The first time, in which nothing is
// compiled yet, is what a page pays that loads one file, and is taken in a process of its own for each decoder.
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { openSet } from '../../gltf_ext/js/src/index.js';
import { streams } from '../js/support.mjs';

const rounds = 25;
const decoders = ['js', 'wasm'];

const least = (values) => Math.min(...values);

function time(action) {
  const begin = performance.now();
  const result = action();
  return { result, spent: performance.now() - begin };
}

/** Milliseconds for opening the streams and for making all keys. */
function wholeFile(bytes, decoder) {
  const opened = time(() => bytes.map((one) => openSet(one, { decoder })));
  const decoded = time(() => opened.result.map((set) => set.clips.map((clip) => clip.decode())));
  return { open: opened.spent, keys: decoded.spent, whole: opened.spent + decoded.spent, sets: opened.result };
}

/** Microseconds a pose at times that `pick` gives from 0 to 1. */
function poseTime(sets, pick) {
  let poses = 0;
  const { spent } = time(() => {
    for (const set of sets) {
      const pose = new Float32Array(set.slots);
      for (const clip of set.clips) {
        const [begin] = clip.times;
        for (let i = 0; i < 500; ++i, ++poses) clip.evaluate(begin + (clip.end - begin) * pick(i / 500), pose);
      }
    }
  });
  return (1000 * spent) / poses;
}

const playing = (u) => u;
const scattered = (u) => (u * 1000 * 0.6180339887) % 1;

/** What one process measures that does nothing else before. */
function firstTime(file, decoder) {
  const again = [fileURLToPath(import.meta.url), '--first', decoder, file];
  return least(Array.from({ length: 5 }, () => Number(execFileSync(process.execPath, again, { encoding: 'utf8' }))));
}

function report(file) {
  const bytes = streams(readFileSync(file));
  const sum = (values) => values.reduce((a, b) => a + b, 0);
  const all = decoders.map((decoder) => ({ decoder, open: [], keys: [], whole: [], playing: [], scattered: [], sets: null }));
  for (let i = 0; i < rounds; ++i) {
    for (const one of all) {
      const spent = wholeFile(bytes, one.decoder);
      one.sets = spent.sets;
      for (const part of ['open', 'keys', 'whole']) one[part].push(spent[part]);
    }
  }
  for (let i = 0; i < 5; ++i) {
    for (const one of all) {
      one.playing.push(poseTime(one.sets, playing));
      one.scattered.push(poseTime(one.sets, scattered));
    }
  }
  const { sets } = all[0];
  const samples = sum(sets.map((set) => sum(set.clips.map(({ times }) => times.length))));
  console.log(`${file}: ${sum(bytes.map(({ length }) => length))} bytes of streams, ${sum(sets.map(({ clips }) => clips.length))} clips, ${samples} key times`);
  for (const { decoder, open, keys, whole, ...poses } of all) {
    const [a, b, c] = [whole, open, keys].map((values) => least(values).toFixed(1));
    console.log(`  ${decoder}: whole file ${a} ms (open ${b}, keys ${c}), first time ${firstTime(file, decoder).toFixed(1)} ms`);
    console.log(`    one pose ${least(poses.playing).toFixed(1)} us while playing, ${least(poses.scattered).toFixed(1)} us at random times`);
  }
  const ratio = (part) => (least(all[0][part]) / least(all[1][part])).toFixed(2);
  console.log(`  wasm is faster by ${ratio('whole')} (whole file), ${ratio('playing')} (playing), ${ratio('scattered')} (random times)`);
}

const [option, decoder, ...rest] = process.argv.slice(2);
if (option === '--first') console.log(wholeFile(streams(readFileSync(rest[0])), decoder).whole);
else process.argv.slice(2).forEach(report);

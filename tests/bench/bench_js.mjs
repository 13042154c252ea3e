// node tests/bench/bench_js.mjs FILE.glb...: how long the JavaScript decoder takes for files that gltf-nmc wrote. Medians of several rounds;
// the first round, in which nothing is compiled yet, is what a page pays that loads one file.
import { readFileSync } from 'node:fs';
import { openSet } from '../../gltf_ext/js/src/index.js';
import { streams } from '../js/support.mjs';

const rounds = 25;

const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];

function time(action) {
  const begin = performance.now();
  const result = action();
  return { result, spent: performance.now() - begin };
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

const scattered = (u) => (u * 1000 * 0.6180339887) % 1;

for (const file of process.argv.slice(2)) {
  const bytes = streams(readFileSync(file));
  const spent = { open: [], keys: [], whole: [] };
  let sets;
  for (let i = 0; i < rounds; ++i) {
    const opened = time(() => bytes.map(openSet));
    const decoded = time(() => opened.result.map((set) => set.clips.map((clip) => clip.decode())));
    sets = opened.result;
    spent.open.push(opened.spent);
    spent.keys.push(decoded.spent);
    spent.whole.push(opened.spent + decoded.spent);
  }
  const size = bytes.reduce((sum, { length }) => sum + length, 0);
  const clips = sets.reduce((sum, set) => sum + set.clips.length, 0);
  const samples = sets.reduce((sum, set) => sum + set.clips.reduce((n, clip) => n + clip.times.length, 0), 0);
  const poses = [(u) => u, scattered].map((pick) => median(Array.from({ length: 5 }, () => poseTime(sets, pick))));
  console.log(`${file}: ${size} bytes of streams, ${clips} clips, ${samples} key times`);
  console.log(
    `  whole file ${median(spent.whole).toFixed(1)} ms (open ${median(spent.open).toFixed(1)}, keys ${median(spent.keys).toFixed(1)}); first time ${spent.whole[0].toFixed(1)} ms`,
  );
  console.log(`  one pose ${poses[0].toFixed(1)} us while playing, ${poses[1].toFixed(1)} us at random times`);
}

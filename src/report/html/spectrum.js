// The frequencies that a clip of a stream uses, counted from the stream's own numbers.
import { readPayload } from './nmc/payload.js';

const PERIODIC = 1;

/**
 * @returns {{basis: string, hertz: number[], weights: number[], windows: number, atoms: number}} the frequencies in increasing order, each with
 *   how many curves of the clip use it
 */
export function spectrumOf(bytes, index) {
  const set = readPayload(bytes);
  const clip = set.clips[index];
  const { times } = clip;
  const rate = times.length > 1 ? (times.length - 1) / (times[times.length - 1] - times[0]) : 0;
  const counts = new Map();
  const add = (hertz, count = 1) => counts.set(hertz, (counts.get(hertz) ?? 0) + count);
  for (let k = 0; k < clip.features.length; ++k) {
    const samples = clip.begins[k + 1] - clip.begins[k];
    for (let row = clip.rowFirsts[k]; row < clip.rowFirsts[k + 1]; ++row) {
      const first = row > 0 ? set.weights.rowEnd[row - 1] : 0;
      for (let i = first; i < set.weights.rowEnd[row]; ++i) {
        const feature = set.weights.feature[i];
        const halfCycles = clip.basis === PERIODIC ? 2 * Math.ceil(feature / 2) : feature;
        add((halfCycles * rate) / (2 * samples));
      }
    }
  }
  for (const halfCycles of clip.frequencies ?? []) add((halfCycles * rate) / (2 * (times.length - 1)));
  const hertz = [...counts.keys()].sort((a, b) => a - b);
  return {
    basis: set.hasNetwork ? 'network' : ['cosine', 'periodic', 'sine'][clip.basis],
    hertz,
    weights: hertz.map((value) => counts.get(value)),
    windows: clip.features.length,
    atoms: clip.atoms.level.length,
    rate,
  };
}

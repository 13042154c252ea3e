// The decoder in JavaScript: opens a stream and evaluates its clips. No glTF here; extension.js connects targets to nodes.
import { NmcError, need } from './error.js';
import { PATHS, readPayload } from './payload.js';
import { PoseEvaluator, keepSign, lastAtOrBefore, slerp } from './pose.js';

/**
 * Opens a stream: checks it as a whole and reads all that is in it.
 * @param {Uint8Array} bytes
 * @returns {ClipSet}
 * @throws {NmcError} if the stream is broken in any way
 */
export function openJsSet(bytes) {
  return new ClipSet(readPayload(bytes));
}

/** The clips of one stream, and what their poses consist of. */
class ClipSet {
  constructor(set) {
    /** Floats of a pose. */
    this.slots = set.slots;
    /** Per target: its path, and where its `width` floats stand in a pose. */
    this.targets = set.targets.map(({ path, slot, width }) => ({ path: PATHS[path], slot, width }));
    checkReferences(set);
    const evaluator = new PoseEvaluator(set);
    /** @type {Clip[]} */
    this.clips = set.clips.map((clip) => new Clip(this, clip, evaluator));
  }
}

/** One animation. Its poses are evaluated, keys are made only when `decode` asks for them. */
class Clip {
  #clip;
  #evaluator;
  #targets;
  // The poses of the two samples around the time asked for last, their numbers, and how they are to be mixed.
  #poses = null;
  #at = [-1, -1];

  constructor(set, clip, evaluator) {
    this.#clip = clip;
    this.#evaluator = evaluator;
    this.#targets = set.targets;
    this.slots = set.slots;
    /** The key times in seconds, strictly increasing. Not to be changed. */
    this.times = clip.times;
    /** Per target 0 (not part of this clip), 1 (constant), 2 or 3 (moving). Not to be changed. */
    this.states = clip.states;
  }

  /** The time of the last key in seconds. */
  get end() {
    return this.times[this.times.length - 1];
  }

  /**
   * The pose at a time: between keys as glTF's LINEAR says, before the first and after the last key that key.
   * @param {number} seconds
   * @param {Float32Array} out at least `slots` floats, by the targets' slots; targets that the clip does not hold get the set's reference pose
   * @returns {Float32Array} out
   */
  evaluate(seconds, out) {
    if (out.length < this.slots) throw new NmcError('argument', `a pose of this set needs ${this.slots} floats`);
    if (Number.isNaN(seconds)) throw new NmcError('argument', 'the time is no number');
    const { times } = this;
    const n = lastAtOrBefore(times, times.length, seconds);
    const next = Math.min(n + 1, times.length - 1);
    const u = next > n ? Math.min(Math.max((seconds - times[n]) / (times[next] - times[n]), 0), 1) : 0;
    this.#mix(this.#sample(n, 0), u > 0 ? this.#sample(next, 1) : null, u, out);
    return out;
  }

  /**
   * All keys of the targets that the clip holds, neighbouring quaternions with one sign. Constant targets have two keys, the first and the last
   * (one if the clip has one sample).
   * @returns {{target: number, times: Float32Array, values: Float32Array}[]} values: `width` floats a key
   */
  decode() {
    const { times } = this;
    const clip = this.#clip;
    const evaluator = this.#evaluator;
    const pose = evaluator.pose;
    evaluator.still(clip, pose);
    const last = times.length - 1;
    const ends = last > 0 ? Float32Array.of(times[0], times[last]) : times;
    const tracks = Array.from(clip.still, (target) => {
      const { slot, width } = this.#targets[target];
      const values = new Float32Array(ends.length * width);
      for (let i = 0; i < values.length; ++i) values[i] = pose[slot + (i % width)];
      return { target, times: ends, values };
    });
    const moving = Array.from(clip.moving, (target) => {
      return { target, times, values: new Float32Array(times.length * this.#targets[target].width) };
    });
    const places = Array.from(clip.moving, (target) => this.#targets[target]);
    for (let n = 0; n <= last; ++n) {
      evaluator.move(clip, n, pose);
      for (let k = 0; k < moving.length; ++k) {
        const { values } = moving[k];
        const { slot, width } = places[k];
        for (let a = 0, i = n * width; a < width; ++a, ++i) values[i] = pose[slot + a];
      }
    }
    for (const { target, values } of moving) if (this.#targets[target].path === 'rotation') keepSign(values);
    return [...tracks, ...moving].sort((a, b) => a.target - b.target);
  }

  /** The pose of sample n; evaluated anew only if neither of the two kept poses is it. */
  #sample(n, place) {
    this.#poses ??= this.#makePoses();
    if (this.#at[place] === n) return this.#poses[place];
    if (this.#at[1 - place] === n) {
      this.#poses.reverse();
      this.#at.reverse();
      return this.#poses[place];
    }
    this.#evaluator.move(this.#clip, n, this.#poses[place]);
    this.#at[place] = n;
    return this.#poses[place];
  }

  #makePoses() {
    const pose = new Float64Array(this.slots);
    this.#evaluator.still(this.#clip, pose);
    return [pose, pose.slice()];
  }

  /** Still targets are the same in both poses. */
  #mix(a, b, u, out) {
    for (let i = 0; i < this.slots; ++i) out[i] = a[i];
    if (b === null) return;
    const { moving } = this.#clip;
    for (let k = 0; k < moving.length; ++k) {
      const { path, slot, width } = this.#targets[moving[k]];
      if (path === 'rotation') slerp(a, b, slot, u, out);
      else for (let i = slot; i < slot + width; ++i) out[i] = a[i] + (b[i] - a[i]) * u;
    }
  }
}

/** Exact rotations must be unit, nearly; others must not turn about without end (A.5). */
function checkReferences({ exactReferences, references, anchorStep, targets }) {
  for (const { path, slot } of targets) {
    if (PATHS[path] !== 'rotation') continue;
    let square = 0;
    for (let i = slot; i < slot + (exactReferences ? 4 : 3); ++i) square += (exactReferences ? references[i] : references[i] * anchorStep[i]) ** 2;
    if (exactReferences) need(square >= 0.9801 && square <= 1.0201, 'a reference rotation is not of unit length');
    else need(square < 1000, 'a reference rotation is too large');
  }
}

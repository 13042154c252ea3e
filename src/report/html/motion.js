// Motions: keys of the page, or a stream that the decoder evaluates; and the pose of a skeleton under one of them.
import { openJsSet } from './nmc/decoder.js';
import { compose, multiply, slerp } from './math.js';

const START = { translation: 0, rotation: 3, scale: 7 };
/** Numbers of a node's local transform: translation, rotation, scale. */
export const LOCAL = 10;
const TRACK = 7;

/** The last index i below `count` with values[first + i] <= value; 0 if there is none. */
function lastAtOrBefore(values, first, count, value) {
  let low = 0;
  let high = count - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (values[first + middle] <= value) low = middle;
    else high = middle - 1;
  }
  return low;
}

/**
 * Keys in 16 bits. `tracks` lists per track: node, path (0 translation, 1 rotation, 2 scale), whether it is STEP, where its times begin in
 * keys.numbers and how many there are, where its levels begin (one component after the other), and where in keys.numbers its ranges do.
 */
export class KeyMotion {
  constructor(tracks, keys) {
    this.tracks = tracks;
    this.keys = keys;
    this.a = new Float64Array(4);
    this.b = new Float64Array(4);
  }

  get nodes() {
    return this.tracks.filter((_, i) => i % TRACK === 0);
  }

  apply(seconds, locals) {
    const { levels, numbers } = this.keys;
    const { tracks, a, b } = this;
    for (let i = 0; i < tracks.length; i += TRACK) {
      const [path, step, times, count, level, range] = [tracks[i + 1], tracks[i + 2], tracks[i + 3], tracks[i + 4], tracks[i + 5], tracks[i + 6]];
      const width = path === 1 ? 4 : 3;
      const n = lastAtOrBefore(numbers, times, count, seconds);
      const next = step ? n : Math.min(n + 1, count - 1);
      const t = numbers[times + n];
      const u = next > n ? Math.min(Math.max((seconds - t) / (numbers[times + next] - t), 0), 1) : 0;
      for (let c = 0; c < width; ++c) {
        const low = numbers[range + 2 * c];
        const scale = numbers[range + 2 * c + 1];
        a[c] = low + scale * levels[level + c * count + n];
        b[c] = low + scale * levels[level + c * count + next];
      }
      const out = tracks[i] * LOCAL + (path === 0 ? 0 : path === 1 ? 3 : 7);
      if (path === 1) slerp(a, 0, b, 0, u, locals, out);
      else for (let c = 0; c < 3; ++c) locals[out + c] = a[c] + (b[c] - a[c]) * u;
    }
  }
}

/** A clip of a stream with the nodes that its targets move. */
export class DecodedMotion {
  constructor(clip, set, targets) {
    this.clip = clip;
    this.moves = targets
      .map(([node, path], t) => ({ node, path, slot: set.targets[t].slot, state: clip.states[t] }))
      .filter(({ path, state }) => state > 0 && path !== 'weights');
    this.pose = new Float32Array(set.slots);
  }

  get nodes() {
    return this.moves.map(({ node }) => node);
  }

  apply(seconds, locals) {
    this.clip.evaluate(seconds, this.pose);
    for (const { node, path, slot } of this.moves) {
      const out = node * LOCAL + START[path];
      const width = path === 'rotation' ? 4 : 3;
      for (let c = 0; c < width; ++c) locals[out + c] = this.pose[slot + c];
    }
  }
}

/** Opens streams when a clip first needs them. */
export class Motions {
  #sets = new Map();

  constructor(data) {
    this.data = data;
  }

  original(clip) {
    return clip.original ? [new KeyMotion(clip.original, this.data.keys)] : null;
  }

  other(clip) {
    const motions = clip.other ? [new KeyMotion(clip.other, this.data.keys)] : [];
    if (clip.set >= 0) {
      const { bytes, targets } = this.data.sets[clip.set];
      if (!this.#sets.has(clip.set)) this.#sets.set(clip.set, openJsSet(bytes));
      const set = this.#sets.get(clip.set);
      motions.push(new DecodedMotion(set.clips[clip.clip], set, targets));
    }
    return motions.length > 0 ? motions : null;
  }
}

/** World matrices of a skeleton's nodes under a motion. */
export class Pose {
  constructor(skeleton) {
    const count = skeleton.parent.length;
    this.skeleton = skeleton;
    this.locals = new Float32Array(LOCAL * count);
    this.world = new Float32Array(16 * count);
    this.local = new Float32Array(16);
    this.matrices = new Map(skeleton.matrices);
    this.motions = null;
    this.setMotion(null);
  }

  setMotion(motions) {
    this.motions = motions;
    this.locals.set(this.skeleton.rest);
    const moved = new Set((motions ?? []).flatMap((motion) => motion.nodes));
    this.still = new Map([...this.matrices].filter(([node]) => !moved.has(node)));
  }

  update(seconds) {
    for (const motion of this.motions ?? []) motion.apply(seconds, this.locals);
    const { parent, order } = this.skeleton;
    for (const node of order) {
      const exact = this.still.get(node);
      if (exact) this.local.set(exact);
      else compose(this.locals, LOCAL * node, this.local, 0);
      if (parent[node] < 0) this.world.set(this.local, 16 * node);
      else multiply(this.world, 16 * parent[node], this.local, 0, this.world, 16 * node);
    }
  }
}

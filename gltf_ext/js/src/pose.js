// Appendix A.5 of the specification: poses. Nothing here is allocated per pose.
import { COSINE, PATHS, SINE } from './payload.js';

const STATIC = 1;
const QUATERNION = 3;
const ROTATION = 1;

/** exp of the vector at `v[i]` as a quaternion into `out`. Near 0 the series keeps sin(x / 2) / x exact. */
export function exponential(v, i, out) {
  const x = v[i];
  const y = v[i + 1];
  const z = v[i + 2];
  const angle = Math.sqrt(x * x + y * y + z * z);
  const scale = angle < 1e-4 ? 0.5 - (angle * angle) / 48 : Math.sin(angle / 2) / angle;
  out[0] = x * scale;
  out[1] = y * scale;
  out[2] = z * scale;
  out[3] = Math.cos(angle / 2);
}

/** The quaternion product q[i..] * r, made unit, into out[at..]. */
export function multiply(q, i, r, out, at) {
  const x = q[i + 3] * r[0] + q[i] * r[3] + q[i + 1] * r[2] - q[i + 2] * r[1];
  const y = q[i + 3] * r[1] - q[i] * r[2] + q[i + 1] * r[3] + q[i + 2] * r[0];
  const z = q[i + 3] * r[2] + q[i] * r[1] - q[i + 1] * r[0] + q[i + 2] * r[3];
  const w = q[i + 3] * r[3] - q[i] * r[0] - q[i + 1] * r[1] - q[i + 2] * r[2];
  normalize(x, y, z, w, out, at);
}

function normalize(x, y, z, w, out, at) {
  const length = Math.sqrt(x * x + y * y + z * z + w * w);
  const unit = length > 1e-12;
  out[at] = unit ? x / length : 0;
  out[at + 1] = unit ? y / length : 0;
  out[at + 2] = unit ? z / length : 0;
  out[at + 3] = unit ? w / length : 1;
}

/**
 * Gives each quaternion the sign that is nearer to the one before, as exporters write them: not all players look before they mix two keys.
 * @param {Float32Array} values x, y, z, w of each key; changed
 */
export function keepSign(values) {
  for (let i = 4; i < values.length; i += 4) {
    let dot = 0;
    for (let a = i; a < i + 4; ++a) dot += values[a - 4] * values[a];
    if (dot < 0) for (let a = i; a < i + 4; ++a) values[a] = -values[a];
  }
}

/** The spherical mean of the unit quaternions at p[i..] and q[i..] on the short arc, into out[i..]. */
export function slerp(p, q, i, u, out) {
  let cosine = p[i] * q[i] + p[i + 1] * q[i + 1] + p[i + 2] * q[i + 2] + p[i + 3] * q[i + 3];
  const sign = cosine < 0 ? -1 : 1;
  cosine = Math.min(cosine * sign, 1);
  let a = 1 - u;
  let b = u;
  // Where the arc is tiny, the chord is the arc.
  if (cosine < 1 - 1e-10) {
    const angle = Math.acos(cosine);
    const sine = Math.sin(angle);
    a = Math.sin(a * angle) / sine;
    b = Math.sin(b * angle) / sine;
  }
  b *= sign;
  normalize(a * p[i] + b * q[i], a * p[i + 1] + b * q[i + 1], a * p[i + 2] + b * q[i + 2], a * p[i + 3] + b * q[i + 3], out, i);
}

/** The last index i below `count` with values[i] <= value; 0 if there is none. */
export function lastAtOrBefore(values, count, value) {
  let low = 0;
  let high = count - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (values[middle] <= value) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** The reference pose of a set, per slot. */
export function referencePose(set) {
  const pose = new Float64Array(set.slots);
  const rotation = new Float64Array(4);
  for (const { path, slot, width } of set.targets) {
    for (let a = slot; a < slot + width; ++a) {
      pose[a] = set.exactReferences ? set.references[a] : set.references[a] * set.anchorStep[a] + (PATHS[path] === 'scale' ? 1 : 0);
    }
    if (PATHS[path] !== 'rotation') continue;
    if (!set.exactReferences) {
      exponential(pose, slot, rotation);
      pose.set(rotation, slot);
    }
    normalize(pose[slot], pose[slot + 1], pose[slot + 2], pose[slot + 3], pose, slot);
  }
  return pose;
}

/** Evaluates the clips of one set, as readPayload gives it, at their samples. */
export class PoseEvaluator {
  constructor(set) {
    this.set = set;
    this.reference = referencePose(set);
    this.y = new Float64Array(set.slots);
    /** A pose for the use of whoever evaluates and keeps nothing. */
    this.pose = new Float64Array(set.slots);
    this.rotation = new Float64Array(4);
    this.features = new Float64Array(set.clips.reduce((most, clip) => clip.features.reduce((a, b) => Math.max(a, b), most), 0) + 2);
    if (set.hasNetwork) {
      const frequencies = set.clips.reduce((most, clip) => Math.max(most, clip.frequencies.length), 0);
      this.x = new Float64Array(2 * frequencies + 1);
      this.layers = [set.hidden0, set.hidden1, set.outputs].map((size) => new Float64Array(size));
    }
  }

  /** The targets of a clip that are the same at all samples, into `out` by slots. Those that the clip lacks get the reference pose. */
  still(clip, out) {
    prepareClip(this.set, clip);
    this.addAnchors(clip, 0, 0, clip.stillParameters);
    out.set(this.reference);
    for (const t of clip.still) this.toPose(clip, t, out);
  }

  /** The other targets at sample n. */
  move(clip, n, out) {
    const k = lastAtOrBefore(clip.begins, clip.begins.length - 1, n);
    const begin = clip.begins[k];
    const length = clip.begins[k + 1] - begin;
    this.addAnchors(clip, k, (n - begin) / length, clip.movingParameters);
    if (clip.features[k] > 0) this.addWeights(clip, k, n - begin, length);
    if (clip.atoms.level.length > 0) this.addAtoms(clip, n);
    if (clip.jumps.sample.length > 0) this.addJumps(clip, n, begin, length);
    if (this.set.hasNetwork) this.addNetwork(clip, clip.samples > 1 ? n / (clip.samples - 1) : 0);
    for (let i = 0; i < clip.moving.length; ++i) this.toPose(clip, clip.moving[i], out);
  }

  /** From the parameters of a target to its value. */
  toPose(clip, t, out) {
    const { y, reference, rotation } = this;
    const { path, slot, width } = this.set.targets[t];
    const p = clip.firsts[t];
    if (clip.states[t] === QUATERNION) {
      normalize(y[p], y[p + 1], y[p + 2], y[p + 3], out, slot);
    } else if (path === ROTATION) {
      exponential(y, p, rotation);
      multiply(reference, slot, rotation, out, slot);
    } else {
      for (let a = 0; a < width; ++a) out[slot + a] = reference[slot + a] + y[p + a];
    }
  }

  addAnchors(clip, k, u, chosen) {
    const { y } = this;
    const { parameters, levels, steps } = clip;
    const first = clip.basis === COSINE ? 0 : k * parameters;
    const next = clip.basis === COSINE ? 0 : first + parameters;
    for (let i = 0; i < chosen.length; ++i) {
      const p = chosen[i];
      y[p] = ((1 - u) * levels[first + p] + u * levels[next + p]) * steps[p];
    }
  }

  addWeights(clip, k, m, length) {
    const { y, features } = this;
    const { feature, value, rowEnd, rowParameter } = this.set.weights;
    fillFeatures(clip.basis, clip.features[k], m, length, features);
    const end = clip.rowFirsts[k + 1];
    for (let r = clip.rowFirsts[k], i = r > 0 ? rowEnd[r - 1] : 0; r < end; ++r) {
      const last = rowEnd[r] - 1;
      let sum = 0;
      let other = 0;
      for (; i < last; i += 2) {
        sum += value[i] * features[feature[i]];
        other += value[i + 1] * features[feature[i + 1]];
      }
      if (i === last) sum += value[i] * features[feature[i++]];
      y[rowParameter[r]] += sum + other;
    }
  }

  addAtoms(clip, n) {
    const { sample, parameter, width, level } = clip.atoms;
    const reach = 1 << 15;
    let i = lastAtOrBefore(sample, sample.length, n - reach);
    // Several atoms may share a sample; the search may end on any of them, all out of reach or the first.
    for (; i < sample.length && sample[i] < n + reach; ++i) {
      const d = Math.abs(n - sample[i]);
      if (d < width[i]) this.y[parameter[i]] += (level[i] * clip.steps[parameter[i]] * (1 + Math.cos((Math.PI * d) / width[i]))) / 2;
    }
  }

  /** Those of a window stand after its first sample; the line between its anchors has them already, as slopes. */
  addJumps(clip, n, begin, length) {
    const { sample, parameter, level } = clip.jumps;
    const line = clip.basis === COSINE ? 0 : (n - begin) / length;
    for (let i = lastAtOrBefore(sample, sample.length, begin); i < sample.length && sample[i] <= begin + length; ++i) {
      if (sample[i] > begin) this.y[parameter[i]] += level[i] * clip.steps[parameter[i]] * ((n >= sample[i] ? 1 : 0) - line);
    }
  }

  addNetwork(clip, t) {
    const { x, y, layers, set } = this;
    const inputs = 2 * clip.frequencies.length + 1;
    x[0] = t;
    for (let k = 1; k < inputs; k += 2) {
      const phase = Math.PI * clip.frequencies[k >> 1] * t;
      x[k] = Math.sin(phase);
      x[k + 1] = Math.cos(phase);
    }
    applyLayer(clip.W0, clip.b0, x, inputs, layers[0], true);
    applyLayer(set.W1, set.b1, layers[0], layers[0].length, layers[1], true);
    applyLayer(set.W2, set.b2, layers[1], layers[1].length, layers[2], false);
    for (let i = 0; i < clip.outputs.length; ++i) y[clip.outputs[i]] += layers[2][i];
  }
}

/**
 * What evaluation needs of a clip beside its numbers, made when it is first evaluated: the anchor step of each parameter, which targets and
 * parameters are still and which move, and which parameters the network gives.
 */
export function prepareClip(set, clip) {
  if (clip.steps) return;
  clip.steps = new Float64Array(clip.parameters);
  const corrected = new Set(clip.atoms.parameter);
  const still = [];
  const moving = [];
  const parameters = { still: [], moving: [], outputs: [] };
  set.targets.forEach(({ slot }, t) => {
    if (clip.states[t] === 0) return;
    const own = [];
    for (let p = clip.firsts[t]; p < clip.firsts[t + 1]; ++p) {
      clip.steps[p] = set.anchorStep[slot + own.length];
      own.push(p);
    }
    // An atom moves even what has no weights.
    const moves = clip.states[t] > STATIC || own.some((p) => corrected.has(p));
    (moves ? moving : still).push(t);
    parameters[moves ? 'moving' : 'still'].push(...own);
    if (clip.states[t] > STATIC) parameters.outputs.push(...own);
  });
  clip.still = Int32Array.from(still);
  clip.moving = Int32Array.from(moving);
  clip.stillParameters = Int32Array.from(parameters.still);
  clip.movingParameters = Int32Array.from(parameters.moving);
  clip.outputs = Int32Array.from(parameters.outputs);
}

/**
 * f_1 ... f_count of A.5 at sample m of a window of `length` into features[1 ...]. Each angle is the one before turned by a fixed angle; in
 * doubles 65535 turns lose less than 1e-10.
 */
export function fillFeatures(basis, count, m, length, features) {
  const angle = basis === COSINE ? (Math.PI * (2 * m + 1)) / (2 * length) : (Math.PI * m) / length;
  if (basis === COSINE || basis === SINE) {
    let cosine = Math.cos(angle);
    let sine = Math.sin(angle);
    const c = cosine;
    const s = sine;
    for (let j = 1; j <= count; ++j) {
      features[j] = basis === COSINE ? cosine : sine;
      const turned = cosine * c - sine * s;
      sine = sine * c + cosine * s;
      cosine = turned;
    }
    return;
  }
  let cosine = Math.cos(2 * angle);
  let sine = Math.sin(2 * angle);
  const c = cosine;
  const s = sine;
  for (let j = 1; j <= count; j += 2) {
    features[j] = cosine;
    features[j + 1] = sine;
    const turned = cosine * c - sine * s;
    sine = sine * c + cosine * s;
    cosine = turned;
  }
}

/** out = W x + b, column by column, then ELU where asked for. */
function applyLayer(W, b, x, columns, out, elu) {
  const rows = out.length;
  out.set(b);
  for (let c = 0, i = 0; c < columns; ++c) {
    const value = x[c];
    for (let r = 0; r < rows; ++r, ++i) out[r] += W[i] * value;
  }
  if (!elu) return;
  for (let r = 0; r < rows; ++r) if (out[r] < 0) out[r] = Math.expm1(out[r]);
}

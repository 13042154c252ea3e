// Appendix A.3 and A.4 of the specification: from the decisions of a stream to the numbers of a clip set. Follows the items in order.
import { Decisions } from './decisions.js';
import { need } from './error.js';
import { readHeader } from './header.js';

export const PATHS = ['translation', 'rotation', 'scale', 'weights'];
const ROTATION = 1;
const WEIGHTS = 3;
const STATIC = 1;
const QUATERNION = 3;
const JUMP = 17;
export const COSINE = 0;
export const SINE = 2;

// The tables of runs, each with the item that describes it.
let runs = 0;
const table = (size) => (runs += size) - size;
const COUNT = table(1), TIME = table(1), TIME_ERROR = table(1), CLIP_EXPONENT = table(1), REFERENCE = table(1), ATOM_GAP = table(1),
  ATOM_PARAMETER = table(1), ATOM_WIDTH = table(1), ATOM_VALUE = table(1), FREQUENCY = table(1), FLAG = table(1), STATE = table(64); // A.2
const REFERENCE_R = table(40); // A.3.3
const ANCHOR_A = table(432), ANCHOR_B = table(432), ANCHOR_C = table(512); // A.4.5
const COUNT_A = table(144), COUNT_B = table(144), COUNT_C = table(512); // A.4.6.1
const LEVEL_A = table(512), LEVEL_B = table(192), LEVEL_C = table(128), LEVEL_D = table(2048), LEVEL_E = table(512), LEVEL_F = table(256); // A.4.6.2
const TENSOR_A = table(864), TENSOR_B = table(72); // after the last clip

/** How many runs of models there are. */
export const RUNS = runs;

/**
 * Reads a whole stream.
 * @param {Uint8Array} bytes
 * @returns the set: targets, per slot the steps and references, clips (see readClip), and the network's shared tensors.
 */
export function readPayload(bytes) {
  const header = readHeader(bytes);
  return readDecisions(new Decisions(bytes, header.begin, RUNS), header);
}

/** The same from decisions and a header's counts. */
export function readDecisions(decisions, header) {
  const reader = new Reader(decisions, header);
  const set = reader.readSet();
  for (let c = 0; c < header.clips; ++c) reader.readClip(c);
  reader.readNetwork();
  reader.checkTotals();
  return set;
}

class Reader {
  constructor(decisions, header) {
    const { slots, targets, maxFeatures } = header;
    this.d = decisions;
    this.header = header;
    this.used = { samples: 0, windows: 0, anchors: 0, weights: 0, atoms: 0, dense: 0 };
    this.levels = new Int32Array(header.anchors);
    // The levels that are not 0, row after row; of each row that has any, where it ends and whose it is.
    const most = header.weights;
    this.weights = { feature: new Uint16Array(most), value: new Float64Array(most) };
    this.weights.rowEnd = new Int32Array(most);
    this.weights.rowParameter = new Uint16Array(most);
    this.usedRows = 0;
    this.states = new Uint8Array(targets).fill(4);
    // What contexts remember of each slot: bit lengths of its last anchor difference and of its last count; of its last row the number of levels
    // and, per feature, what A.4.6.2 squeezes out of the bit lengths around it.
    this.was = new Uint8Array(slots);
    this.counts = new Uint8Array(slots);
    this.lastCounts = new Uint16Array(slots);
    this.rowSize = maxFeatures + 1;
    this.around = new Uint8Array(slots * this.rowSize);
    // The bit lengths of the row that is being read; index 0 and what is beyond the last are 0.
    this.row = new Uint8Array(maxFeatures + 2);
  }

  /** Takes `amount` of one of the header's totals, before anything of that size is made. */
  take(name, amount) {
    const first = this.used[name];
    this.used[name] += amount;
    need(this.used[name] <= this.header[name], `the stream holds more ${name} than its header says`);
    return first;
  }

  checkTotals() {
    for (const [name, amount] of Object.entries(this.used)) {
      need(amount === this.header[name], `the stream holds fewer ${name} than its header says`);
    }
  }

  /** A.3 */
  readSet() {
    const { d, header } = this;
    // A.3.1
    const exactReferences = d.raw(1) === 1;
    const hasNetwork = d.raw(1) === 1;
    this.quantized = d.raw(1) === 1;
    need(hasNetwork === header.dense > 0, 'header and payload disagree on a network');
    // A.3.2
    const baseStep = d.float();
    const anchorExponent = this.exponent(CLIP_EXPONENT, 0, 255);
    const set = {
      slots: header.slots,
      targets: [],
      clips: [],
      weights: this.weights,
      slotStep: new Float64Array(header.slots),
      anchorStep: new Float64Array(header.slots),
      references: new Float64Array(header.slots),
      exactReferences,
      hasNetwork,
      hidden0: header.hidden0,
      hidden1: header.hidden1,
    };
    this.set = set;
    // A.3.3
    let slot = 0;
    let exponent = 0;
    for (let t = 0; t < header.targets; ++t) {
      const path = d.simple(STATE + (t === 0 ? 0 : 4 + set.targets[t - 1].path));
      need(path <= WEIGHTS, 'a target has an unknown path');
      const width = path === WEIGHTS ? d.simple(COUNT) : path === ROTATION ? 4 : 3;
      need(width > 0 && slot + width <= header.slots, 'the targets do not fit the slots');
      set.targets.push({ path, slot, width });
      for (let a = 0; a < width; ++a, ++slot) {
        const repeated = path === ROTATION && a === 3;
        if (!exactReferences && !repeated) exponent = this.exponent(STATE + 16 + 4 * path + Math.min(a, 3), exponent, 127);
        set.slotStep[slot] = baseStep * 2 ** (-exponent / 2);
        set.anchorStep[slot] = set.slotStep[slot] * 2 ** (-anchorExponent / 4);
        if (exactReferences) {
          set.references[slot] = d.float();
        } else if (!repeated) {
          d.runs[0] = REFERENCE_R + 12 * path + Math.min(a, 3);
          set.references[slot] = d.signed(3, 1, 0);
        }
      }
    }
    need(slot === header.slots, 'the targets do not fill the slots');
    return set;
  }

  exponent(run, before, most) {
    const exponent = before + this.d.simpleSigned(run);
    need(Math.abs(exponent) <= most, 'an exponent is out of range');
    return exponent;
  }

  /** A.4 */
  readClip(index) {
    const { d, set } = this;
    const clip = { samples: d.simple(COUNT) }; // A.4.1
    need(clip.samples >= 1, 'a clip has no sample');
    this.take('samples', clip.samples);
    this.readTimes(clip, index);
    this.readWindows(clip);
    this.readStates(clip);
    this.readAnchors(clip, index);
    this.readWeights(clip);
    this.readAtoms(clip);
    if (set.hasNetwork) this.readClipNetwork(clip);
    set.clips.push(clip);
  }

  /** A.4.2 */
  readTimes(clip, index) {
    const { d } = this;
    if (index === 0 || !this.flag()) {
      const mode = d.raw(2);
      const first = mode < 2 ? d.simpleSigned(TIME) : d.float();
      const step = mode === 0 ? d.simple(TIME) : mode === 2 ? d.double() : d.float();
      need(mode !== 0 || step > 0, 'a rate is 0');
      this.formula = { mode, first, step };
    }
    const { mode, first, step } = this.formula;
    const exact = this.flag();
    const times = new Float32Array(clip.samples);
    for (let n = 0; n < clip.samples; ++n) {
      if (mode === 0) times[n] = (first + n) / step;
      else if (mode === 1) times[n] = Math.fround(first + n) * step;
      else if (mode === 2) times[n] = first + n * step;
      else times[n] = n === 0 ? first : times[n - 1] + step;
      if (!exact) times[n] = fromOrder(toOrder(times[n]) + d.simpleSigned(TIME_ERROR));
      need(Number.isFinite(times[n]) && (n === 0 || times[n] > times[n - 1]), 'the key times do not increase');
    }
    clip.times = times;
  }

  flag() {
    return this.d.simple(FLAG) !== 0;
  }

  /** A.4.3 */
  readWindows(clip) {
    const { d } = this;
    clip.basis = d.simple(STATE + 12);
    need(clip.basis <= SINE && (clip.basis === COSINE || clip.samples >= 2), 'a clip has an unknown basis, or one that needs more samples');
    const windows = clip.basis === SINE ? d.simple(COUNT) : 1;
    need(windows >= 1 && (windows === 1 || windows < clip.samples), 'a clip has a wrong number of windows');
    this.take('windows', windows);
    const last = clip.basis === COSINE ? clip.samples : clip.samples - 1;
    const even = windows > 1 && this.flag();
    // Where each window begins, and where the last one ends.
    clip.begins = new Int32Array(windows + 1);
    for (let k = 1; k < windows; ++k) {
      const begin = even ? Math.floor((k * (clip.samples - 1)) / windows) : clip.begins[k - 1] + d.simple(COUNT);
      need(begin > clip.begins[k - 1] && begin < last, 'a window is empty or too long');
      clip.begins[k] = begin;
    }
    clip.begins[windows] = last;
  }

  /** A.4.4 */
  readStates(clip) {
    const { d, states, set } = this;
    clip.states = new Uint8Array(set.targets.length);
    /** Per target the first of its parameters; one more entry for the end. */
    clip.firsts = new Int32Array(set.targets.length + 1);
    let s = 0;
    set.targets.forEach(({ path, width }, t) => {
      s = d.simple(STATE + 40 + 4 * states[t] + s);
      need(s < QUATERNION || (s === QUATERNION && path === ROTATION), 'a target has an unknown state');
      states[t] = s;
      clip.states[t] = s;
      clip.firsts[t + 1] = clip.firsts[t] + (s === 0 ? 0 : path === ROTATION && s < QUATERNION ? 3 : width);
    });
    clip.parameters = clip.firsts[set.targets.length];
  }

  /** A.4.5 */
  readAnchors(clip, index) {
    const { d, set, was, levels } = this;
    const v = d.simple(REFERENCE);
    need(v <= index, 'a clip refers to one that is not there');
    const reference = v < index ? set.clips[index - v - 1] : null;
    const rows = clip.basis === COSINE ? 1 : clip.begins.length;
    const first = this.take('anchors', rows * clip.parameters);
    clip.levels = levels.subarray(first, first + rows * clip.parameters);
    for (let r = 0; r < rows; ++r) {
      set.targets.forEach(({ path, slot }, t) => {
        const state = clip.states[t];
        const kind = r > 0 ? 2 : state === STATIC ? 0 : 1;
        for (let p = clip.firsts[t], a = 0; p < clip.firsts[t + 1]; ++p, ++a) {
          const at = r * clip.parameters + p;
          const guess = r > 0 ? clip.levels[at - clip.parameters] : state === QUATERNION ? 0 : lastLevel(reference, t, a);
          if (r > 0 && state === STATIC) {
            clip.levels[at] = guess;
            continue;
          }
          const n1 = a > 0 ? Math.min(was[slot + a - 1], 11) : 0;
          const n2 = a > 1 ? Math.min(was[slot + a - 2], 11) : 0;
          d.runs[0] = ANCHOR_A + ((Math.min(was[slot + a], 11) * 3 + Math.min(a, 2)) * 4 + path) * 3 + kind;
          d.runs[1] = ANCHOR_B + (n1 * 12 + n2) * 3 + kind;
          d.runs[2] = ANCHOR_C + ((slot + a) & 511);
          const level = guess + d.signed(2, 3, kind);
          need(Math.abs(level) < 2 ** 23, 'an anchor is too large');
          clip.levels[at] = level;
          was[slot + a] = d.length;
        }
      });
    }
  }

  /** A.4.6 */
  readWeights(clip) {
    const { header, set } = this;
    const stepExponent = this.exponent(CLIP_EXPONENT, 0, 255);
    const windows = clip.begins.length - 1;
    /** Per window its first row with weights, one more entry for the end, and its largest feature. */
    clip.rowFirsts = new Int32Array(windows + 1).fill(this.usedRows);
    clip.features = new Uint16Array(windows);
    if (header.maxFeatures === 0) return;
    for (let k = 0; k < windows; ++k) {
      const scale = 2 ** (-stepExponent / 4) * Math.sqrt(2 / (clip.begins[k + 1] - clip.begins[k]));
      const parents = [-1, -1, -1, -1];
      set.targets.forEach(({ path, slot }, t) => {
        if (clip.states[t] <= STATIC) return;
        for (let p = clip.firsts[t], a = 0; p < clip.firsts[t + 1]; ++p, ++a) {
          const parent = path === WEIGHTS || parents[path] < 0 ? -1 : parents[path] + Math.min(a, 2);
          const count = this.readCount(path, slot + a, a);
          this.readRow(count, path, slot + a, a, parent, p, set.slotStep[slot + a] * scale);
          clip.features[k] = Math.max(clip.features[k], count);
        }
        parents[path] = slot;
      });
      clip.rowFirsts[k + 1] = this.usedRows;
    }
  }

  /** A.4.6.1 */
  readCount(path, slot, a) {
    const { d, counts } = this;
    const one = a > 0 ? Math.min(counts[slot - 1], 11) : 11;
    const two = a > 1 ? Math.min(counts[slot - 2], 11) : 11;
    d.runs[0] = COUNT_A + Math.min(counts[slot], 11) * 12 + one;
    d.runs[1] = COUNT_B + (two * 3 + Math.min(a, 2)) * 4 + path;
    d.runs[2] = COUNT_C + (slot & 511);
    const count = d.number(1, 3, 17);
    need(count <= this.header.maxFeatures, 'a row has more features than the header says');
    counts[slot] = d.length;
    return count;
  }

  /** A.4.6.2. Keeps the levels that are not 0, times `scale`, as weights of the parameter. */
  readRow(count, path, slot, a, parent, parameter, scale) {
    const { d, row, around, weights } = this;
    const at = slot * this.rowSize;
    const before1 = a > 0 ? at - this.rowSize : -1;
    const before2 = a > 1 ? before1 - this.rowSize : -1;
    const above = parent < 0 ? -1 : parent * this.rowSize;
    let kept = this.used.weights;
    let one = 0;
    let two = 0;
    for (let j = 1; j <= count; ++j) {
      const band = bandOf(j);
      const n1 = before1 < 0 ? 0 : squeezedMore[around[before1 + j]];
      const n2 = before2 < 0 ? 0 : squeezedMore[around[before2 + j]];
      const n3 = above < 0 ? 0 : squeezedMore[around[above + j]];
      d.runs[0] = LEVEL_A + (Math.min(one, 7) * 8 + Math.min(two, 7)) * 8 + band;
      d.runs[1] = LEVEL_B + (n1 * 8 + n2) * 3 + Math.min(a, 2);
      d.runs[2] = LEVEL_C + around[at + j] * 8 + band;
      d.runs[3] = LEVEL_D + (slot & 511) * 4 + (band >> 1);
      d.runs[4] = LEVEL_E + (n3 * 8 + Math.min(count - j, 7)) * 8 + Math.min(one + two, 7);
      d.runs[5] = LEVEL_F + Math.min(j, 63) * 4 + path;
      const level = d.signed(0, 6, 0);
      two = one;
      one = d.length;
      row[j] = one;
      if (level === 0) continue;
      if (kept === weights.feature.length) this.take('weights', kept + 1);
      weights.feature[kept] = j;
      weights.value[kept++] = level * scale;
    }
    need(count === 0 || one > 0, 'the last level of a row is 0');
    if (kept > this.used.weights) {
      weights.rowEnd[this.usedRows] = kept;
      weights.rowParameter[this.usedRows++] = parameter;
    }
    this.take('weights', kept - this.used.weights);
    this.rememberRow(count, slot);
  }

  rememberRow(count, slot) {
    const { row, around } = this;
    const end = Math.min(Math.max(count, this.lastCounts[slot]) + 1, this.rowSize - 1);
    row[count + 1] = 0;
    for (let j = 1; j <= end; ++j) {
      const sum = j > count + 1 ? 0 : row[j - 1] + 2 * row[j] + (j > count ? 0 : row[j + 1]);
      around[slot * this.rowSize + j] = squeezed[sum];
    }
    this.lastCounts[slot] = count;
  }

  /** A.4.7 */
  readAtoms(clip) {
    const { d } = this;
    const count = d.simple(REFERENCE);
    this.take('atoms', count);
    clip.atoms = { sample: new Int32Array(count), parameter: new Uint16Array(count), width: new Uint16Array(count), level: new Float64Array(count) };
    clip.jumps = { sample: [], parameter: [], level: [] };
    const moves = movingFlags(clip);
    let sample = 0;
    for (let i = 0; i < count; ++i) {
      const gap = d.simple(ATOM_GAP);
      need(gap < clip.samples, 'an atom is out of range');
      sample += gap;
      const parameter = d.simple(ATOM_PARAMETER);
      const width = d.simple(ATOM_WIDTH);
      const level = d.simpleSigned(ATOM_VALUE);
      need(sample < clip.samples && parameter < clip.parameters && (width === JUMP ? sample > 0 : width <= 15) && Math.abs(level) < 2 ** 23, 'an atom is out of range');
      need(moves[parameter], 'an atom moves what does not move');
      if (width === JUMP) {
        clip.jumps.sample.push(sample);
        clip.jumps.parameter.push(parameter);
        clip.jumps.level.push(level);
      }
      clip.atoms.sample[i] = sample;
      clip.atoms.parameter[i] = parameter;
      clip.atoms.width[i] = width === JUMP ? 0 : 2 ** width;
      clip.atoms.level[i] = level;
    }
  }

  /** A.4.8 */
  readClipNetwork(clip) {
    const { d, header } = this;
    const count = d.simple(COUNT);
    need(count <= header.maxFrequencies, 'a clip has more frequencies than the header says');
    const steps = this.quantized ? 2 : 0;
    need(count + header.hidden0 * (2 * count + 2) + steps <= header.dense - this.used.dense, 'the stream holds more dense than its header says');
    this.take('dense', count);
    clip.frequencies = new Float64Array(count);
    for (let k = 0; k < count; ++k) {
      clip.frequencies[k] = d.simple(FREQUENCY);
      need(clip.frequencies[k] <= 65535, 'a frequency is too high');
    }
    clip.W0 = this.readTensor(header.hidden0, 2 * count + 1, 0);
    clip.b0 = this.readTensor(header.hidden0, 1, 1);
  }

  /** The end of A.4: what follows the last clip. */
  readNetwork() {
    const { d, header, set } = this;
    if (!set.hasNetwork) return;
    const outputs = d.simple(COUNT);
    need(outputs <= 65535, 'the network has too many outputs');
    for (const clip of set.clips) need(outputs === movingParameters(clip), 'a clip does not fit the outputs of the network');
    const numbers = header.hidden1 * (header.hidden0 + 1) + outputs * (header.hidden1 + 1) + (this.quantized ? 4 : 0);
    need(numbers === header.dense - this.used.dense, "the network's layers are not as large as the header says");
    set.W1 = this.readTensor(header.hidden1, header.hidden0, 2);
    set.b1 = this.readTensor(header.hidden1, 1, 3);
    set.W2 = this.readTensor(outputs, header.hidden1, 4);
    set.b2 = this.readTensor(outputs, 1, 5);
    set.outputs = outputs;
  }

  /** A tensor, column by column. */
  readTensor(rows, columns, kind) {
    const { d } = this;
    this.take('dense', rows * columns + (this.quantized ? 1 : 0));
    const values = new Float64Array(rows * columns);
    if (!this.quantized) {
      for (let i = 0; i < values.length; ++i) values[i] = d.float();
      return values;
    }
    const step = d.float();
    const left = new Uint8Array(rows);
    for (let i = 0; i < values.length; ++i) {
      const r = i % rows;
      const u = r > 0 ? left[r - 1] : 0;
      const l = left[r];
      d.runs[0] = TENSOR_A + (Math.min(u, 11) * 12 + Math.min(l, 11)) * 6 + kind;
      d.runs[1] = TENSOR_B + Math.min((u + l) >> 1, 11) * 6 + kind;
      values[i] = d.signed(4, 2, 0) * step;
      left[r] = d.length;
    }
    return values;
  }
}

function bandOf(j) {
  if (j <= 4) return j - 1;
  return j < 6 ? 3 : j < 10 ? 4 : j < 18 ? 5 : j < 40 ? 6 : 7;
}

// What A.4.6.2 squeezes, by value: once of sums of four bit lengths, and once more of the result.
const squeezed = Uint8Array.from({ length: 4 * 23 + 1 }, (_, v) => (v < 8 ? v : Math.min(8 + ((v - 8) >> 2), 15)));
const squeezedMore = Uint8Array.from({ length: 16 }, (_, v) => (v < 5 ? v : v < 8 ? 5 : v < 11 ? 6 : 7));

/** The last anchor of a parameter in another clip; 0 where that clip lacks it. */
function lastLevel(clip, target, a) {
  if (clip === null || clip.states[target] === 0 || clip.states[target] === QUATERNION) return 0;
  return clip.levels[clip.levels.length - clip.parameters + clip.firsts[target] + a];
}

/** Per parameter whether its target moves. */
function movingFlags(clip) {
  const flags = new Uint8Array(clip.parameters);
  clip.states.forEach((state, t) => flags.fill(state > STATIC ? 1 : 0, clip.firsts[t], clip.firsts[t + 1]));
  return flags;
}

function movingParameters(clip) {
  let count = 0;
  clip.states.forEach((state, t) => (count += state > STATIC ? clip.firsts[t + 1] - clip.firsts[t] : 0));
  return count;
}

const bits = new Uint32Array(1);
const float = new Float32Array(bits.buffer);

/** A float's place in the order of all floats (A.4.2). */
function toOrder(value) {
  float[0] = value;
  return bits[0] < 0x80000000 ? bits[0] : -(bits[0] - 0x80000000);
}

function fromOrder(order) {
  if (Math.abs(order) >= 0x7f800000) return NaN;
  bits[0] = order < 0 ? 0x80000000 - order : order;
  return float[0];
}

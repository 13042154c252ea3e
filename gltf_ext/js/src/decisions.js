// Appendix A.2 of the specification: the range coder, its models, and numbers made of its decisions.
import { NmcError } from './error.js';

const squashPoints = [
  22, 36, 60, 98, 162, 267, 439, 720, 1179, 1921, 3108, 4971, 7812, 11955, 17625, 24743, 32768, 40793, 47911, 53581, 57724, 60565, 62428,
  63615, 64357, 64816, 65097, 65269, 65374, 65438, 65476, 65500, 65514,
];

/** squash(x) at [x + 2048]. */
const squashTable = Int32Array.from({ length: 4096 }, (_, y) => {
  const i = y >> 7;
  const f = y & 127;
  return (squashPoints[i] * (128 - f) + squashPoints[i + 1] * f) >> 7;
});

/** P of a mixed decision at [x + 2048]. */
const mixedProbability = squashTable.map((p) => Math.min(Math.max(p, 32), 65504));

/** stretch(q). Squash never falls, so one walk along x serves all q. */
const stretchTable = new Int16Array(4096);
for (let q = 0, x = -2047; q < 4096; ++q) {
  while (x < 2047 && squashTable[x + 2048] >> 4 < q) ++x;
  stretchTable[q] = x;
}

/** x + 2048 of a mixed decision. What is rounded towards 0 is positive, so it is rounded down. */
function mixedIndex(sum) {
  return sum < -2047 * 65536 ? 1 : sum >= 2047 * 65536 ? 4095 : (sum / 65536 + 2048) | 0;
}

const rates = Int32Array.from({ length: 61 }, (_, n) => Math.floor(131072 / (2 * n + 3)));
const groups = 6;
const mostRuns = 6;
const plainLimit = 30;
const mixedLimit = 60;

/** Reads the decisions of one payload. Runs are numbered from 0; the caller says how many there are. */
export class Decisions {
  /**
   * @param {Uint8Array} bytes the stream
   * @param {number} begin where its payload begins
   * @param {number} runs how many runs of 12 models there are
   */
  constructor(bytes, begin, runs) {
    this.bytes = bytes;
    this.position = begin;
    this.decisions = 0;
    this.mostDecisions = 512 * (bytes.length - begin) + 65536;
    // Of the models: those of the runs, then M (the bits below the first, 32 lengths of 3 a group), then S (signs, 3 contexts a group).
    this.below = runs * 12;
    this.signs = this.below + groups * 96;
    // A model in one number, because a decision loads and stores up to six of them: its p above, its n in the lowest 8 bits.
    this.models = new Int32Array(this.signs + groups * 3).fill(32768 << 8);
    this.weights = new Float64Array(groups * 12 * mostRuns).fill(20000);
    /** Where the caller puts the runs of the next number. */
    this.runs = new Int32Array(mostRuns);
    /** The bit length of the number read last. */
    this.length = 0;
    this.stretched = new Int32Array(mostRuns);
    // Low, high and code. A typed array keeps 32-bit numbers unboxed.
    this.state = Uint32Array.of(0, 0xffffffff, 0);
    for (let i = 0; i < 4; ++i) this.state[2] = (this.state[2] << 8) | this.nextByte();
  }

  /** The next byte; zeros beyond the end, where `check` notices. */
  nextByte() {
    const at = this.position++;
    return at < this.bytes.length ? this.bytes[at] : 0;
  }

  /** Throws if the stream was read too far. Called once per number, which is often enough to end any loop. */
  check() {
    if (this.position > this.bytes.length + 4) throw new NmcError('truncated', 'the payload uses bytes beyond its end');
    if (this.decisions > this.mostDecisions) throw new NmcError('truncated', 'the payload holds more decisions than its size allows');
  }

  /** A decision that is 1 with the probability p / 65536. */
  decide(p) {
    const state = this.state;
    let low = state[0];
    let high = state[1];
    const range = high - low;
    const middle = (low + Math.imul(range >>> 16, p) + (Math.imul(range & 65535, p) >>> 16)) >>> 0;
    const bit = state[2] <= middle ? 1 : 0;
    if (bit) high = middle;
    else low = (middle + 1) >>> 0;
    while (((low ^ high) & 0xff000000) === 0) {
      low = (low << 8) >>> 0;
      high = ((high << 8) | 255) >>> 0;
      state[2] = (state[2] << 8) | this.nextByte();
    }
    state[0] = low;
    state[1] = high;
    ++this.decisions;
    return bit;
  }

  /** What a model becomes by learning a decision. Without branches on the bit, which no processor can foresee. */
  learnt(model, bit, limit) {
    const n = model & 255;
    const p = model >> 8;
    const zero = bit - 1;
    // The distance to 65535 for a 1, to 0 for a 0; a part of it is added or taken.
    const part = Math.imul(p ^ (-bit & 65535), rates[n]) >>> 16;
    const next = p + (part ^ zero) - zero;
    return ((next < 32 ? 32 : next > 65503 ? 65503 : next) << 8) | (n < limit ? n + 1 : n);
  }

  plain(at) {
    const model = this.models[at];
    const bit = this.decide(model >> 8);
    this.models[at] = this.learnt(model, bit, plainLimit);
    return bit;
  }

  /** A mixed decision of the first `count` of `runs` at one step, with the weights from `weight` on. Doubles keep the sum exact. */
  mixed(count, step, weight) {
    if (count === 6) return this.mixedSix(step, weight);
    const { runs, stretched, weights, models } = this;
    let sum = 0;
    for (let i = 0; i < count; ++i) {
      const s = stretchTable[models[runs[i] * 12 + step] >> 12];
      stretched[i] = s;
      sum += weights[weight + i] * s;
    }
    const p = mixedProbability[mixedIndex(sum)];
    const bit = this.decide(p);
    const error = ((bit << 16) - p) * 6;
    for (let i = 0; i < count; ++i) {
      weights[weight + i] += (Math.imul(stretched[i], error) + 524288) >> 20;
      const at = runs[i] * 12 + step;
      models[at] = this.learnt(models[at], bit, mixedLimit);
    }
    return bit;
  }

  /** mixed() of six models, written out: most of the time of opening a stream goes here. */
  mixedSix(step, weight) {
    const { runs, weights, models } = this;
    const a0 = runs[0] * 12 + step,
      a1 = runs[1] * 12 + step,
      a2 = runs[2] * 12 + step,
      a3 = runs[3] * 12 + step,
      a4 = runs[4] * 12 + step,
      a5 = runs[5] * 12 + step;
    const m0 = models[a0],
      m1 = models[a1],
      m2 = models[a2],
      m3 = models[a3],
      m4 = models[a4],
      m5 = models[a5];
    const s0 = stretchTable[m0 >> 12],
      s1 = stretchTable[m1 >> 12],
      s2 = stretchTable[m2 >> 12],
      s3 = stretchTable[m3 >> 12],
      s4 = stretchTable[m4 >> 12],
      s5 = stretchTable[m5 >> 12];
    const w0 = weights[weight],
      w1 = weights[weight + 1],
      w2 = weights[weight + 2],
      w3 = weights[weight + 3],
      w4 = weights[weight + 4],
      w5 = weights[weight + 5];
    const sum = s0 * w0 + s1 * w1 + (s2 * w2 + s3 * w3) + (s4 * w4 + s5 * w5);
    const p = mixedProbability[mixedIndex(sum)];
    const bit = this.decide(p);
    const error = ((bit << 16) - p) * 6;
    weights[weight] = w0 + ((Math.imul(s0, error) + 524288) >> 20);
    weights[weight + 1] = w1 + ((Math.imul(s1, error) + 524288) >> 20);
    weights[weight + 2] = w2 + ((Math.imul(s2, error) + 524288) >> 20);
    weights[weight + 3] = w3 + ((Math.imul(s3, error) + 524288) >> 20);
    weights[weight + 4] = w4 + ((Math.imul(s4, error) + 524288) >> 20);
    weights[weight + 5] = w5 + ((Math.imul(s5, error) + 524288) >> 20);
    models[a0] = this.learnt(m0, bit, mixedLimit);
    models[a1] = this.learnt(m1, bit, mixedLimit);
    models[a2] = this.learnt(m2, bit, mixedLimit);
    models[a3] = this.learnt(m3, bit, mixedLimit);
    models[a4] = this.learnt(m4, bit, mixedLimit);
    models[a5] = this.learnt(m5, bit, mixedLimit);
    return bit;
  }

  /** `count` raw bits, at most 32, highest first. */
  raw(count) {
    let value = 0;
    for (let i = 0; i < count; ++i) value = value * 2 + this.decide(32768);
    return value;
  }

  /** A number with the first `count` of `runs`. */
  number(group, count, limit) {
    let length = 0;
    while (length < limit) {
      const step = length < 11 ? length : 11;
      const larger = count === 1 ? this.plain(this.runs[0] * 12 + step) : this.mixed(count, step, (group * 12 + step) * mostRuns);
      if (!larger) break;
      ++length;
    }
    this.length = length;
    if (length < 2) {
      this.check();
      return length;
    }
    const model = this.below + (group * 32 + length - 1) * 3;
    let bit = this.plain(model);
    let value = 2 + bit;
    if (length > 2) value = value * 2 + this.plain(model + 1 + bit);
    for (bit = 3; bit < length; ++bit) value = value * 2 + this.decide(32768);
    this.check();
    return value;
  }

  signed(group, count, context) {
    const value = this.number(group, count, 23);
    if (value === 0) return 0;
    const negative = this.plain(this.signs + group * 3 + context);
    this.check();
    return negative ? -value : value;
  }

  simple(run) {
    this.runs[0] = run;
    return this.number(5, 1, 32);
  }

  simpleSigned(run) {
    const z = this.simple(run);
    return z % 2 ? -(z - 1) / 2 - 1 : z / 2;
  }

  /** 32 raw bits as a finite float. */
  float() {
    return this.finite(Uint32Array.of(this.raw(32)), Float32Array);
  }

  /** 64 raw bits as a finite double. */
  double() {
    const high = this.raw(32);
    return this.finite(BigUint64Array.of((BigInt(high) << 32n) | BigInt(this.raw(32))), Float64Array);
  }

  finite(bits, Type) {
    this.check();
    const value = new Type(bits.buffer)[0];
    if (!Number.isFinite(value)) throw new NmcError('corrupt', 'the stream holds a number that is not finite');
    return value;
  }
}

// Makes streams out of numbers, to test the decoder with features that the tool seldom or never writes. The models and contexts are the
// decoder's own (that they are the right ones is shown by the reference decoder's files); the range coder here is its inverse.
import { Decisions } from '../../gltf_ext/js/src/decisions.js';

/** Behaves like Decisions, but takes the numbers that it "reads" from a list, and writes them. */
export class Encoder extends Decisions {
  /** @param {number[]} numbers in the order in which the decoder asks for them; raw floats and doubles as such */
  constructor(numbers, runs) {
    super(new Uint8Array(0), 0, runs);
    /** The next one is the last, which is quick to take. */
    this.numbers = [...numbers].reverse();
    this.bits = [];
    this.bytesOut = [];
    this.low = 0;
    this.high = 0xffffffff;
    this.inSigned = false;
  }

  check() {}

  take() {
    if (this.numbers.length === 0) throw new Error('the decoder asks for more numbers');
    return this.numbers.pop();
  }

  decide(p) {
    const bit = this.bits.shift();
    const range = BigInt(this.high - this.low);
    // The exact form of A.2's middle.
    const middle = this.low + Number((range >> 16n) * BigInt(p) + (((range & 65535n) * BigInt(p)) >> 16n));
    if (bit) this.high = middle;
    else this.low = middle + 1;
    while (this.low >>> 24 === this.high >>> 24) {
      this.bytesOut.push(this.high >>> 24);
      this.low = (this.low << 8) >>> 0;
      this.high = ((this.high << 8) | 255) >>> 0;
    }
    return bit;
  }

  raw(count) {
    if (this.bits.length === 0) this.bits.push(...binary(this.take(), count));
    return super.raw(count);
  }

  number(group, count, limit) {
    if (!this.inSigned) this.bits.push(...numberBits(this.take(), limit));
    return super.number(group, count, limit);
  }

  signed(group, count, context) {
    const value = this.take();
    this.bits.push(...numberBits(Math.abs(value), 23), ...(value === 0 ? [] : [value < 0 ? 1 : 0]));
    this.inSigned = true;
    const result = super.signed(group, count, context);
    this.inSigned = false;
    return result;
  }

  simpleSigned(run) {
    const value = this.take();
    this.numbers.push(value < 0 ? -2 * value - 1 : 2 * value);
    return super.simpleSigned(run);
  }

  float() {
    this.bits.push(...binary(new Uint32Array(Float32Array.of(this.take()).buffer)[0], 32));
    return super.float();
  }

  double() {
    const [low, high] = new Uint32Array(Float64Array.of(this.take()).buffer);
    this.bits.push(...binary(high, 32), ...binary(low, 32));
    return super.double();
  }

  /** The payload. */
  finish() {
    if (this.numbers.length > 0) throw new Error(`the decoder did not ask for ${this.numbers.length} numbers`);
    return [...this.bytesOut, ...[24, 16, 8, 0].map((shift) => (this.high >>> shift) & 255)];
  }
}

/** Highest bit first. */
function binary(value, count) {
  return Array.from({ length: count }, (_, i) => Math.floor(value / 2 ** (count - 1 - i)) % 2);
}

/** A number as A.2 has it: as many ones as it has bits, a zero unless at the limit, then the bits below the first. */
function numberBits(value, limit) {
  const length = value === 0 ? 0 : Math.floor(Math.log2(value)) + 1;
  return [...Array(length).fill(1), ...(length < limit ? [0] : []), ...(length < 2 ? [] : binary(value - 2 ** (length - 1), length - 1))];
}

/** A whole stream. */
export function stream(counts, payload) {
  const bytes = [78, 77, 67, 1, 0, 0, 0, 0];
  for (let value of counts) {
    for (; value >= 128; value = Math.floor(value / 128)) bytes.push((value % 128) + 128);
    bytes.push(value);
  }
  bytes.push(...payload);
  return sign(Uint8Array.from(bytes));
}

/** Sets the checksum. */
export function sign(bytes) {
  const copy = Uint8Array.from(bytes);
  let crc = 0xffffffff;
  for (const byte of copy.subarray(8)) {
    crc ^= byte;
    for (let i = 0; i < 8; ++i) crc = crc & 1 ? (crc >>> 1) ^ 0xedb88320 : crc >>> 1;
  }
  new DataView(copy.buffer).setUint32(4, ~crc >>> 0, true);
  return copy;
}

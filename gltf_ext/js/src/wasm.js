// The C decoder, compiled to WebAssembly (wasm/nmc_wasm.c), behind the interface of decoder.js.
import { openJsSet } from './decoder.js';
import { NmcError } from './error.js';
import { PATHS } from './payload.js';
import { keepSign } from './pose.js';
import { wasmBinary } from './wasm_binary.js';

/** By nmc_result; the specification's table "Refusals" has the same numbers. */
const CODES = [, 'truncated', 'magic', 'version', 'checksum', 'limit', 'corrupt', 'argument'];
const MOVING = 2;
/** Floats that one call of the module's decode has room for (WASM_KEY_FLOATS). */
const KEY_FLOATS = 65536;

/** Compiled when it is first needed; null where that cannot be done. */
let compiled;

function instantiate() {
  try {
    compiled ??= new WebAssembly.Module(Uint8Array.from(atob(wasmBinary), (letter) => letter.charCodeAt(0)));
  } catch {
    // There is no WebAssembly, a page's Content-Security-Policy forbids it, or it is Chromium before 115, which compiles as much as this only
    // in the background.
    compiled = null;
  }
  try {
    return compiled && new WebAssembly.Instance(compiled).exports;
  } catch {
    // No address space for one more memory.
    return null;
  }
}

/**
 * Opens a stream with the C decoder.
 * @param {Uint8Array} bytes
 * @returns {WasmClipSet | null} null if WebAssembly cannot be had, or has not enough memory
 * @throws {NmcError} if the stream is broken in any way
 */
export function openWasmSet(bytes) {
  const module = instantiate();
  const at = module?.reserve(bytes.length);
  if (!at) return null;
  new Uint8Array(module.memory.buffer).set(bytes, at);
  const result = module.open(at, bytes.length);
  if (result < 0) return null;
  if (result > 0) throw refusal(CODES[result], bytes);
  return new WasmClipSet(module);
}

/** The C decoder says only which kind of error it found; the other one says it more precisely. */
function refusal(code, bytes) {
  try {
    openJsSet(bytes);
  } catch (error) {
    if (error instanceof NmcError && error.code === code) return error;
  }
  return new NmcError(code, `the C decoder refuses the stream as ${code}`);
}

/** See ClipSet in decoder.js. The memory belongs to this set and its clips alone, and goes with them. */
class WasmClipSet {
  constructor(module) {
    this.slots = module.slots();
    let slot = 0;
    this.targets = Array.from({ length: module.targets() }, (_, t) => {
      const width = module.width(t);
      slot += width;
      return { path: PATHS[module.path(t)], slot: slot - width, width };
    });
    this.clips = Array.from({ length: module.clips() }, (_, c) => new WasmClip(this, module, c));
  }
}

/** See Clip in decoder.js. */
class WasmClip {
  #module;
  #index;
  #targets;
  // Where evaluate finds its results; made anew when the memory has grown, which detaches it.
  #pose = new Float32Array(0);

  constructor(set, module, index) {
    this.#module = module;
    this.#index = index;
    this.#targets = set.targets;
    this.slots = set.slots;
    const { buffer } = module.memory;
    this.times = new Float32Array(buffer, module.times(index), module.samples(index)).slice();
    this.states = new Uint8Array(buffer, module.states(index), set.targets.length).slice();
  }

  get end() {
    return this.times[this.times.length - 1];
  }

  evaluate(seconds, out) {
    if (out.length < this.slots) throw new NmcError('argument', `a pose of this set needs ${this.slots} floats`);
    if (Number.isNaN(seconds)) throw new NmcError('argument', 'the time is no number');
    if (!this.#module.evaluate(this.#index, seconds)) throw new RangeError('there is no memory for a pose');
    if (this.#pose.length === 0) this.#pose = this.#poseView();
    out.set(this.#pose);
    return out;
  }

  decode() {
    const { times, states } = this;
    const targets = this.#targets;
    const last = times.length - 1;
    const tracks = [];
    let floats = 0;
    for (let target = 0; target < targets.length; ++target) {
      if (states[target] < MOVING) continue;
      floats += targets[target].width;
      tracks.push({ target, times, values: new Float32Array(times.length * targets[target].width) });
    }
    const most = Math.max(Math.floor(KEY_FLOATS / floats), 1);
    for (let first = 0; first < times.length; first += most) this.#decodeSome(tracks, first, Math.min(most, times.length - first));
    for (const { target, values } of tracks) if (targets[target].path === 'rotation') keepSign(values);
    // What does not move is in the pose of the last sample as in any other.
    const pose = this.#poseView();
    const ends = last > 0 ? Float32Array.of(times[0], times[last]) : times;
    for (let target = 0; target < targets.length; ++target) {
      if (states[target] === 0 || states[target] >= MOVING) continue;
      const { slot, width } = targets[target];
      const values = new Float32Array(ends.length * width);
      for (let i = 0; i < values.length; ++i) values[i] = pose[slot + (i % width)];
      tracks.push({ target, times: ends, values });
    }
    return tracks.sort((a, b) => a.target - b.target);
  }

  #decodeSome(tracks, first, count) {
    const module = this.#module;
    module.decode(this.#index, first, count);
    const keys = new Float32Array(module.memory.buffer, module.keys());
    let at = 0;
    for (const { target, values } of tracks) {
      const { width } = this.#targets[target];
      values.set(keys.subarray(at, at + count * width), first * width);
      at += count * width;
    }
  }

  #poseView() {
    return new Float32Array(this.#module.memory.buffer, this.#module.pose(), this.slots);
  }
}

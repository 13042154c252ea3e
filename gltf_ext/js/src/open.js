// The decoder's face: the one in JavaScript or the one in WebAssembly opens a stream.
import { openJsSet } from './decoder.js';
import { NmcError } from './error.js';
import { openWasmSet } from './wasm.js';

/**
 * Below as many bytes an instance of the WebAssembly module costs more than it saves; tests/bench/bench_js.mjs shows both decoders side by
 * side.
 */
const fewBytes = 512;

/**
 * Opens a stream: checks it as a whole and reads all that is in it.
 * @param {Uint8Array} bytes the stream and nothing else
 * @param {{decoder?: 'auto' | 'js' | 'wasm'}} [options] auto: WebAssembly where it is faster and can be had
 * @returns {ClipSet}
 * @throws {NmcError} if the stream is broken in any way, or WebAssembly is asked for and cannot be had
 */
export function openSet(bytes, { decoder = 'auto' } = {}) {
  if (!(bytes instanceof Uint8Array)) throw new NmcError('argument', 'openSet needs a Uint8Array');
  if (decoder === 'js' || (decoder === 'auto' && bytes.length < fewBytes)) return openJsSet(bytes);
  if (decoder !== 'auto' && decoder !== 'wasm') throw new NmcError('argument', `there is no decoder ${decoder}`);
  const set = openWasmSet(bytes);
  if (set === null && decoder === 'wasm') throw new NmcError('argument', 'WebAssembly cannot be had here');
  return set ?? openJsSet(bytes);
}

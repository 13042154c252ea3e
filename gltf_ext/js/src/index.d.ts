/** A broken stream, a broken file or a wrong argument. */
export class NmcError extends Error {
  readonly name: 'NmcError';
  /** Of a broken stream: a code of the specification's table "Refusals", whose sentence is the message. */
  readonly code: 'truncated' | 'magic' | 'version' | 'checksum' | 'limit' | 'corrupt' | 'glb' | 'extension' | 'argument';
  /** More precisely what was found. */
  readonly detail: string;
}

export type Path = 'translation' | 'rotation' | 'scale' | 'weights';

/** What one target of a stream is, and where its floats stand in a pose. */
export interface Target {
  readonly path: Path;
  readonly slot: number;
  readonly width: number;
}

/** The keys of one target: `width` floats for each time. */
export interface Track {
  /** Index in the set's targets. */
  target: number;
  /** Seconds. Tracks of one clip may share this array. */
  times: Float32Array;
  values: Float32Array;
}

export interface Clip {
  /** Floats of a pose. */
  readonly slots: number;
  /** Key times in seconds, strictly increasing. Not to be changed. */
  readonly times: Float32Array;
  /** The time of the last key in seconds. */
  readonly end: number;
  /** Per target 0 (not part of this clip), 1 (constant), 2 or 3 (moving). Not to be changed. */
  readonly states: Uint8Array;
  /**
   * The pose at a time, into `out`, which is returned: between keys as glTF's LINEAR says, before the first and after the last that key.
   * Targets that the clip does not hold get the set's reference pose. Allocates nothing after the first call.
   * @throws NmcError `argument`
   */
  evaluate(seconds: number, out: Float32Array): Float32Array;
  /**
   * All keys of the targets that the clip holds, neighbouring quaternions with one sign. Constant targets have two keys, or one if the clip has
   * one sample.
   */
  decode(): Track[];
}

export interface ClipSet {
  /** Floats of a pose. */
  readonly slots: number;
  readonly targets: readonly Target[];
  readonly clips: readonly Clip[];
}

/** `auto`: WebAssembly for streams that it reads sooner, JavaScript for tiny ones, and wherever WebAssembly cannot be had. */
export type Decoder = 'auto' | 'js' | 'wasm';

export interface OpenOptions {
  /** Who decodes (default auto). Both give the same, within the conformance section of the specification. */
  decoder?: Decoder;
}

/**
 * Opens a stream: checks it as a whole and reads all that is in it.
 * @throws NmcError if the stream is broken in any way; `argument` if the decoder is wasm and WebAssembly cannot be had
 */
export function openSet(bytes: Uint8Array, options?: OpenOptions): ClipSet;

/**
 * A compressed GLB file as a plain one, which every loader plays. A file without the extension comes back unchanged.
 * @throws NmcError if the file or a stream in it is broken
 */
export function expand(glb: ArrayBuffer | Uint8Array, options?: OpenOptions): ArrayBuffer;

/**
 * A compressed .gltf document as a plain one; the new keys are in a data URI.
 * @param json the document; not changed
 * @param buffers the bytes of the document's buffers; those that hold no stream may be missing
 * @throws NmcError if the document or a stream in it is broken
 */
export function expandJson(json: object, buffers: ReadonlyArray<Uint8Array | undefined>, options?: OpenOptions): object;

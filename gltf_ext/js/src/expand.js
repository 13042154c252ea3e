// Compressed glTF to plain glTF in memory, for loaders without a plug-in.
import { NmcError } from './error.js';
import { EXTENSION, clipOf, clipReference, clipSetView, openClipSet, rootExtension, trueChannels } from './extension.js';
import { BIN_CHUNK, readGlb, writeGlb } from './glb.js';

const TYPES = { translation: 'VEC3', rotation: 'VEC4', scale: 'VEC3', weights: 'SCALAR' };

/**
 * A compressed GLB file as a plain one: every clip as channels again, the extension gone. What the stubs used stays as unused accessors. A file
 * without the extension comes back unchanged. The argument is not changed.
 * @param {ArrayBuffer | Uint8Array} glb
 * @param {object} [options] of openSet
 * @returns {ArrayBuffer}
 * @throws {NmcError} if the file or a stream in it is broken
 */
export function expand(glb, options) {
  const bytes = toBytes(glb);
  const { json, chunks } = readGlb(bytes);
  if (!usesExtension(json)) return bytes.slice().buffer;
  const bin = chunks.find(({ type }) => type === BIN_CHUNK);
  const bufferBytes = (index) => (index === 0 && json.buffers[0].uri === undefined ? bin?.bytes : dataUri(json.buffers[index].uri));
  const plain = expandDocument(json, bufferBytes, options);
  if (plain.added.length > 0) {
    if (bin && json.buffers[0].uri === undefined) bin.bytes = appendToBin(json, bin.bytes, plain);
    else addDataUri(json, plain);
  }
  return writeGlb(json, chunks);
}

/**
 * A compressed .gltf document as a plain one. The new keys are in a buffer of their own with a data URI, so the other buffers stay where they are.
 * @param {object} json the document; not changed
 * @param {Uint8Array[]} buffers the bytes of the document's buffers; those that hold no stream may be missing
 * @param {object} [options] of openSet
 * @returns {object} the plain document
 * @throws {NmcError} if the document or a stream in it is broken
 */
export function expandJson(json, buffers, options) {
  const copy = structuredClone(json);
  if (!usesExtension(copy)) return copy;
  const plain = expandDocument(copy, (index) => buffers[index] ?? dataUri(copy.buffers[index].uri), options);
  if (plain.added.length > 0) addDataUri(copy, plain);
  return copy;
}

function toBytes(data) {
  if (data instanceof ArrayBuffer) return new Uint8Array(data);
  if (ArrayBuffer.isView(data)) return new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
  throw new NmcError('argument', 'expand needs an ArrayBuffer');
}

const usesExtension = (json) => json.extensions?.[EXTENSION] !== undefined || (json.extensionsUsed ?? []).includes(EXTENSION);

function dataUri(uri) {
  const match = typeof uri === 'string' ? /^data:[^,]*;base64,/.exec(uri) : null;
  if (!match) return undefined;
  try {
    return Uint8Array.from(atob(uri.slice(match[0].length)), (letter) => letter.charCodeAt(0));
  } catch {
    throw new NmcError('glb', 'a data URI is broken');
  }
}

/** The bytes of a bufferView. */
function viewBytes(json, index, bufferBytes) {
  const { buffer, byteOffset = 0, byteLength } = json.bufferViews[index];
  const bytes = json.buffers?.[buffer] ? bufferBytes(buffer) : undefined;
  if (!bytes) throw new NmcError('extension', `the bytes of buffer ${buffer} are not there`);
  const whole = [byteOffset, byteLength].every((value) => Number.isInteger(value) && value >= 0);
  if (!whole || byteOffset + byteLength > bytes.length) throw new NmcError('extension', `bufferView ${index} is not inside its buffer`);
  return bytes.subarray(byteOffset, byteOffset + byteLength);
}

/**
 * Edits the document. The bufferView of each stream becomes the one of that set's keys, so that no index changes.
 * @returns {{added: {view: number, arrays: Float32Array[], size: number}[], size: number}} the keys, still without a buffer
 */
function expandDocument(json, bufferBytes, options) {
  const root = rootExtension(json);
  const added = [];
  // With `fallback` the channels are there already; the clips would only give them once more.
  if (root.fallback !== true) {
    const sets = root.clipSets.map((_, index) => {
      const view = clipSetView(json, index);
      const keys = { view, arrays: [], size: 0 };
      added.push(keys);
      return { ...openClipSet(json, index, viewBytes(json, view, bufferBytes), options), keys };
    });
    for (let index = 0; index < (json.animations?.length ?? 0); ++index) {
      const reference = clipReference(json, index);
      if (reference) expandAnimation(json, json.animations[index], reference, sets[reference.clipSet]);
    }
  }
  removeExtension(json);
  const used = added.filter(({ size }) => size > 0);
  return { added: used, size: used.reduce((sum, { size }) => sum + size, 0) };
}

function expandAnimation(json, animation, reference, { set, nodes, keys }) {
  const clip = clipOf(set, reference);
  keepTrueChannels(animation);
  const inputs = new Map();
  for (const { target, times, values } of clip.decode()) {
    const { path } = set.targets[target];
    if (!inputs.has(times))
      inputs.set(times, addAccessor(json, keys, times, 'SCALAR', { min: [times[0]], max: [times[times.length - 1]] }));
    const output = addAccessor(json, keys, values, TYPES[path]);
    animation.channels.push({ sampler: animation.samplers.length, target: { node: nodes[target], path } });
    animation.samplers.push({ input: inputs.get(times), output });
  }
}

/** Takes the stub out of an animation, and the samplers that nothing uses any more. */
function keepTrueChannels(animation) {
  const samplers = [];
  animation.channels = trueChannels(animation).map((channel) => {
    samplers.push(animation.samplers[channel.sampler]);
    return { ...channel, sampler: samplers.length - 1 };
  });
  animation.samplers = samplers;
}

function addAccessor(json, keys, array, type, more = {}) {
  const components = { SCALAR: 1, VEC3: 3, VEC4: 4 }[type];
  json.accessors ??= [];
  json.accessors.push({
    bufferView: keys.view,
    byteOffset: keys.size,
    componentType: 5126,
    count: array.length / components,
    type,
    ...more,
  });
  keys.arrays.push(array);
  keys.size += array.byteLength;
  return json.accessors.length - 1;
}

function removeExtension(json) {
  for (const owner of [json, ...(json.animations ?? [])]) {
    if (owner.extensions?.[EXTENSION] === undefined) continue;
    delete owner.extensions[EXTENSION];
    if (Object.keys(owner.extensions).length === 0) delete owner.extensions;
  }
  for (const list of ['extensionsUsed', 'extensionsRequired']) {
    if (!json[list]) continue;
    json[list] = json[list].filter((name) => name !== EXTENSION);
    if (json[list].length === 0) delete json[list];
  }
}

/** Places the keys at `begin` of a buffer, and writes them into `out` from `begin` on. */
function placeKeys(json, { added }, buffer, out, begin) {
  let at = begin;
  for (const { view, arrays, size } of added) {
    const { name } = json.bufferViews[view];
    json.bufferViews[view] = { buffer, byteOffset: at, byteLength: size, ...(name === undefined ? {} : { name }) };
    for (const array of arrays) {
      out.set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength), at);
      at += array.byteLength;
    }
  }
}

function appendToBin(json, bin, plain) {
  const begin = Math.ceil(bin.length / 4) * 4;
  const out = new Uint8Array(begin + plain.size);
  out.set(bin);
  placeKeys(json, plain, 0, out, begin);
  json.buffers[0].byteLength = out.length;
  return out;
}

function addDataUri(json, plain) {
  const out = new Uint8Array(plain.size);
  placeKeys(json, plain, json.buffers.length, out, 0);
  let text = '';
  for (let i = 0; i < out.length; i += 8192) text += String.fromCharCode(...out.subarray(i, i + 8192));
  json.buffers.push({ byteLength: out.length, uri: `data:application/octet-stream;base64,${btoa(text)}` });
}

// The GLB container: to chunks and back.
import { NmcError } from './error.js';

const MAGIC = 0x46546c67;
export const JSON_CHUNK = 0x4e4f534a;
export const BIN_CHUNK = 0x004e4942;

const padded = (size) => Math.ceil(size / 4) * 4;

/**
 * @param {Uint8Array} bytes a GLB file
 * @returns {{json: object, chunks: {type: number, bytes: Uint8Array}[]}} the document, and the chunks behind it in their order
 * @throws {NmcError} `glb`
 */
export function readGlb(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 20 || view.getUint32(0, true) !== MAGIC) throw new NmcError('glb', 'this is no GLB file');
  if (view.getUint32(4, true) !== 2) throw new NmcError('glb', 'the GLB file is not of version 2');
  const end = view.getUint32(8, true);
  if (end > bytes.length) throw new NmcError('glb', 'the GLB file ends too early');
  const chunks = [];
  for (let at = 12; at + 8 <= end;) {
    const size = view.getUint32(at, true);
    const begin = at + 8;
    if (begin + size > end) throw new NmcError('glb', 'a chunk of the GLB file is too long');
    chunks.push({ type: view.getUint32(at + 4, true), bytes: bytes.subarray(begin, begin + size) });
    at = begin + padded(size);
  }
  const first = chunks.shift();
  if (first?.type !== JSON_CHUNK) throw new NmcError('glb', 'the GLB file does not begin with JSON');
  return { json: parse(first.bytes), chunks };
}

function parse(bytes) {
  let json;
  try {
    json = JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(bytes));
  } catch (error) {
    throw new NmcError('glb', `the JSON of the GLB file cannot be read: ${error.message}`);
  }
  if (typeof json !== 'object' || json === null) throw new NmcError('glb', 'the JSON of the GLB file is no object');
  return json;
}

/** The inverse of readGlb, as one ArrayBuffer. */
export function writeGlb(json, chunks) {
  const all = [{ type: JSON_CHUNK, bytes: new TextEncoder().encode(JSON.stringify(json)) }, ...chunks];
  const size = all.reduce((sum, { bytes }) => sum + 8 + padded(bytes.length), 12);
  const out = new Uint8Array(size);
  const view = new DataView(out.buffer);
  view.setUint32(0, MAGIC, true);
  view.setUint32(4, 2, true);
  view.setUint32(8, size, true);
  let at = 12;
  for (const { type, bytes } of all) {
    view.setUint32(at, padded(bytes.length), true);
    view.setUint32(at + 4, type, true);
    out.set(bytes, at + 8);
    if (type === JSON_CHUNK) out.fill(0x20, at + 8 + bytes.length, at + 8 + padded(bytes.length));
    at += 8 + padded(bytes.length);
  }
  return out.buffer;
}

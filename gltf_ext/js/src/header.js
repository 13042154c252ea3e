// Appendix A.1 of the specification: the header of a stream, and its limits.
import { NmcError, need } from './error.js';

const crcTable = Int32Array.from({ length: 256 }, (_, byte) => {
  for (let i = 0; i < 8; ++i) byte = byte & 1 ? (byte >>> 1) ^ 0xedb88320 : byte >>> 1;
  return byte;
});

/** CRC-32 as in zlib. */
function crc32(bytes) {
  let crc = -1;
  for (let i = 0; i < bytes.length; ++i) crc = (crc >>> 8) ^ crcTable[(crc ^ bytes[i]) & 255];
  return ~crc >>> 0;
}

const COUNTS = ['slots', 'targets', 'clips', 'samples', 'windows', 'anchors', 'weights', 'atoms', 'maxFeatures', 'dense'];
const NETWORK_COUNTS = ['hidden0', 'hidden1', 'maxFrequencies'];

/** A.1. Returns the counts, and where the payload begins. */
export function readHeader(bytes) {
  need(bytes.length >= 4, 'there is no version', 'truncated');
  need(bytes[0] === 78 && bytes[1] === 77 && bytes[2] === 67, 'this is no NMC stream', 'magic');
  need(bytes[3] === 1, `version ${bytes[3]} of the stream is not known`, 'version');
  need(bytes.length >= 8, 'there is no checksum', 'truncated');
  need(bytes.length < 2 ** 31 - 1, 'the stream is too large', 'limit');
  let at = 8;
  const varint = () => {
    let value = 0;
    for (let i = 0; i < 5; ++i) {
      need(at < bytes.length, 'the stream ends in its header', 'truncated');
      const byte = bytes[at++];
      value += (byte & 127) * 2 ** (7 * i);
      if (byte < 128) {
        need(value < 2 ** 32, 'a count of the header is too large', 'limit');
        return value;
      }
    }
    throw new NmcError('limit', 'a count of the header is too long');
  };
  const header = { hidden0: 0, hidden1: 0, maxFrequencies: 0 };
  for (const name of COUNTS) header[name] = varint();
  if (header.dense > 0) for (const name of NETWORK_COUNTS) header[name] = varint();
  header.begin = at;
  checkLimits(header, 64 * bytes.length + 65536);
  const stored = new DataView(bytes.buffer, bytes.byteOffset).getUint32(4, true);
  need(crc32(bytes.subarray(8)) === stored, 'the checksum does not match: the stream is damaged', 'checksum');
  return header;
}

function checkLimits(header, most) {
  const limits = [
    [header.slots, 65535], [header.targets, header.slots], [header.clips, 65535], [header.samples, 2 ** 27],
    [header.windows, header.samples],
    [header.maxFeatures, 65535], [header.maxFrequencies, 65535], [header.hidden0, 4096], [header.hidden1, 4096],
    [header.windows, most], [header.weights, most], [header.atoms, most], [header.dense, most],
    [header.samples, 16 * most], [header.anchors, 16 * most],
    [header.slots * (header.maxFeatures + 1), 64 * most], [header.clips * header.targets, 64 * most],
    [header.windows * header.targets, 64 * most],
  ];
  for (const [value, limit] of limits) need(value <= limit, 'the header asks for more than the limits allow', 'limit');
}

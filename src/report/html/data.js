// Reads what the page carries: the report's JSON, and numbers packed in base64 (little endian, as every machine that runs a browser has them).

export function unpack(base64, Type) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return new Type(bytes.buffer);
}

/**
 * `report` is what --json prints. `clips` are the animations with curves; each knows its row of the report. `original` and `other` are motions
 * as motion.js reads them, or null where there was no room for them.
 */
export function readData(text) {
  const data = JSON.parse(text);
  const { skeleton, keys, report } = data;
  skeleton.rest = unpack(skeleton.rest, Float32Array);
  keys.levels = unpack(keys.levels, Uint16Array);
  keys.numbers = unpack(keys.numbers, Float32Array);
  for (const set of data.sets) set.bytes = unpack(set.stream, Uint8Array);
  for (const profile of data.clips.map((clip) => clip.profile)) {
    profile.seconds = unpack(profile.seconds, Float32Array);
    profile.max = unpack(profile.max, Float32Array);
    for (const point of profile.worst) point.error = unpack(point.error, Float32Array);
  }
  // The rows of `compress` have an index; those of `verify` are the clips with curves, in the same order.
  const byIndex = new Map(report.animations.map((row, i) => [row.animation ?? data.clips[i].animation, row]));
  for (const clip of data.clips) clip.row = byIndex.get(clip.animation);
  return data;
}

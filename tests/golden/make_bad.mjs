// node make_bad.mjs FOLDER: writes the bad streams of tests/golden. The beginning of a file's name is the code that it is refused with
// (the table "Refusals" in gltf_ext/README.md). All have a right checksum but the one that is about it.
//
// A stream, once it is in the tree, stays as it is: every later decoder has to refuse it.
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { NmcError } from '../../gltf_ext/js/src/error.js';
import { RUNS, readDecisions } from '../../gltf_ext/js/src/payload.js';
import { Encoder, sign, stream } from '../js/encoder.mjs';

const names = ['slots', 'targets', 'clips', 'samples', 'windows', 'anchors', 'weights', 'atoms', 'maxFeatures', 'dense'];
names.push('hidden0', 'hidden1', 'maxFrequencies');

/** A stream with these counts and numbers, which end where the decoder would refuse them. */
function make(counts, numbers) {
  const header = Object.fromEntries(names.map((name, i) => [name, counts[i] ?? 0]));
  const encoder = new Encoder(numbers.flat(Infinity), RUNS);
  try {
    readDecisions(encoder, header);
  } catch (error) {
    if (!(error instanceof NmcError)) throw error;
  }
  encoder.numbers = [];
  return stream(counts, encoder.finish());
}

/** The counts of one clip of three samples that holds one translation still, some of them changed. */
const counts = (changes = {}) => names.slice(0, 10).map((name, i) => changes[name] ?? [3, 1, 1, 3, 1, 3, 0, 0, 0, 0][i]);
const networkCounts = (changes = {}) => [...counts({ dense: 13, ...changes }), 1, 1, changes.maxFrequencies ?? 1];

const head = [[0, 0, 0], 0.5, 0];
const target = [0, 0, 2, 2, 4, 0, 6];
const times = [3, [0, 0, 10], 1];
const still = [0, 1, 0, [4, -8, 0]];
const moving = [0, 2, 0, [4, -8, 0]];
const end = [0, 0];
const good = [head, target, times, still, end];
const rotation = (...references) => [[0, 0, 0], 0.5, 0, 1, [0, references[0], 0, references[1], 0, references[2]]];
const networkHead = [[0, 1, 0], 0.5, 0, target, times, moving, end];
const layer = [1, 5, [2, -3, 1], -1];

const corrupt = {
  network_without_numbers: [counts(), [[0, 1, 0]]],
  numbers_without_network: [networkCounts(), good],
  base_step_infinite: [counts(), [[0, 0, 0], Infinity]],
  base_step_no_number: [counts(), [[0, 0, 0], NaN]],
  anchor_exponent: [counts(), [[0, 0, 0], 0.5, 256]],
  path: [counts(), [head, 4]],
  morph_weights_none: [counts(), [head, 3, 0]],
  targets_beyond_slots: [counts({ slots: 2 }), [head, 0]],
  slots_left: [counts({ slots: 4 }), good],
  step_exponent: [counts(), [head, 0, 128]],
  exact_reference_infinite: [counts(), [[1, 0, 0], 0.5, 0, 0, -Infinity]],
  exact_rotation_not_unit: [counts({ slots: 4 }), [[1, 0, 0], 0.5, 0, 1, [0.8, 0.2, 0, 0.6], times, still, end]],
  rotation_vector_too_long: [counts({ slots: 4 }), [rotation(64, 0, 0), times, still, end]],
  no_samples: [counts(), [head, target, 0]],
  more_samples: [counts(), [head, target, 4]],
  fewer_samples: [counts({ samples: 4 }), good],
  rate_zero: [counts(), [head, target, 3, 0, 0, 0]],
  double_step_infinite: [counts(), [head, target, 3, 2, 0, Infinity]],
  times_equal: [counts(), [head, target, 3, [1, 0, 0], 1]],
  times_fall: [counts(), [head, target, 3, [0, 0, 10], 0, 0, 0, -(10 ** 8)]],
  time_infinite: [counts(), [head, target, 3, [0, 0, 10], 0, 0x7f800000]],
  basis: [counts(), [head, target, times, 3]],
  periodic_of_one_sample: [counts({ samples: 1 }), [head, target, 1, [0, 0, 10], 1, 1]],
  windows_none: [counts(), [head, target, times, 2, 0]],
  windows_as_many_as_samples: [counts({ windows: 3 }), [head, target, times, 2, 3]],
  more_windows: [counts(), [head, target, times, 2, 2]],
  fewer_windows: [counts({ windows: 2 }), good],
  window_empty: [counts({ windows: 2 }), [head, target, times, 2, 2, 0, 0]],
  window_too_long: [counts({ windows: 2 }), [head, target, times, 2, 2, 0, 2]],
  state: [counts(), [head, target, times, 0, 4]],
  quaternion_of_translation: [counts(), [head, target, times, 0, 3]],
  reference_to_later_clip: [counts(), [head, target, times, 0, 1, 1]],
  more_anchors: [counts({ anchors: 2 }), [head, target, times, 0, 1, 0]],
  fewer_anchors: [counts({ anchors: 4 }), good],
  anchor_too_large: [counts({ anchors: 6 }), [head, target, times, 2, 1, 2, 0, [2 ** 23 - 1, 0, 0, 1]]],
  weight_exponent: [counts(), [head, target, times, still, -256]],
  more_features: [counts({ maxFeatures: 2, weights: 3 }), [head, target, times, moving, 0, 3]],
  last_level_zero: [counts({ maxFeatures: 2, weights: 2 }), [head, target, times, moving, 0, 2, [1, 0]]],
  more_weights: [counts({ maxFeatures: 2, weights: 1 }), [head, target, times, moving, 0, 2, [1, 1]]],
  fewer_weights: [counts({ maxFeatures: 2, weights: 3 }), [head, target, times, moving, 0, 2, [1, 1], 0, 0, 0]],
  more_atoms: [counts({ atoms: 1 }), [head, target, times, moving, 0, 2]],
  fewer_atoms: [counts({ atoms: 2 }), [head, target, times, moving, 0, 1, [1, 0, 0, 5]]],
  atom_after_the_end: [counts({ atoms: 2 }), [head, target, times, moving, 0, 2, [2, 0, 0, 5], [1, 0, 0, 5]]],
  atom_gap: [counts({ atoms: 1 }), [head, target, times, moving, 0, 1, [3]]],
  atom_parameter: [counts({ atoms: 1 }), [head, target, times, moving, 0, 1, [1, 3, 0, 5]]],
  atom_width: [counts({ atoms: 1 }), [head, target, times, moving, 0, 1, [1, 0, 16, 5]]],
  jump_to_the_first_sample: [counts({ atoms: 1 }), [head, target, times, moving, 0, 1, [0, 0, 17, 5]]],
  atom_level: [counts({ atoms: 1 }), [head, target, times, moving, 0, 1, [1, 0, 0, -(2 ** 23)]]],
  atom_of_what_stands_still: [counts({ atoms: 1 }), [head, target, times, still, 0, 1, [1, 0, 0, 5]]],
  more_frequencies: [networkCounts(), [networkHead, 2]],
  frequency: [networkCounts(), [networkHead, 1, 65536]],
  more_dense: [networkCounts({ dense: 4 }), [networkHead, 1]],
  fewer_dense: [networkCounts({ dense: 14 }), [networkHead, layer, 3]],
  outputs: [networkCounts(), [networkHead, layer, 2]],
  network_infinite: [networkCounts(), [networkHead, layer, 3, Infinity]],
};

const header = (changes) => {
  const all = counts(changes);
  if (all[9] > 0) all.push(changes.hidden0 ?? 1, changes.hidden1 ?? 1, changes.maxFrequencies ?? 1);
  return stream(all, [0, 0, 0, 0]);
};
const limit = {
  slots: header({ slots: 65536 }),
  targets: header({ targets: 4 }),
  clips: header({ clips: 65536 }),
  samples: header({ samples: 2 ** 27 + 1 }),
  samples_for_the_size: header({ samples: 2 ** 21 }),
  windows: header({ windows: 4 }),
  windows_for_the_size: header({ samples: 2 ** 18, windows: 2 ** 18 }),
  anchors: header({ anchors: 2 ** 21 }),
  weights: header({ weights: 2 ** 17 }),
  atoms: header({ atoms: 2 ** 17 }),
  max_features: header({ maxFeatures: 65536 }),
  dense: header({ dense: 2 ** 17 }),
  hidden0: header({ dense: 9, hidden0: 4097 }),
  hidden1: header({ dense: 9, hidden1: 4097 }),
  max_frequencies: header({ dense: 9, maxFrequencies: 65536 }),
  slots_times_features: header({ slots: 60000, maxFeatures: 60000 }),
  clips_times_targets: header({ slots: 60000, targets: 60000, clips: 60000 }),
  windows_times_targets: header({ slots: 60000, targets: 60000, samples: 60000, windows: 60000 }),
  count_of_33_bits: header({ slots: 2 ** 32 }),
  count_of_six_bytes: sign([78, 77, 67, 1, 0, 0, 0, 0, 128, 128, 128, 128, 128, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1]),
};

const whole = make(counts(), good);
/** 90000 corrections of 0: each is one decision, which soon costs a thousandth of a bit. */
const manyDecisions = [head, target, 90000, [0, 0, 10], 0, Array(90000).fill(0), still, end];
const other = {
  truncated_nothing: new Uint8Array(0),
  truncated_before_version: whole.slice(0, 3),
  truncated_before_checksum: whole.slice(0, 7),
  truncated_in_header: sign(whole.slice(0, 12)),
  truncated_after_one_byte: sign(make(counts(), [[1, 0, 0], 0.5, 0, 0, [1, 2, 3], times, still, end]).slice(0, 19)),
  truncated_in_payload: sign(make(counts(), [[1, 0, 0], 0.5, 0, 0, [1, 2, 3], times, still, end]).slice(0, 26)),
  truncated_many_decisions: make(counts({ samples: 90000 }), manyDecisions),
  magic: Uint8Array.of(78, 77, 68, ...whole.slice(3)),
  version: Uint8Array.of(78, 77, 67, 2, ...whole.slice(4)),
  checksum: Uint8Array.from(whole, (byte, i) => byte ^ (i === whole.length - 1 ? 1 : 0)),
};

/** All bad streams by name. */
export function badStreams() {
  return {
    ...other,
    ...Object.fromEntries(Object.entries(limit).map(([name, bytes]) => [`limit_${name}`, bytes])),
    ...Object.fromEntries(Object.entries(corrupt).map(([name, [all, numbers]]) => [`corrupt_${name}`, make(all, numbers)])),
  };
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  if (process.argv.length !== 3) throw new Error('usage: node make_bad.mjs FOLDER');
  for (const [name, bytes] of Object.entries(badStreams())) writeFileSync(join(process.argv[2], `${name}.nmc`), bytes);
}

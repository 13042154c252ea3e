// The extension's JSON: which stream and which clip an animation has, and what its targets move. Shared by all loaders.
import { need as needOrThrow } from './error.js';
import { openSet } from './open.js';

export const EXTENSION = 'NMC_animation_compression';

const need = (condition, message) => needOrThrow(condition, message, 'extension');

const isIndex = (value, count) => Number.isInteger(value) && value >= 0 && value < count;
const isObject = (value) => typeof value === 'object' && value !== null && !Array.isArray(value);

/**
 * The clip of an animation.
 * @param {object} json a glTF document
 * @param {number} index of the animation
 * @returns {{clipSet: number, clip: number, stub: boolean} | null} null if the animation has none
 * @throws {NmcError} `extension`
 */
export function clipReference(json, index) {
  need(json.animations === undefined || (Array.isArray(json.animations) && json.animations.every(isObject)), 'the animations are no list');
  const reference = json.animations?.[index]?.extensions?.[EXTENSION];
  if (reference === undefined) return null;
  const sets = rootExtension(json).clipSets;
  need(
    isObject(reference) && isIndex(reference.clipSet, sets.length) && isIndex(reference.clip, 65535),
    `animation ${index} refers to no clip`,
  );
  return { clipSet: reference.clipSet, clip: reference.clip, stub: reference.stub === true };
}

/** The extension object of the document's root, its version and its list of sets checked. */
export function rootExtension(json) {
  const root = json.extensions?.[EXTENSION];
  need(isObject(root), `the document has no ${EXTENSION} object`);
  need(root.version === 1, `version ${root.version} of ${EXTENSION} is not known`);
  need(Array.isArray(root.clipSets) && root.clipSets.length > 0, 'the extension has no clip sets');
  return root;
}

/**
 * The channels of an animation that are motion: all but the stub's.
 * @param {object} animation of the document
 * @returns {object[]}
 * @throws {NmcError} `extension`
 */
export function trueChannels(animation) {
  const { channels, samplers } = animation;
  need(
    [channels, samplers].every((list) => Array.isArray(list) && list.every(isObject)),
    'an animation has no list of channels and samplers',
  );
  return animation.extensions?.[EXTENSION]?.stub === true ? channels.slice(1) : channels;
}

/**
 * Opens a clip set and joins its targets with nodes.
 * @param {object} json a glTF document
 * @param {number} index in the extension's clipSets
 * @param {Uint8Array} bytes of that set's bufferView
 * @param {object} [options] of openSet
 * @returns {{set: ClipSet, nodes: Int32Array}} nodes: per target of the stream the node that it moves
 * @throws {NmcError} if the stream is broken or does not fit the document
 */
export function openClipSet(json, index, bytes, options) {
  const nodes = clipSetNodes(json, index);
  const set = openSet(bytes, options);
  need(
    set.targets.length === nodes.length,
    `clip set ${index} has ${nodes.length} targets in the document and ${set.targets.length} in its stream`,
  );
  set.targets.forEach(({ path }, t) => need(path === nodes[t].path, `target ${t} of clip set ${index} is no ${path} in the document`));
  return { set, nodes: Int32Array.from(nodes, ({ node }) => node) };
}

/** The bufferView of a clip set. */
export function clipSetView(json, index) {
  const view = rootExtension(json).clipSets[index]?.bufferView;
  need(isIndex(view, json.bufferViews?.length ?? 0), `clip set ${index} has no bufferView`);
  return view;
}

function clipSetNodes(json, index) {
  const groups = rootExtension(json).clipSets[index]?.targets;
  need(Array.isArray(groups), `clip set ${index} has no targets`);
  const targets = [];
  const seen = new Set();
  for (const group of groups) {
    need(isObject(group) && Array.isArray(group.nodes), `clip set ${index} has a target without nodes`);
    for (const node of group.nodes) {
      need(isIndex(node, json.nodes?.length ?? 0), `clip set ${index} moves a node that is not there`);
      need(!seen.has(`${group.path} ${node}`), `clip set ${index} moves the ${group.path} of node ${node} twice`);
      seen.add(`${group.path} ${node}`);
      targets.push({ path: group.path, node });
    }
  }
  return targets;
}

/** The clip of a set; throws if the stream has no such clip. */
export function clipOf(set, reference) {
  need(reference.clip < set.clips.length, `clip set ${reference.clipSet} has no clip ${reference.clip}`);
  return set.clips[reference.clip];
}

// three.js: a plug-in for GLTFLoader.
import { AnimationClip, Interpolant, NumberKeyframeTrack, QuaternionKeyframeTrack, VectorKeyframeTrack } from 'three';
import { EXTENSION, clipOf, clipReference, clipSetView, openClipSet, rootExtension, trueChannels } from './extension.js';

const PROPERTIES = { translation: 'position', rotation: 'quaternion', scale: 'scale', weights: 'morphTargetInfluences' };
const TRACKS = {
  translation: VectorKeyframeTrack,
  rotation: QuaternionKeyframeTrack,
  scale: VectorKeyframeTrack,
  weights: NumberKeyframeTrack,
};

/**
 * What `GLTFLoader.register` takes: `new GLTFLoader().register(nmcPlugin())`.
 * @param {{streaming?: boolean, decoder?: string}} [options] streaming: clips keep no keys and evaluate their poses while they play. They take a
 *   fraction of the memory, but three.js cannot edit them (trim, optimize, subclip, additive clips). decoder: as in openSet.
 */
export function nmcPlugin({ streaming = false, decoder } = {}) {
  return (parser) => new NmcAnimationPlugin(parser, streaming, decoder);
}

class NmcAnimationPlugin {
  constructor(parser, streaming, decoder) {
    this.name = EXTENSION;
    this.parser = parser;
    this.decoder = decoder;
    this.makeTracks = streaming ? streamingTracks : keyTracks;
    this.sets = new Map();
  }

  /** The hook of GLTFLoader; null leaves an animation to it. */
  loadAnimation(index) {
    const { json } = this.parser;
    const reference = clipReference(json, index);
    return reference === null || rootExtension(json).fallback === true ? null : this.loadClip(index, reference);
  }

  async loadClip(index, reference) {
    const { parser } = this;
    const [{ set, nodes }, others] = await Promise.all([this.loadSet(reference.clipSet), this.loadOtherChannels(index)]);
    const clip = clipOf(set, reference);
    const tracks = [...others.tracks];
    for (const { target, make } of this.makeTracks(set, clip)) {
      const node = await parser.getDependency('node', nodes[target]);
      const { path } = set.targets[target];
      for (const name of targetNames(node, path)) tracks.push(make(TRACKS[path], `${name}.${PROPERTIES[path]}`));
    }
    const animation = new AnimationClip(others.name, -1, tracks);
    animation.userData = others.userData;
    return animation;
  }

  loadSet(index) {
    if (!this.sets.has(index)) this.sets.set(index, this.openSet(index));
    return this.sets.get(index);
  }

  async openSet(index) {
    const { parser } = this;
    const bytes = await parser.getDependency('bufferView', clipSetView(parser.json, index));
    return openClipSet(parser.json, index, new Uint8Array(bytes), { decoder: this.decoder });
  }

  /** The loader's own clip of the channels that are not compressed; it also knows the animation's name and extras. */
  loadOtherChannels(index) {
    const animations = [...this.parser.json.animations];
    animations[index] = { ...animations[index], channels: trueChannels(animations[index]) };
    const view = Object.create(this.parser, { json: { value: { ...this.parser.json, animations } } });
    return view.loadAnimation(index);
  }
}

/** The names by which three.js finds what a target moves. Weights belong to the meshes of the node's primitives. */
function targetNames(node, path) {
  if (path !== 'weights') return [node.name || node.uuid];
  const meshes = [node, ...(node.isGroup ? node.children : [])];
  return meshes.filter((mesh) => mesh.morphTargetInfluences).map((mesh) => mesh.name || mesh.uuid);
}

function keyTracks(set, clip) {
  return clip.decode().map(({ target, times, values }) => ({ target, make: (Track, name) => new Track(name, times, values) }));
}

/** Tracks of two keys, which tell three.js the length, and whose interpolants look into the clip. */
function streamingTracks(set, clip) {
  const shared = { clip, seconds: NaN, pose: new Float32Array(set.slots) };
  const first = clip.evaluate(clip.times[0], shared.pose).slice();
  const ends = clip.times.length > 1 ? [clip.times[0], clip.end] : [clip.times[0]];
  const tracks = [];
  set.targets.forEach(({ slot, width }, target) => {
    if (clip.states[target] === 0) return;
    const rest = first.subarray(slot, slot + width);
    const make = (Track, name) => {
      const track = new Track(
        name,
        ends,
        ends.flatMap(() => [...rest]),
      );
      track.createInterpolant = (result) => new PoseInterpolant(track, shared, slot, width, result);
      return track;
    };
    tracks.push({ target, make });
  });
  return tracks;
}

/** One target of a clip. All interpolants of a clip share its pose, which is evaluated once per time. */
class PoseInterpolant extends Interpolant {
  constructor(track, shared, slot, width, result) {
    super(track.times, track.values, width, result ?? undefined);
    this.shared = shared;
    this.slot = slot;
  }

  /** @param {number} seconds @returns the result buffer with the value */
  evaluate(seconds) {
    const { shared, slot, resultBuffer, valueSize } = this;
    if (shared.seconds !== seconds) {
      shared.clip.evaluate(seconds, shared.pose);
      shared.seconds = seconds;
    }
    for (let i = 0; i < valueSize; ++i) resultBuffer[i] = shared.pose[slot + i];
    return resultBuffer;
  }
}

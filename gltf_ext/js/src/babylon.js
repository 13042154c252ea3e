// Babylon.js: a loader extension. It imports nothing of Babylon, so it serves the packages and the script builds alike.
import { EXTENSION, clipOf, clipReference, clipSetView, openClipSet, rootExtension, trueChannels } from './extension.js';

export { EXTENSION };

const TYPES = { translation: 'VEC3', rotation: 'VEC4', scale: 'VEC3', weights: 'SCALAR' };
const COMPONENTS = { VEC3: 3, VEC4: 4, SCALAR: 1 };
const FLOAT = 5126;

/** What registerGLTFExtension takes: `registerGLTFExtension(EXTENSION, true, nmcExtension)`. */
export function nmcExtension(loader) {
  return new NmcAnimationExtension(loader);
}

/**
 * The same with options: `registerGLTFExtension(EXTENSION, true, nmcExtensionWith({ decoder: 'js' }))`.
 * @param {{decoder?: string}} [options] as in openSet
 */
export function nmcExtensionWith({ decoder } = {}) {
  return (loader) => new NmcAnimationExtension(loader, decoder);
}

/** Gives the loader plain channels, whose accessors lie in bufferViews that only this extension can read. */
class NmcAnimationExtension {
  constructor(loader, decoder) {
    this.decoder = decoder;
    this.name = EXTENSION;
    this.enabled = loader.isExtensionUsed(EXTENSION);
    this.loader = loader;
    this.sets = new Map();
    this.decoded = new Map();
    // Animations that have plain channels by now; the loader is asked once more for each of them.
    this.plain = new WeakSet();
  }

  dispose() {
    this.loader = null;
    this.sets.clear();
    this.decoded.clear();
  }

  /** The hook of the loader; null leaves an animation to it. */
  loadAnimationAsync(context, animation) {
    const { gltf } = this.loader;
    if (this.plain.has(animation) || gltf.extensions?.[EXTENSION]?.fallback === true) return null;
    const reference = animation.extensions?.[EXTENSION] ? clipReference(gltf, gltf.animations.indexOf(animation)) : null;
    return reference === null ? null : this.loadClip(context, animation, reference);
  }

  /** The hook of the loader for the bufferViews of decoded keys. */
  loadBufferViewAsync(context, bufferView) {
    const floats = this.decoded.get(bufferView);
    return floats ? Promise.resolve(floats) : null;
  }

  async loadClip(context, animation, reference) {
    const { set, nodes } = await this.loadSet(reference.clipSet);
    const samplers = [...animation.samplers];
    const channels = trueChannels(animation);
    const inputs = new Map();
    for (const { target, times, values } of clipOf(set, reference).decode()) {
      const { path } = set.targets[target];
      if (!inputs.has(times)) inputs.set(times, this.addAccessor(times, 'SCALAR'));
      samplers.push({ input: inputs.get(times), output: this.addAccessor(values, TYPES[path]), interpolation: 'LINEAR' });
      channels.push({ sampler: samplers.length - 1, target: { node: nodes[target], path } });
    }
    animation.samplers = samplers;
    animation.channels = channels;
    this.plain.add(animation);
    return this.loader.loadAnimationAsync(context, animation);
  }

  addAccessor(floats, type) {
    const { gltf } = this.loader;
    const bufferView = { index: gltf.bufferViews.length, buffer: 0, byteOffset: 0, byteLength: floats.byteLength };
    gltf.bufferViews.push(bufferView);
    this.decoded.set(bufferView, floats);
    gltf.accessors ??= [];
    const index = gltf.accessors.length;
    gltf.accessors.push({ index, bufferView: bufferView.index, componentType: FLOAT, count: floats.length / COMPONENTS[type], type });
    return index;
  }

  loadSet(index) {
    if (!this.sets.has(index)) this.sets.set(index, this.openSet(index));
    return this.sets.get(index);
  }

  async openSet(index) {
    const { gltf } = this.loader;
    rootExtension(gltf);
    const view = clipSetView(gltf, index);
    const bytes = await this.loader.loadBufferViewAsync(`/bufferViews/${view}`, gltf.bufferViews[view]);
    return openClipSet(gltf, index, new Uint8Array(bytes.buffer, bytes.byteOffset, bytes.byteLength), { decoder: this.decoder });
  }
}

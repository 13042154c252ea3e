// glTF-Transform: an extension whose reading gives ordinary animations. What is written afterwards is plain glTF.
import { Extension } from '@gltf-transform/core';
import { EXTENSION, clipOf, clipReference, clipSetView, openClipSet, rootExtension } from './extension.js';

const TYPES = { translation: 'VEC3', rotation: 'VEC4', scale: 'VEC3', weights: 'SCALAR' };

/** For `io.registerExtensions([NMCAnimationCompression])`. */
export class NMCAnimationCompression extends Extension {
  static EXTENSION_NAME = EXTENSION;
  extensionName = EXTENSION;
  /** Which decoder reads, as in openSet; to be set before reading. A subclass may have one of its own, for one IO among others. */
  static decoder = 'auto';

  /** The hook of the reader. */
  read(context) {
    const { json } = context.jsonDoc;
    if (rootExtension(json).fallback !== true) {
      const sets = new Map();
      context.animations.forEach((animation, index) => {
        const reference = clipReference(json, index);
        if (reference === null) return;
        if (!sets.has(reference.clipSet)) sets.set(reference.clipSet, openSet(context, reference.clipSet, this.constructor.decoder));
        if (reference.stub) removeStub(animation);
        this.addClip(context, animation, reference, sets.get(reference.clipSet));
      });
    }
    // The document has plain keys now.
    this.dispose();
    return this;
  }

  /** The hook of the writer; there is nothing to write. */
  write() {
    return this;
  }

  addClip(context, animation, reference, { set, nodes, buffer }) {
    const { document } = this;
    const inputs = new Map();
    for (const { target, times, values } of clipOf(set, reference).decode()) {
      const { path } = set.targets[target];
      if (!inputs.has(times)) inputs.set(times, document.createAccessor('', buffer).setType('SCALAR').setArray(times));
      const output = document.createAccessor('', buffer).setType(TYPES[path]).setArray(values);
      const sampler = document.createAnimationSampler().setInput(inputs.get(times)).setOutput(output).setInterpolation('LINEAR');
      const channel = document.createAnimationChannel().setSampler(sampler).setTargetNode(context.nodes[nodes[target]]).setTargetPath(path);
      animation.addSampler(sampler).addChannel(channel);
    }
  }
}

function openSet(context, index, decoder) {
  const { json } = context.jsonDoc;
  const view = clipSetView(json, index);
  return { ...openClipSet(json, index, context.bufferViews[view], { decoder }), buffer: context.bufferViewBuffers[view] };
}

/** Takes the stub's channel away, and what only it used. */
function removeStub(animation) {
  const channel = animation.listChannels()[0];
  const sampler = channel.getSampler();
  channel.dispose();
  const used = (property) => property.listParents().some((parent) => parent.propertyType !== 'Root' && parent !== animation);
  if (sampler === null || used(sampler)) return;
  const accessors = [sampler.getInput(), sampler.getOutput()];
  sampler.dispose();
  for (const accessor of accessors) if (accessor !== null && !accessor.isDisposed() && !used(accessor)) accessor.dispose();
}

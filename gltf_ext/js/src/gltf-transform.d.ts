import { Extension } from '@gltf-transform/core';
import type { Decoder } from './index.js';
import type { ReaderContext, WriterContext } from '@gltf-transform/core';

/** For `io.registerExtensions([NMCAnimationCompression])`: reading gives ordinary animations, and what is written afterwards is plain glTF. */
export class NMCAnimationCompression extends Extension {
  static readonly EXTENSION_NAME: 'NMC_animation_compression';
  readonly extensionName: 'NMC_animation_compression';
  /** Which decoder reads; `auto` at first. To be set before reading. A subclass may have one of its own, for one IO among others. */
  static decoder: Decoder;
  read(context: ReaderContext): this;
  write(context: WriterContext): this;
}

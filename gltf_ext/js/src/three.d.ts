import type { Decoder } from './index.js';
import type { GLTFLoaderPlugin, GLTFParser } from 'three/addons/loaders/GLTFLoader.js';

export interface NmcPluginOptions {
  /**
   * Clips keep no keys and evaluate their poses while they play (default false). They take a fraction of the memory, but three.js cannot edit
   * them: trim, optimize, subclip, additive clips.
   */
  streaming?: boolean;
  /** As in openSet. */
  decoder?: Decoder;
}

/** What `GLTFLoader.register` takes: `new GLTFLoader().register(nmcPlugin())`. */
export function nmcPlugin(options?: NmcPluginOptions): (parser: GLTFParser) => GLTFLoaderPlugin;

import type { IGLTFLoaderExtension } from '@babylonjs/loaders/glTF/2.0/glTFLoaderExtension.js';
import type { GLTFLoader } from '@babylonjs/loaders/glTF/2.0/glTFLoader.js';

import type { Decoder } from './index.js';

/** The extension's name, for registerGLTFExtension. */
export const EXTENSION: 'NMC_animation_compression';

/** What registerGLTFExtension takes: `registerGLTFExtension(EXTENSION, true, nmcExtension)`. */
export function nmcExtension(loader: GLTFLoader): IGLTFLoaderExtension;

/** The same with a choice of the decoder: `registerGLTFExtension(EXTENSION, true, nmcExtensionWith({ decoder: 'js' }))`. */
export function nmcExtensionWith(options?: { decoder?: Decoder }): (loader: GLTFLoader) => IGLTFLoaderExtension;

import type { IGLTFLoaderExtension } from '@babylonjs/loaders/glTF/2.0/glTFLoaderExtension.js';
import type { GLTFLoader } from '@babylonjs/loaders/glTF/2.0/glTFLoader.js';

/** The extension's name, for registerGLTFExtension. */
export const EXTENSION: 'NMC_animation_compression';

/** What registerGLTFExtension takes: `registerGLTFExtension(EXTENSION, true, nmcExtension)`. */
export function nmcExtension(loader: GLTFLoader): IGLTFLoaderExtension;

// The package's main entry: the decoders and expand. The engines' plug-ins are entries of their own.
export { NmcError } from './error.js';
export { expand, expandJson } from './expand.js';
export { openSet } from './open.js';

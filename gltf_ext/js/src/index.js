// The package's main entry: the decoder and expand. The engines' plug-ins are entries of their own.
export { openSet } from './decoder.js';
export { NmcError } from './error.js';
export { expand, expandJson } from './expand.js';

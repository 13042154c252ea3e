// The one kind of error that this package throws on bad input.

/**
 * A broken stream, a broken file or a wrong argument. `code` says which kind, for programs:
 *
 * - `magic`, `version`, `checksum`: not a stream, not version 1, damaged bytes
 * - `limit`: the header asks for more than the specification allows
 * - `truncated`: the payload ends too early, or holds more decisions than allowed
 * - `value`: something read is out of range or contradicts the rest; `total`: a count of the header is not met
 * - `glb`, `extension`: the container or the extension's JSON is broken
 * - `argument`: the caller's argument makes no sense
 */
export class NmcError extends Error {
  /** @param {string} code @param {string} message */
  constructor(code, message) {
    super(message);
    this.name = 'NmcError';
    this.code = code;
  }
}

/** Throws an NmcError unless the condition holds. */
export function need(condition, message, code = 'value') {
  if (!condition) throw new NmcError(code, message);
}

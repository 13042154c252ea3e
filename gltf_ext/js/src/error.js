// The one kind of error that this package throws on bad input.

/** The sentences of the specification's table "Refusals". */
const sentences = {
  truncated: 'the stream ends too early',
  magic: 'the stream does not begin with "NMC"',
  version: 'the stream has a version that this decoder does not know',
  checksum: "the stream's bytes do not match its checksum",
  limit: "a count in the stream is above the format's limits",
  corrupt: 'a value in the stream contradicts another',
};

/**
 * A broken stream, a broken file or a wrong argument. `code` says which kind, for programs:
 *
 * - `truncated`, `magic`, `version`, `checksum`, `limit`, `corrupt`: what is wrong with a stream; the table "Refusals" of the specification
 *   has these codes, and the sentences that are their messages
 * - `glb`, `extension`: the container or the extension's JSON is broken
 * - `argument`: the caller's argument makes no sense
 *
 * `detail` says more precisely what was found.
 */
export class NmcError extends Error {
  /** @param {string} code @param {string} detail */
  constructor(code, detail) {
    super(sentences[code] ?? detail);
    this.name = 'NmcError';
    this.code = code;
    this.detail = detail;
  }
}

/** Throws an NmcError unless the condition holds. */
export function need(condition, detail, code = 'corrupt') {
  if (!condition) throw new NmcError(code, detail);
}

// What the two threads of the command agree on about temporary files: who may touch them, and which there are.
import { createRequire } from 'node:module';

/** States of the lock. The worker holds it whenever a temporary file appears, goes or becomes its target; the main thread takes it for ever. */
export const FREE = 0;
const HELD = 1;
export const TAKEN = 2;

/** Wraps Node's functions in this thread so that `port` is told of every temporary file, each under the lock. */
export function watchReplacements(lock, port) {
  const fs = createRequire(import.meta.url)('node:fs');
  const unfinished = new Set();
  let held = false;

  const hold = () => {
    if (held) return;
    held = true;
    if (Atomics.compareExchange(lock, 0, FREE, HELD) === TAKEN) Atomics.wait(lock, 0, TAKEN);
  };
  const release = () => {
    held = false;
    Atomics.store(lock, 0, FREE);
  };
  const ended = (file) => {
    unfinished.delete(file);
    port.postMessage({ ended: file });
  };

  const { openSync, renameSync, unlinkSync } = fs;
  fs.openSync = (file, flags, mode) => {
    if (!(flags & fs.constants.O_EXCL)) return openSync(file, flags, mode);
    hold();
    try {
      const descriptor = openSync(file, flags, mode);
      unfinished.add(file);
      port.postMessage({ begun: file });
      return descriptor;
    } finally {
      release();
    }
  };
  // Files that replace others together are renamed one after the other: the lock is kept until the last one.
  fs.renameSync = (from, to) => {
    hold();
    try {
      renameSync(from, to);
      ended(from);
    } catch (failure) {
      release();
      throw failure;
    }
    if (unfinished.size === 0) release();
  };
  fs.unlinkSync = (file) => {
    hold();
    try {
      unlinkSync(file);
      ended(file);
    } finally {
      release();
    }
  };
}

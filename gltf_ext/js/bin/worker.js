// Runs the compressor's WebAssembly in this thread, with the arguments of the command, on the real files and streams.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { fileURLToPath } from 'node:url';
import { workerData } from 'node:worker_threads';
import { watchReplacements } from './replacements.js';

const require = createRequire(import.meta.url);
const program = fileURLToPath(new URL('gltf-nmc.wasm', import.meta.url));

/** A pipe that its reader has set not to block and does not empty fast enough takes no bytes for a while. */
function writeWhateverItTakes() {
  const fs = require('node:fs');
  const { writeSync } = fs;
  const pause = new Int32Array(new SharedArrayBuffer(4));
  fs.writeSync = (...args) => {
    for (;;) {
      try {
        return writeSync(...args);
      } catch (failure) {
        if (failure.code !== 'EAGAIN') throw failure;
        Atomics.wait(pause, 0, 0, 1);
      }
    }
  };
}

watchReplacements(workerData.lock, workerData.port);
writeWhateverItTakes();
await require('./gltf-nmc.cjs')({
  arguments: process.argv.slice(2),
  columns: workerData.columns,
  thisProgram: program,
  wasmBinary: readFileSync(program),
  preRun: (module) => Object.assign(module.ENV, process.env),
});

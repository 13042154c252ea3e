#!/usr/bin/env node
// The command gltf-nmc: runs the compressor in a thread of its own, so that this one can take signals, and ends with its exit code.
import { existsSync, rmSync, writeSync } from 'node:fs';
import { isatty } from 'node:tty';
import { MessageChannel, Worker, receiveMessageOnPort } from 'node:worker_threads';
import { FREE, TAKEN } from './replacements.js';

const internal = 6;
const stderr = 2;
const here = new URL('.', import.meta.url);

function fail(sentence) {
  process.exitCode = internal;
  writeSync(stderr, `gltf-nmc: ${sentence}\n`);
}

/** Waits until no file is being created or replaced, and lets none begin any more. */
function takeFiles(lock, then) {
  if (Atomics.compareExchange(lock, 0, FREE, TAKEN) === FREE) then();
  else setTimeout(takeFiles, 1, lock, then);
}

function removeUnfinished(port) {
  const unfinished = new Set();
  for (let next = receiveMessageOnPort(port); next; next = receiveMessageOnPort(port)) {
    if (next.message.begun) unfinished.add(next.message.begun);
    else unfinished.delete(next.message.ended);
  }
  for (const file of unfinished) rmSync(file, { force: true });
}

/** Signals end the process as they always do, after its temporary files are gone. */
function endCleanlyOnSignals(worker, lock, port) {
  for (const signal of ['SIGINT', 'SIGTERM', 'SIGHUP']) {
    process.once(signal, () =>
      takeFiles(lock, async () => {
        worker.removeAllListeners();
        await worker.terminate();
        removeUnfinished(port);
        process.kill(process.pid, signal);
      }),
    );
  }
}

function run() {
  const lock = new Int32Array(new SharedArrayBuffer(4));
  const { port1, port2 } = new MessageChannel();
  port1.unref();
  // The worker writes to the standard streams itself. Node must not open pipes among them here: it would set them not to block.
  const worker = new Worker(new URL('worker.js', here), {
    argv: process.argv.slice(2),
    workerData: { lock, port: port2, columns: isatty(stderr) ? process.stderr.columns : 0 },
    transferList: [port2],
    stdout: true,
    stderr: true,
  });
  worker.on('error', (error) => {
    removeUnfinished(port1);
    fail(`a defect in gltf-nmc, please report it: ${error.message}.`);
  });
  worker.on('exit', (code) => (process.exitCode ||= code));
  endCleanlyOnSignals(worker, lock, port1);
}

if (existsSync(new URL('gltf-nmc.wasm', here))) run();
else fail('this copy of the package has no compressor; gltf_ext/js/cli/build.sh builds it.');

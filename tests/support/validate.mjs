// Runs the Khronos glTF validator over files and prints one JSON object: {file: {numErrors, numWarnings, codes: {code: count}}}.
// codes has errors and warnings only. Needs `npm install` in tests/. Usage: node validate.mjs FILE...
import { readFile } from "node:fs/promises";
import { dirname, resolve } from "node:path";
import validator from "gltf-validator";

async function validate(file) {
  const bytes = new Uint8Array(await readFile(file));
  const report = await validator.validateBytes(bytes, {
    uri: file,
    maxIssues: 0,
    externalResourceFunction: async (uri) =>
      new Uint8Array(await readFile(resolve(dirname(file), decodeURIComponent(uri)))),
  });
  const { numErrors, numWarnings, messages } = report.issues;
  const codes = {};
  for (const { code, severity } of messages) {
    if (severity < 2) codes[code] = (codes[code] ?? 0) + 1;
  }
  return { numErrors, numWarnings, codes };
}

const reports = {};
for (const file of process.argv.slice(2)) reports[file] = await validate(file);
console.log(JSON.stringify(reports, null, 1));

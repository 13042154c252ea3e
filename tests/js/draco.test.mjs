// Meshes packed by --draco, unpacked by the Draco decoder that three.js brings: another build, in another language.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { test } from 'node:test';
import { compressed, noTool, readGlb, sample } from './support.mjs';

const decoderFile = createRequire(import.meta.url).resolve('three/examples/jsm/libs/draco/gltf/draco_decoder.js');

/** The decoder's file is a script, not a module. */
function loadDraco() {
  const module = { exports: {} };
  new Function('module', 'exports', '__filename', '__dirname', 'require', 'process', readFileSync(decoderFile, 'utf8'))(
    module, module.exports, decoderFile, '', () => ({}), undefined,
  );
  // In an object of its own: the module has a `then` that would be taken for a promise's.
  return new Promise((resolve) => module.exports({ onModuleLoaded: (draco) => resolve({ draco }) }));
}

function floats({ json, bin }, index) {
  const { bufferView, byteOffset = 0, count } = json.accessors[index];
  const view = json.bufferViews[bufferView];
  assert.equal(view.byteStride ?? 12, 12);
  const begin = (view.byteOffset ?? 0) + byteOffset;
  return new Float32Array(bin.buffer.slice(begin, begin + 12 * count));
}

/** The largest distance from a point of `from` (one of 101, for the sake of time) to the nearest one of `to`. */
function farthest(from, to) {
  let largest = 0;
  for (let i = 0; i < from.length; i += 3 * 101) {
    let least = Infinity;
    for (let k = 0; k < to.length; k += 3)
      least = Math.min(least, (from[i] - to[k]) ** 2 + (from[i + 1] - to[k + 1]) ** 2 + (from[i + 2] - to[k + 2]) ** 2);
    largest = Math.max(largest, Math.sqrt(least));
  }
  return largest;
}

test('another Draco decoder finds every vertex in its place', { skip: noTool }, async () => {
  const { draco } = await loadDraco();
  const original = readGlb(readFileSync(sample('humanoid_30hz.glb')));
  const packed = readGlb(readFileSync(compressed(sample('humanoid_30hz.glb'), '--draco', '--tolerance', '1%', '--effort', '1', '--time-limit', '1')));
  assert.ok(packed.json.extensionsRequired.includes('KHR_draco_mesh_compression'));
  let checked = 0;
  packed.json.meshes.forEach((mesh, m) =>
    mesh.primitives.forEach((primitive, p) => {
      const extension = primitive.extensions?.KHR_draco_mesh_compression;
      if (!extension) return;
      const { byteOffset = 0, byteLength } = packed.json.bufferViews[extension.bufferView];
      const decoder = new draco.Decoder();
      const decoded = new draco.Mesh();
      const status = decoder.DecodeArrayToMesh(packed.bin.subarray(byteOffset, byteOffset + byteLength), byteLength, decoded);
      assert.ok(status.ok(), status.error_msg());
      const before = original.json.meshes[m].primitives[p];
      assert.equal(3 * decoded.num_faces(), original.json.accessors[before.indices].count);
      for (const accessor of Object.values(primitive.attributes)) assert.equal(packed.json.accessors[accessor].count, decoded.num_points());
      const array = new draco.DracoFloat32Array();
      decoder.GetAttributeFloatForAllPoints(decoded, decoder.GetAttributeByUniqueId(decoded, extension.attributes.POSITION), array);
      const positions = Float32Array.from({ length: array.size() }, (_, i) => array.GetValue(i));
      const truth = floats(original, before.attributes.POSITION);
      // A tenth of a hundredth of a character of less than two metres.
      assert.ok(farthest(truth, positions) < 0.002);
      assert.ok(farthest(positions, truth) < 0.002);
      const { min, max } = packed.json.accessors[primitive.attributes.POSITION];
      for (let i = 0; i < positions.length; ++i) assert.ok(positions[i] >= min[i % 3] - 1e-6 && positions[i] <= max[i % 3] + 1e-6);
      ++checked;
    }),
  );
  assert.ok(checked > 0);
});

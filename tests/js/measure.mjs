// Plays two files in an engine and measures how far apart their joints are. Runs in pages and in Node; the engine is handed in.

const timesPerClip = 20;

/**
 * @param {object} three what `import * as THREE` gives
 * @param {object} original what GLTFLoader gives
 * @param {object} other the same for the compressed file
 * @returns {{clips: number, size: number, difference: number}} size: largest side of the box around the joints at rest; difference: largest of
 *   all joints, clips and times, as a share of the size
 */
export function measureThree(three, original, other) {
  const players = [original, other].map((gltf) => threePlayer(three, gltf));
  return measure(
    players,
    original.animations.map(({ name, duration }) => ({ name, begin: 0, end: duration })),
  );
}

function threePlayer(three, gltf) {
  const bones = [];
  gltf.scene.traverse((object) => object.isSkinnedMesh && bones.push(...object.skeleton.bones));
  const mixer = new three.AnimationMixer(gltf.scene);
  const point = new three.Vector3();
  let action;
  const positions = () => {
    gltf.scene.updateMatrixWorld(true);
    return bones.flatMap((bone) => bone.getWorldPosition(point).toArray());
  };
  return {
    names: gltf.animations.map(({ name }) => name),
    rest: positions(),
    start(index) {
      mixer.stopAllAction();
      action = mixer.clipAction(gltf.animations[index]);
      action.setLoop(three.LoopOnce);
      action.clampWhenFinished = true;
    },
    pose(seconds) {
      action.reset().play();
      mixer.setTime(seconds);
      return positions();
    },
  };
}

/**
 * The same for Babylon.js.
 * @param {object} original what LoadAssetContainerAsync gives, added to a scene
 */
export function measureBabylon(original, other) {
  const players = [original, other].map(babylonPlayer);
  return measure(
    players,
    original.animationGroups.map(({ name, from, to }) => ({ name, begin: from, end: to })),
  );
}

function babylonPlayer({ animationGroups, skeletons, transformNodes, meshes }) {
  const nodes = [...new Set(skeletons.flatMap(({ bones }) => bones.map((bone) => bone.getTransformNode())))];
  const all = [...transformNodes, ...meshes];
  const rest = all.map((node) => [node.position.clone(), node.rotationQuaternion?.clone(), node.scaling.clone()]);
  let group;
  const positions = () => {
    for (const node of all) node.computeWorldMatrix(true);
    return nodes.flatMap((node) => node.computeWorldMatrix(true) && node.getAbsolutePosition().asArray());
  };
  return {
    names: animationGroups.map(({ name }) => name),
    rest: positions(),
    start(index) {
      group = animationGroups[index];
      for (const each of animationGroups) each.stop();
      all.forEach((node, i) => {
        node.position.copyFrom(rest[i][0]);
        if (rest[i][1]) node.rotationQuaternion.copyFrom(rest[i][1]);
        node.scaling.copyFrom(rest[i][2]);
      });
      group.start(false);
      group.pause();
    },
    pose(frame) {
      group.goToFrame(frame);
      return positions();
    },
  };
}

/**
 * The same for PlayCanvas.
 * @param {object} original what playCanvasModel gives
 */
export function measurePlayCanvas(original, other) {
  const players = [original, other].map(playCanvasPlayer);
  return measure(
    players,
    original.tracks.map(({ name, duration }) => ({ name, begin: 0, end: duration })),
  );
}

function playCanvasPlayer({ entity, tracks }) {
  const { anim } = entity;
  const joints = jointsOf(entity);
  const all = entity.find(() => true);
  const rest = all.map((node) => [node.getLocalPosition().clone(), node.getLocalRotation().clone(), node.getLocalScale().clone()]);
  // States are called after the places of their clips, as names may occur twice, and a full stop in a name has a meaning.
  tracks.forEach((track, index) => anim.assignAnimation(`${index}`, track, undefined, 1, false));
  const positions = () => joints.flatMap((joint) => joint.getPosition().toArray());
  return {
    names: tracks.map(({ name }) => name),
    rest: positions(),
    start(index) {
      anim.baseLayer.play(`${index}`);
      // Or joints that this clip does not move would get the values of the one before, whatever is set here.
      anim.rebind();
      all.forEach((node, i) => {
        node.setLocalPosition(rest[i][0]);
        node.setLocalRotation(rest[i][1]);
        node.setLocalScale(rest[i][2]);
      });
    },
    pose(seconds) {
      anim.baseLayer.activeStateCurrentTime = seconds;
      anim.update(0);
      return positions();
    },
  };
}

/** Waits for a container of PlayCanvas, and adds its model and its animations to the application. */
export async function playCanvasModel(app, asset) {
  await new Promise((done, fail) => {
    asset.on('error', (message) => fail(new Error(message)));
    asset.ready(done);
  });
  const entity = asset.resource.instantiateRenderEntity();
  entity.addComponent('anim');
  app.root.addChild(entity);
  return { entity, tracks: asset.resource.animations.map(({ resource }) => resource) };
}

/** The joints of a PlayCanvas entity's skins. */
export function jointsOf(entity) {
  const skins = entity.findComponents('render').flatMap(({ meshInstances }) => meshInstances.map(({ skinInstance }) => skinInstance));
  return [...new Set(skins.flatMap((skin) => skin?.bones ?? []))];
}

function measure([original, other], clips) {
  if (JSON.stringify(original.names) !== JSON.stringify(other.names)) throw new Error(`clips differ: ${other.names}`);
  if (original.rest.length === 0 || original.rest.length !== other.rest.length) throw new Error('the joints differ');
  const size = boxSize(original.rest);
  let difference = 0;
  let motion = 0;
  clips.forEach(({ begin, end }, index) => {
    original.start(index);
    other.start(index);
    for (let i = 0; i < timesPerClip; ++i) {
      const at = begin + ((end - begin) * i) / (timesPerClip - 1);
      const expected = original.pose(at);
      const actual = other.pose(at);
      difference = Math.max(difference, largestDistance(expected, actual) / size);
      motion = Math.max(motion, largestDistance(expected, original.rest) / size);
    }
  });
  return { clips: clips.length, size, difference, motion };
}

function boxSize(points) {
  const sides = [0, 1, 2].map((axis) => {
    const values = points.filter((_, i) => i % 3 === axis);
    return Math.max(...values) - Math.min(...values);
  });
  return Math.max(...sides);
}

function largestDistance(a, b) {
  let largest = 0;
  for (let i = 0; i < a.length; i += 3) largest = Math.max(largest, Math.hypot(a[i] - b[i], a[i + 1] - b[i + 1], a[i + 2] - b[i + 2]));
  return largest;
}

// The player: clip, time and view, and what is drawn for them.
import { length, percent } from './format.js';
import { Motions, Pose } from './motion.js';
import { Scene } from './scene.js';
import { Skin } from './skin.js';

const find = (id) => document.getElementById(id);

export class Player {
  /** @param onTime called with the time whenever it changes, onClip with the clip */
  constructor(data, { onTime, onClip }) {
    this.data = data;
    this.onTime = onTime;
    this.onClip = onClip;
    this.motions = new Motions(data);
    this.original = new Pose(data.skeleton);
    this.other = new Pose(data.skeleton);
    this.shown = shownNodes(data);
    this.scene = new Scene(find('canvas'), find('floor-canvas'), data.skeleton, this.shown);
    this.skin = Skin.make(find('skin-canvas'), data.skin);
    if (!this.skin) {
      find('show').value = 'skeleton';
      find('show').closest('label').hidden = true;
    }
    this.positions = new Float64Array(3 * this.shown.length);
    this.others = new Float64Array(3 * this.shown.length);
    this.errors = new Float64Array(this.shown.length);
    this.tolerance = data.report.tolerance_world_units;
    this.playing = false;
    this.waiting = null;
    this.time = 0;
    this.speed = 1;
    this.gain = 1;
    /** Milliseconds that the last frames took to be made ready, and that lay between them while playing. */
    this.frames = [];
    this.intervals = [];
    /** Pixels of the skin per pixel of the screen, along a side. */
    this.fineness = 1;
    this.sinceChange = 0;
    find('legend-end').textContent = `tolerance ${percent(this.tolerance / data.size)} = ${length(this.tolerance)}`;
    this.#listen();
    new ResizeObserver(() => this.draw()).observe(find('stage'));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
      this.scene.readColours();
      this.draw();
    });
  }

  choose(clip) {
    this.clip = clip;
    const original = this.motions.original(clip);
    this.hasOriginal = original !== null;
    this.original.setMotion(original);
    this.other.setMotion(this.motions.other(clip));
    const { seconds } = clip.profile;
    this.start = seconds[0] ?? 0;
    this.end = Math.max(clip.row?.duration_seconds ? this.start + clip.row.duration_seconds : 0, seconds[seconds.length - 1] ?? 0);
    this.frame = seconds.length > 2 ? (this.end - this.start) / Math.max(1, clip.row?.frames ? clip.row.frames - 1 : (seconds.length - 1) / 2) : 1 / 30;
    Object.assign(find('scrub'), { min: this.start, max: this.end });
    find('player-note').textContent = this.hasOriginal
      ? 'The decoded motion is evaluated in this page from the compressed bytes. The original’s keys are in the page in 16 bits, for the picture; the numbers and curves come from the exact keys.'
      : 'The decoded motion is evaluated in this page from the compressed bytes. The original is too long to be in the page with the other animations; its error curve is below.';
    this.#frameClip();
    this.onClip(clip);
    this.seek(this.start);
  }

  seek(seconds) {
    this.time = Math.min(this.end, Math.max(this.start, seconds));
    const scrub = find('scrub');
    scrub.value = this.time;
    const words = `${(this.time - this.start).toFixed(2)} of ${(this.end - this.start).toFixed(2)} s`;
    scrub.setAttribute('aria-valuetext', words);
    find('time').textContent = `${(this.time - this.start).toFixed(2)} / ${(this.end - this.start).toFixed(2)} s`;
    this.onTime(this.time);
    this.draw();
  }

  play(on) {
    if (on === this.playing) return;
    this.playing = on;
    const button = find('play');
    button.setAttribute('aria-pressed', on);
    button.setAttribute('aria-label', on ? 'Pause' : 'Play');
    if (!on) {
      this.fineness = 1;
      this.draw();
      return;
    }
    if (this.time >= this.end) this.time = this.start;
    let last = performance.now();
    const step = (now) => {
      if (!this.playing) return;
      const span = this.end - this.start;
      this.#pace(now - last);
      let next = this.time + ((now - last) / 1000) * this.speed;
      last = now;
      if (next > this.end) next = span > 0 ? this.start + ((next - this.start) % span) : this.start;
      this.seek(next);
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  /** Where frames come too slowly, as without a graphics card, the skin is drawn coarser until the player pauses. */
  #pace(milliseconds) {
    this.intervals.push(milliseconds);
    if (this.intervals.length > 240) this.intervals.shift();
    const slow = 30;
    const enough = 6;
    if (++this.sinceChange < enough || this.fineness <= 0.25) return;
    const last = this.intervals.slice(-enough).sort((a, b) => a - b);
    if (last[enough >> 1] <= slow) return;
    this.fineness /= 2;
    this.sinceChange = 0;
  }

  /** How much room the clip needs: the box of its nodes over the clip, around the place that the camera follows. */
  #frameClip() {
    let radius = 0;
    let low = Infinity;
    let high = -Infinity;
    const samples = 24;
    const pose = this.hasOriginal ? this.original : this.other;
    for (let k = 0; k <= samples; ++k) {
      pose.update(this.start + ((this.end - this.start) * k) / samples);
      const center = this.#centerOf(pose);
      const include = (x, y, z) => {
        low = Math.min(low, y);
        high = Math.max(high, y);
        radius = Math.max(radius, Math.hypot(x - center[0], z - center[2]));
      };
      if (k % 6 === 0) this.skin?.eachPlace(pose, include);
      for (const node of this.shown) {
        const at = 16 * node + 12;
        include(pose.world[at], pose.world[at + 1], pose.world[at + 2]);
      }
    }
    this.box = { height: (low + high) / 2, radius: Math.max(radius, this.data.size * 0.1), half: Math.max((high - low) / 2, this.data.size * 0.1) };
    const cell = 10 ** Math.floor(Math.log10(this.data.size));
    this.cell = this.data.size / cell > 4 ? 2 * cell : this.data.size / cell > 2 ? cell : cell / 2;
    pose.update(this.start);
    this.startCenter = this.#centerOf(pose);
    this.floor = Math.min(low, 0) < -this.data.size * 0.05 ? low : Math.abs(low) < 0.2 * this.data.size ? 0 : low;
  }

  #centerOf(pose) {
    const sum = [0, 0, 0];
    for (const node of this.shown) for (let c = 0; c < 3; ++c) sum[c] += pose.world[16 * node + 12 + c];
    return sum.map((v) => v / Math.max(1, this.shown.length));
  }

  /** Poses and errors at once, the picture with the browser's next one, however often this is called before. */
  draw() {
    if (!this.clip) return;
    const begin = performance.now();
    this.other.update(this.time);
    if (this.hasOriginal) this.original.update(this.time);
    else this.original.world.set(this.other.world);
    this.#measure();
    this.updating = performance.now() - begin;
    this.waiting ??= requestAnimationFrame(() => this.#paint());
  }

  #paint() {
    this.waiting = null;
    const begin = performance.now();
    const { scene } = this;
    scene.fit();
    const following = this.#centerOf(this.original);
    const center = find('follow').checked ? following : this.startCenter;
    const box = { center: [center[0], this.box.height, center[2]], radius: this.box.radius, half: this.box.half };
    const side = find('layout').value === 'side' && this.hasOriginal;
    find('stage').classList.toggle('over', !side);
    find('tag-left').textContent = this.hasOriginal ? 'original' : '';
    const { width, height } = scene.canvas;
    const show = find('show').value;
    const withSkin = this.skin !== null && show !== 'skeleton';
    const views = side ? [[0, 0, width / 2, height], [width / 2, 0, width / 2, height]] : [[0, 0, width, height]];
    scene.clear();
    find('skin-canvas').hidden = !withSkin;
    if (withSkin) this.skin.begin(this.original, this.other, { width: this.#coarse(width), height: this.#coarse(height) }, this.tolerance, scene.colours);
    views.forEach((view, i) => {
      const matrix = scene.camera(box, view[2] / view[3]);
      scene.inView(view, () => {
        scene.floor(matrix, view, box.center, this.floor, this.cell);
        const plain = side && i === 0;
        if (withSkin) {
          const coarse = view.map((v) => this.#coarse(v));
          this.skin.draw(matrix, coarse, { gain: plain ? 0 : this.gain, coloured: !plain && this.hasOriginal });
          if (!side && this.gain > 1) this.skin.draw(matrix, coarse, { gain: 0, coloured: false, opacity: 0.35 });
        }
        if (show === 'skin' && withSkin) return;
        if (plain || (!side && this.hasOriginal)) scene.skeletonOf(matrix, view, this.positions, null, plain ? scene.colours.bone : scene.colours.ghost, plain ? 1 : 0.6);
        if (!plain) scene.skeletonOf(matrix, view, this.others, this.hasOriginal ? this.errors : null, scene.colours.bone);
      });
    });
    this.frames.push(this.updating + performance.now() - begin);
    if (this.frames.length > 240) this.frames.shift();
  }

  #coarse(pixels) {
    return Math.round(pixels * this.fineness);
  }

  /** Places of the shown nodes in both poses, the difference enlarged, and the errors in units of the tolerance. */
  #measure() {
    let worst = 0;
    this.shown.forEach((node, i) => {
      let square = 0;
      for (let c = 0; c < 3; ++c) {
        const at = this.original.world[16 * node + 12 + c];
        const difference = this.other.world[16 * node + 12 + c] - at;
        this.positions[3 * i + c] = at;
        this.others[3 * i + c] = at + this.gain * difference;
        square += difference * difference;
      }
      this.errors[i] = Math.sqrt(square) / this.tolerance;
      if (this.errors[i] > this.errors[worst]) worst = i;
    });
    const error = (this.errors[worst] ?? 0) * this.tolerance;
    find('now').textContent =
      this.hasOriginal && error > 0
        ? `worst joint now: ${this.data.skeleton.names[this.shown[worst]] || `node ${this.shown[worst]}`}, ${percent(error / this.data.size)} = ${length(error)}`
        : '';
  }

  #listen() {
    const stage = find('stage');
    find('play').addEventListener('click', () => this.play(!this.playing));
    find('scrub').addEventListener('input', (event) => this.seek(Number(event.target.value)));
    find('speed').addEventListener('change', (event) => (this.speed = Number(event.target.value)));
    find('gain').addEventListener('change', (event) => {
      this.gain = Number(event.target.value);
      this.draw();
    });
    for (const id of ['layout', 'show', 'follow']) find(id).addEventListener('change', () => this.draw());
    find('reset').addEventListener('click', () => this.#reset());
    this.#listenToPointers(stage);
    stage.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.scene.magnify(Math.exp(-event.deltaY * 0.0015));
      this.draw();
    }, { passive: false });
    stage.addEventListener('keydown', (event) => this.#key(event));
    document.addEventListener('keydown', (event) => {
      const taken = event.target.closest('button, select, input, [role="application"], [role="listbox"], a');
      if (event.key === ' ' && !taken) {
        event.preventDefault();
        this.play(!this.playing);
      }
    });
  }

  #reset() {
    this.scene.reset();
    this.draw();
  }

  #key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const turn = 0.12;
    const actions = {
      ArrowLeft: () => this.scene.turn(-turn, 0),
      ArrowRight: () => this.scene.turn(turn, 0),
      ArrowUp: () => this.scene.turn(0, turn),
      ArrowDown: () => this.scene.turn(0, -turn),
      '+': () => this.scene.magnify(1.15),
      '=': () => this.scene.magnify(1.15),
      '-': () => this.scene.magnify(1 / 1.15),
      0: () => this.scene.reset(),
      ' ': () => this.play(!this.playing),
      ',': () => this.seek(this.time - this.frame),
      '.': () => this.seek(this.time + this.frame),
      Home: () => this.seek(this.start),
      End: () => this.seek(this.end),
    };
    if (!actions[event.key]) return;
    event.preventDefault();
    actions[event.key]();
    this.draw();
  }

  /** One finger or the mouse turns, two fingers zoom. */
  #listenToPointers(stage) {
    const pointers = new Map();
    stage.addEventListener('pointerdown', (event) => {
      stage.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    stage.addEventListener('pointermove', (event) => {
      const was = pointers.get(event.pointerId);
      if (!was) return;
      const now = [event.clientX, event.clientY];
      if (pointers.size === 1) {
        this.scene.turn((was[0] - now[0]) * 0.01, (now[1] - was[1]) * 0.01);
      } else {
        const [other] = [...pointers].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
        const apart = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
        this.scene.magnify(apart(now) / apart(was));
      }
      pointers.set(event.pointerId, now);
      this.draw();
    });
    for (const name of ['pointerup', 'pointercancel']) stage.addEventListener(name, (event) => pointers.delete(event.pointerId));
  }
}

/** The joints of the skins; without skins the nodes that move, and those above them. */
function shownNodes({ skeleton, sets, clips }) {
  if (skeleton.joints.length > 0) return skeleton.joints;
  const shown = new Set(sets.flatMap(({ targets }) => targets.map(([node]) => node)));
  for (const { original } of clips) for (let i = 0; original && i < original.length; i += 7) shown.add(original[i]);
  for (const node of [...shown]) for (let n = skeleton.parent[node]; n >= 0; n = skeleton.parent[n]) shown.add(n);
  return [...shown].sort((a, b) => a - b);
}

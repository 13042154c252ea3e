// The character's skeleton on a floor, drawn with a 2D canvas: a camera that turns around it, and errors as colours.
import { viewProjection } from './math.js';

const FIELD = 0.6;
const COLOURS = ['--stage', '--grid', '--bone', '--ghost', '--soft', '--skin', '--cold', '--warm', '--hot', '--over'];

/** Where points are, and how far they are apart, for a colour from 0 to 1 of the tolerance and above. */
export class Scene {
  /** The floor has a canvas of its own, below everything. */
  constructor(canvas, floorCanvas, skeleton, shown) {
    this.canvas = canvas;
    this.floorCanvas = floorCanvas;
    this.floorContext = floorCanvas.getContext('2d');
    this.context = canvas.getContext('2d');
    this.skeleton = skeleton;
    this.shown = shown;
    const isShown = new Set(shown);
    // A bone joins a node with the nearest shown one above it.
    this.bones = shown.map((node) => {
      let above = skeleton.parent[node];
      while (above >= 0 && !isShown.has(above)) above = skeleton.parent[above];
      return [above, node];
    });
    this.reset();
    this.readColours();
  }

  reset() {
    this.yaw = 0.6;
    this.pitch = 0.18;
    this.zoom = 1;
  }

  turn(yaw, pitch) {
    this.yaw += yaw;
    this.pitch = Math.min(1.5, Math.max(-1.5, this.pitch + pitch));
  }

  magnify(factor) {
    this.zoom = Math.min(20, Math.max(0.15, this.zoom * factor));
  }

  readColours() {
    const style = getComputedStyle(this.canvas);
    this.colours = Object.fromEntries(COLOURS.map((name) => [name.slice(2), style.getPropertyValue(name).trim()]));
    const ramp = ['cold', 'warm', 'hot'].map((name) => rgb(this.colours[name]));
    this.ramp = Array.from({ length: 33 }, (_, i) => {
      const [a, b, u] = i < 16 ? [ramp[0], ramp[1], i / 16] : [ramp[1], ramp[2], (i - 16) / 16];
      return `rgb(${a.map((v, c) => Math.round(v + (b[c] - v) * u)).join(',')})`;
    });
  }

  /** The colour of an error in units of the tolerance. */
  colour(error) {
    return error > 1.001 ? this.colours.over : this.ramp[Math.min(32, Math.round(error * 32))];
  }

  /** Adapts to the size on the screen. */
  fit() {
    const scale = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.max(1, Math.round(this.canvas.clientWidth * scale));
    const height = Math.max(1, Math.round(this.canvas.clientHeight * scale));
    for (const one of [this.canvas, this.floorCanvas]) if (one.width !== width || one.height !== height) Object.assign(one, { width, height });
    this.scale = scale;
  }

  /** What the camera sees of a view of this shape; `box` is {center, radius, half} of what is to fill it: half its width and half its height. */
  camera(box, aspect) {
    const slope = Math.tan(FIELD / 2) / 1.12;
    const distance = (Math.max(box.half / slope, box.radius / (slope * aspect)) + box.radius) / this.zoom;
    const { yaw, pitch } = this;
    const eye = [
      box.center[0] + distance * Math.cos(pitch) * Math.sin(yaw),
      box.center[1] + distance * Math.sin(pitch),
      box.center[2] + distance * Math.cos(pitch) * Math.cos(yaw),
    ];
    return viewProjection(eye, box.center, FIELD, aspect, distance / 100, distance * 4 + (box.radius + box.half) * 20);
  }

  clear() {
    for (const context of [this.context, this.floorContext]) context.clearRect(0, 0, this.canvas.width, this.canvas.height);
  }

  /** Calls `draw` with everything clipped to a view [x, y, width, height] in pixels. */
  inView(view, draw) {
    const contexts = [this.context, this.floorContext];
    for (const context of contexts) {
      context.save();
      context.beginPath();
      context.rect(...view);
      context.clip();
    }
    draw();
    for (const context of contexts) context.restore();
  }

  /** A grid on the floor around a place. */
  floor(matrix, view, center, height, cell) {
    const context = this.floorContext;
    const reach = 8;
    const x0 = Math.round(center[0] / cell) * cell;
    const z0 = Math.round(center[2] / cell) * cell;
    context.strokeStyle = this.colours.grid;
    context.lineWidth = this.scale;
    context.beginPath();
    for (let i = -reach; i <= reach; ++i) {
      this.#line(matrix, view, [x0 + i * cell, height, z0 - reach * cell], [x0 + i * cell, height, z0 + reach * cell]);
      this.#line(matrix, view, [x0 - reach * cell, height, z0 + i * cell], [x0 + reach * cell, height, z0 + i * cell]);
    }
    context.stroke();
  }

  /** A line between two points, cut at the camera's plane. */
  #line(m, view, a, b) {
    const p = toClip(m, a);
    const q = toClip(m, b);
    const near = 1e-4;
    if (p[3] < near && q[3] < near) return;
    for (const [one, other] of [[p, q], [q, p]]) {
      if (one[3] >= near) continue;
      const u = (near - one[3]) / (other[3] - one[3]);
      for (let c = 0; c < 4; ++c) one[c] += (other[c] - one[c]) * u;
    }
    this.floorContext.moveTo(...toView(p, view));
    this.floorContext.lineTo(...toView(q, view));
  }

  /**
   * Bones and joints. `positions` has three numbers per shown node; `errors` one per shown node in units of the tolerance, or null for the plain
   * colour.
   */
  skeletonOf(matrix, view, positions, errors, colour, opacity = 1) {
    const { context, scale } = this;
    const places = new Float64Array(2 * this.shown.length);
    const index = (this.index ??= new Map(this.shown.map((node, i) => [node, i])));
    for (let i = 0; i < this.shown.length; ++i) {
      const [x, y] = toView(toClip(matrix, [positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]]), view);
      places[2 * i] = x;
      places[2 * i + 1] = y;
    }
    context.globalAlpha = opacity;
    context.lineCap = 'round';
    context.lineWidth = 3 * scale;
    for (const [above, node] of this.bones) {
      if (above < 0) continue;
      const i = index.get(above);
      const k = index.get(node);
      context.strokeStyle = errors ? this.colour(errors[k]) : colour;
      context.beginPath();
      context.moveTo(places[2 * i], places[2 * i + 1]);
      context.lineTo(places[2 * k], places[2 * k + 1]);
      context.stroke();
    }
    for (let i = 0; i < this.shown.length; ++i) {
      context.fillStyle = errors ? this.colour(errors[i]) : colour;
      context.beginPath();
      context.arc(places[2 * i], places[2 * i + 1], 2.6 * scale, 0, 2 * Math.PI);
      context.fill();
    }
    context.globalAlpha = 1;
  }
}

function rgb(colour) {
  const hex = colour.replace('#', '');
  return [0, 2, 4].map((i) => parseInt(hex.slice(i, i + 2), 16));
}

function toClip(m, p) {
  return [0, 1, 2, 3].map((r) => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r]);
}

function toView([x, y, , w], [left, top, width, height]) {
  return [left + (0.5 + (0.5 * x) / w) * width, top + (0.5 - (0.5 * y) / w) * height];
}

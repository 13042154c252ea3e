// The character's surface in WebGL: both poses skin every vertex, so that the colour is the exact error there.
import { unpack } from './data.js';
import { multiply } from './math.js';

/** Bones in a row of the texture that holds their matrices, four texels each. */
const ROW = 64;

const VERTEX = `#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D palette;
uniform mat4 view;
uniform float gain, tolerance;
uniform int rows;
in vec3 position;
in uvec4 bones;
in vec4 weights;
out vec3 world;
out float error;
vec3 skinned(int pose) {
  vec3 sum = vec3(0.0);
  float total = 0.0;
  for (int i = 0; i < 4; ++i) {
    int x = int(bones[i]) % ${ROW} * 4;
    int y = int(bones[i]) / ${ROW} + pose * rows;
    mat4 bone = mat4(texelFetch(palette, ivec2(x, y), 0), texelFetch(palette, ivec2(x + 1, y), 0), texelFetch(palette, ivec2(x + 2, y), 0), texelFetch(palette, ivec2(x + 3, y), 0));
    sum += weights[i] * (bone * vec4(position, 1.0)).xyz;
    total += weights[i];
  }
  return sum / total;
}
void main() {
  vec3 original = skinned(0);
  vec3 other = skinned(1);
  error = distance(original, other) / tolerance;
  world = original + gain * (other - original);
  gl_Position = view * vec4(world, 1.0);
}`;

const FRAGMENT = `#version 300 es
precision highp float;
uniform vec3 plain, cold, warm, hot, over;
uniform float coloured, opacity;
in vec3 world;
in float error;
out vec4 colour;
void main() {
  vec3 normal = normalize(cross(dFdx(world), dFdy(world)));
  float light = 0.62 + 0.38 * normal.y * 0.5 + 0.3 * dot(normal, normalize(vec3(0.5, 0.3, 0.8)));
  vec3 ramp = error > 1.001 ? over : error < 0.5 ? mix(cold, warm, error * 2.0) : mix(warm, hot, clamp(error * 2.0 - 1.0, 0.0, 1.0));
  colour = vec4(mix(plain, ramp, coloured) * clamp(light, 0.25, 1.0), 1.0) * opacity;
}`;

/** A colour of the style sheet as three numbers from 0 to 1. */
const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);

export class Skin {
  /** Null where there is no surface, or no WebGL. */
  static make(canvas, skin) {
    const few = 150;
    const gl = skin && unpack(skin.indices, Uint32Array).length >= few ? canvas.getContext('webgl2', { antialias: true, premultipliedAlpha: true, preserveDrawingBuffer: true }) : null;
    return gl ? new Skin(canvas, gl, skin) : null;
  }

  constructor(canvas, gl, { nodes, inverseBind, positions, bones, weights, indices }) {
    this.canvas = canvas;
    this.gl = gl;
    this.nodes = nodes;
    this.inverseBind = unpack(inverseBind, Float32Array);
    this.rows = Math.ceil(nodes.length / ROW);
    this.matrices = new Float32Array(2 * this.rows * ROW * 16);
    this.program = this.#program();
    gl.useProgram(this.program);
    this.places = new Proxy({}, { get: (known, name) => (known[name] ??= gl.getUniformLocation(this.program, name)) });
    const corner = unpack(positions, Float32Array);
    const influences = unpack(bones, Uint16Array);
    this.#attribute('position', corner, 3, gl.FLOAT);
    this.#attribute('bones', influences, 4, gl.UNSIGNED_SHORT);
    const every = Math.ceil(corner.length / 3 / 300);
    this.sampled = [];
    for (let v = 0; 3 * v < corner.length; v += every) this.sampled.push([influences[4 * v], corner[3 * v], corner[3 * v + 1], corner[3 * v + 2]]);
    this.#attribute('weights', unpack(weights, Uint8Array), 4, gl.UNSIGNED_BYTE, true);
    const corners = unpack(indices, Uint32Array);
    this.count = corners.length;
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, corners, gl.STATIC_DRAW);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, 4 * ROW, 2 * this.rows);
    gl.uniform1i(this.places.rows, this.rows);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.SCISSOR_TEST);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  #program() {
    const { gl } = this;
    const program = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program) || 'the shaders do not link');
    return program;
  }

  #attribute(name, values, size, type, normalized) {
    const { gl } = this;
    const place = gl.getAttribLocation(this.program, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(place);
    if (type === gl.UNSIGNED_SHORT) gl.vertexAttribIPointer(place, size, type, 0, 0);
    else gl.vertexAttribPointer(place, size, type, Boolean(normalized), 0, 0);
  }

  /** Calls `take(x, y, z)` for some places on the surface, each as its first bone moves it: enough to know how large the character is. */
  eachPlace({ world }, take) {
    const matrix = new Float32Array(16);
    for (const [bone, x, y, z] of this.sampled) {
      multiply(world, 16 * this.nodes[bone], this.inverseBind, 16 * bone, matrix, 0);
      take(...[0, 1, 2].map((r) => matrix[r] * x + matrix[4 + r] * y + matrix[8 + r] * z + matrix[12 + r]));
    }
  }

  /** Takes the poses, and clears the picture. */
  begin(original, other, { width, height }, tolerance, colours) {
    const { gl, nodes, matrices } = this;
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
    [original, other].forEach(({ world }, pose) => {
      const first = pose * this.rows * ROW * 16;
      for (let b = 0; b < nodes.length; ++b) multiply(world, 16 * nodes[b], this.inverseBind, 16 * b, matrices, first + 16 * b);
    });
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 4 * ROW, 2 * this.rows, gl.RGBA, gl.FLOAT, matrices);
    gl.uniform1f(this.places.tolerance, tolerance);
    for (const name of ['cold', 'warm', 'hot', 'over']) gl.uniform3fv(this.places[name], rgb(colours[name]));
    gl.uniform3fv(this.places.plain, rgb(colours.skin));
    gl.scissor(0, 0, width, height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  /** Draws in a view [x, y, width, height]. `gain` 0 is the original, 1 the other pose, more enlarges the difference. */
  draw(matrix, [x, y, width, height], { gain, coloured, opacity = 1 }) {
    const { gl } = this;
    const bottom = this.canvas.height - y - height;
    gl.viewport(x, bottom, width, height);
    gl.scissor(x, bottom, width, height);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(this.places.view, false, matrix);
    gl.uniform1f(this.places.gain, gain);
    gl.uniform1f(this.places.coloured, coloured ? 1 : 0);
    gl.uniform1f(this.places.opacity, opacity);
    if (opacity < 1) gl.enable(gl.BLEND);
    gl.drawElements(gl.TRIANGLES, this.count, gl.UNSIGNED_INT, 0);
    gl.disable(gl.BLEND);
  }
}

// Column-major 4x4 matrices in typed arrays, and unit quaternions x, y, z, w.

/** The matrix of translation, rotation and scale at local[i ...] (3, 4 and 3 numbers) into out[o ...]. */
export function compose(local, i, out, o) {
  const x = local[i + 3], y = local[i + 4], z = local[i + 5], w = local[i + 6];
  const sx = local[i + 7], sy = local[i + 8], sz = local[i + 9];
  out[o] = (1 - 2 * (y * y + z * z)) * sx;
  out[o + 1] = 2 * (x * y + w * z) * sx;
  out[o + 2] = 2 * (x * z - w * y) * sx;
  out[o + 3] = 0;
  out[o + 4] = 2 * (x * y - w * z) * sy;
  out[o + 5] = (1 - 2 * (x * x + z * z)) * sy;
  out[o + 6] = 2 * (y * z + w * x) * sy;
  out[o + 7] = 0;
  out[o + 8] = 2 * (x * z + w * y) * sz;
  out[o + 9] = 2 * (y * z - w * x) * sz;
  out[o + 10] = (1 - 2 * (x * x + y * y)) * sz;
  out[o + 11] = 0;
  out[o + 12] = local[i];
  out[o + 13] = local[i + 1];
  out[o + 14] = local[i + 2];
  out[o + 15] = 1;
}

/** out[o ...] = a[i ...] * b[k ...]; out may be neither. */
export function multiply(a, i, b, k, out, o) {
  for (let c = 0; c < 16; c += 4) {
    for (let r = 0; r < 4; ++r) {
      out[o + c + r] = a[i + r] * b[k + c] + a[i + 4 + r] * b[k + c + 1] + a[i + 8 + r] * b[k + c + 2] + a[i + 12 + r] * b[k + c + 3];
    }
  }
}

/** The mean of the unit quaternions at p[i ...] and q[k ...] on the short arc, into out[o ...]. */
export function slerp(p, i, q, k, u, out, o) {
  let cosine = p[i] * q[k] + p[i + 1] * q[k + 1] + p[i + 2] * q[k + 2] + p[i + 3] * q[k + 3];
  const sign = cosine < 0 ? -1 : 1;
  cosine = Math.min(1, cosine * sign);
  let a = 1 - u, b = u;
  if (cosine < 1 - 1e-6) {
    const angle = Math.acos(cosine);
    a = Math.sin(a * angle) / Math.sin(angle);
    b = Math.sin(b * angle) / Math.sin(angle);
  }
  let square = 0;
  for (let c = 0; c < 4; ++c) {
    out[o + c] = a * p[i + c] + b * sign * q[k + c];
    square += out[o + c] ** 2;
  }
  const scale = square > 1e-24 ? 1 / Math.sqrt(square) : 0;
  for (let c = 0; c < 4; ++c) out[o + c] *= scale;
  if (scale === 0) out[o + 3] = 1;
}

/** A perspective projection times a view from `eye` to `target`, y upwards. */
export function viewProjection(eye, target, fieldOfView, aspect, near, far) {
  const forward = unit(target.map((v, a) => v - eye[a]));
  const right = unit(cross(forward, [0, 1, 0]));
  const up = cross(right, forward);
  const view = [
    right[0], up[0], -forward[0], 0, right[1], up[1], -forward[1], 0, right[2], up[2], -forward[2], 0,
    -dot(right, eye), -dot(up, eye), dot(forward, eye), 1,
  ];
  const f = 1 / Math.tan(fieldOfView / 2);
  const projection = [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0];
  const out = new Float32Array(16);
  multiply(projection, 0, view, 0, out, 0);
  return out;
}

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export function unit(a) {
  const length = Math.hypot(...a) || 1;
  return a.map((v) => v / length);
}

// Triangles of the pieces of bodies, in each body's frame, and turning by quaternions (w, x, y, z).

const AROUND = 16, LONGEST_EDGE = 0.25, MOST_PARTS = 12;

export function rotate([w, x, y, z], [a, b, c]) {
  const p = 2 * (y * c - z * b), q = 2 * (z * a - x * c), r = 2 * (x * b - y * a);
  return [a + w * p + y * r - z * q, b + w * q + z * p - x * r, c + w * r + x * q - y * p];
}

// A surface of rings about z; `place` gives a point by its angle from the pole and around.
function round(place) {
  const found = [], point = (k, j) => place(Math.PI * k / AROUND, 2 * Math.PI * j / AROUND);
  for (let k = 0; k < AROUND; k++) {
    for (let j = 0; j < AROUND; j++) {
      if (k > 0) found.push([point(k, j), point(k + 1, j), point(k, j + 1)]);
      if (k < AROUND - 1) found.push([point(k, j + 1), point(k + 1, j), point(k + 1, j + 1)]);
    }
  }
  return found;
}

// Faces in parts, so that the canvas can sort them by their distance.
function box(size) {
  const found = [], parts = size.map((edge) => Math.min(MOST_PARTS, Math.ceil(edge / LONGEST_EDGE)));
  for (let axis = 0; axis < 3; axis++) {
    const u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const side of [-0.5, 0.5]) {
      for (let i = 0; i < parts[u]; i++) {
        for (let j = 0; j < parts[v]; j++) {
          const corner = (a, b) => {
            const point = [0, 0, 0];
            point[axis] = side * size[axis];
            point[u] = ((i + a) / parts[u] - 0.5) * size[u];
            point[v] = ((j + b) / parts[v] - 0.5) * size[v];
            return point;
          };
          found.push([corner(0, 0), corner(1, 0), corner(1, 1)], [corner(0, 0), corner(1, 1), corner(0, 1)]);
        }
      }
    }
  }
  return found;
}

const ball = (radii, half = 0) => round((down, around) => [
  radii[0] * Math.sin(down) * Math.cos(around), radii[1] * Math.sin(down) * Math.sin(around),
  radii[2] * Math.cos(down) + (down < Math.PI / 2 ? half : -half),
]);

const KINDS = {
  sphere: ({ radius }) => ball([radius, radius, radius]),
  ellipsoid: ({ radii }) => ball(radii),
  capsule: ({ radius, length }) => ball([radius, radius, radius], length / 2),
  box: ({ size }) => box(size),
  hull: ({ vertices, triangles }) => triangles.map((corners) => corners.map((k) => vertices[k])),
};

const less = (a, b) => a.map((value, k) => value - b[k]);
const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];
export const normal = ([a, b, c]) => cross(less(b, a), less(c, a));

// All triangles of a body, each with its normal out of its piece, which is convex.
export function triangles(body) {
  return body.pieces.flatMap((piece) => {
    const faces = KINDS[piece.shape](piece), corners = faces.flat();
    const centre = [0, 1, 2].map((k) => corners.reduce((sum, corner) => sum + corner[k], 0) / corners.length);
    return faces.map((face) => {
      const out = normal(face), towards = less(face[0], centre);
      const turned = out[0] * towards[0] + out[1] * towards[1] + out[2] * towards[2] < 0 ? [face[0], face[2], face[1]] : face;
      return turned.map((corner) => rotate(piece.orientation, corner).map((value, k) => value + piece.position[k]));
    });
  });
}

// Two ways to draw the same triangles: with three.js where the address names a copy of it, else on a plain canvas, farthest first.

import { normal, rotate, triangles } from "./shapes.js";

const COLOURS = { fixed: [150, 156, 166], simulated: [214, 150, 60], driven: [79, 127, 181] };
const OPENING = 0.9; // [rad] of the view, from its upper edge to its lower one
const LIGHT = [0.36, 0.48, 0.8];

// Where the eye is: about `target`, turned by `yaw` and `pitch`.
export const eye = { target: [0, 0, 0], yaw: -0.9, pitch: 0.45, distance: 2 };

export function place() {
  const flat = Math.cos(eye.pitch) * eye.distance;
  return [
    eye.target[0] + flat * Math.cos(eye.yaw), eye.target[1] + flat * Math.sin(eye.yaw), eye.target[2] + Math.sin(eye.pitch) * eye.distance,
  ];
}

export function onCanvas(canvas, bodies) {
  const pen = canvas.getContext("2d"), all = bodies.map(triangles);
  return ({ positions, orientations }) => {
    const at = place(), focus = 0.5 * canvas.height / Math.tan(0.5 * OPENING), faces = [];
    const right = [-Math.sin(eye.yaw), Math.cos(eye.yaw), 0], back = at.map((value, k) => (value - eye.target[k]) / eye.distance);
    const up = [back[1] * right[2] - back[2] * right[1], back[2] * right[0] - back[0] * right[2], back[0] * right[1] - back[1] * right[0]];
    const along = (axis, v) => axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2];
    bodies.forEach((body, n) => {
      for (const face of all[n]) {
        const corners = face.map((corner) => rotate(orientations[n], corner).map((value, k) => value + positions[n][k]));
        const seen = corners.map((corner) => corner.map((value, k) => value - at[k])), out = normal(corners);
        if (along(out, seen[0]) >= 0 || seen.some((v) => along(back, v) > -0.01)) continue;
        const shade = 0.55 + 0.45 * Math.max(0, along(out, LIGHT)) / Math.hypot(...out);
        const flat = seen.map((v) => [
          canvas.width / 2 - focus * along(right, v) / along(back, v), canvas.height / 2 + focus * along(up, v) / along(back, v),
        ]);
        faces.push({ far: -seen.reduce((sum, v) => sum + along(back, v), 0), flat, colour: COLOURS[body.role].map((c) => Math.round(c * shade)) });
      }
    });
    pen.clearRect(0, 0, canvas.width, canvas.height);
    for (const { flat, colour } of faces.sort((a, b) => b.far - a.far)) {
      pen.fillStyle = pen.strokeStyle = `rgb(${colour})`;
      pen.beginPath();
      flat.forEach(([x, y], k) => (k ? pen.lineTo(x, y) : pen.moveTo(x, y)));
      pen.closePath();
      pen.fill();
      pen.stroke();
    }
  };
}

export function inThree(THREE, canvas, bodies) {
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true }), scene = new THREE.Scene();
  // lights are in physical units since revision 155
  const full = Number(THREE.REVISION) < 155 ? 1 : Math.PI, sun = new THREE.DirectionalLight(0xffffff, 0.45 * full);
  const camera = new THREE.PerspectiveCamera(OPENING * 180 / Math.PI, 1, 0.01, 1000);
  camera.up.set(0, 0, 1);
  sun.position.set(...LIGHT);
  scene.add(sun, new THREE.AmbientLight(0xffffff, 0.55 * full));
  const meshes = bodies.map((body) => {
    const shape = new THREE.BufferGeometry();
    shape.setAttribute("position", new THREE.Float32BufferAttribute(triangles(body).flat(2), 3));
    shape.computeVertexNormals();
    const mesh = new THREE.Mesh(shape, new THREE.MeshLambertMaterial({ color: `rgb(${COLOURS[body.role]})` }));
    scene.add(mesh);
    return mesh;
  });
  return ({ positions, orientations }) => {
    meshes.forEach((mesh, n) => {
      const [w, x, y, z] = orientations[n];
      mesh.position.set(...positions[n]);
      mesh.quaternion.set(x, y, z, w);
    });
    renderer.setSize(canvas.width, canvas.height, false);
    camera.aspect = canvas.width / canvas.height;
    camera.updateProjectionMatrix();
    camera.position.set(...place());
    camera.lookAt(...eye.target);
    renderer.render(scene, camera);
  };
}

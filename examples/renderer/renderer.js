// Draws what avatarsim shows: poses come over a WebSocket, newest first, and are drawn at the browser's own rate.
//
// The address says which port, and, if you have one, which copy of three.js beside this file:
//   index.html?ws=127.0.0.1:9871&three=three.module.js

import { eye, inThree, onCanvas } from "./views.js";

const asked = new URLSearchParams(location.search), canvas = document.getElementById("view");
const say = (words) => { document.getElementById("said").textContent = words; };
let draw = null, newest = null, drawn = null;

async function begin(scene) {
  const named = asked.get("three");
  draw = named ? inThree(await import(new URL(named, location.href)), canvas, scene.bodies) : onCanvas(canvas, scene.bodies);
  document.body.dataset.view = named ? "three" : "canvas";
  say(scene.scene);
}

function look(scene, poses) {
  const driven = poses.positions.filter((_, k) => scene.bodies[k].role === "driven");
  const centre = [0, 1, 2].map((k) => driven.reduce((sum, place) => sum + place[k], 0) / driven.length);
  eye.target = driven.length ? centre : [0, 0, 0];
  eye.distance = 1 + 2 * Math.max(0, ...driven.map((place) => Math.hypot(...place.map((value, k) => value - centre[k]))));
}

let scene = null;
const socket = new WebSocket(`ws://${asked.get("ws") ?? "127.0.0.1:9871"}/poses`);
socket.onmessage = ({ data }) => {
  const message = JSON.parse(data);
  if (message.bodies) {
    scene = message;
    begin(scene).catch((error) => say(`three.js was not loaded: ${error.message}`));
  } else {
    if (newest === null) look(scene, message);
    newest = message;
  }
};
socket.onclose = () => say("Not connected: is avatarsim live running with --ws, and is this its port?");

canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
canvas.addEventListener("pointermove", (event) => {
  if (!event.buttons) return;
  eye.yaw -= 0.008 * event.movementX;
  eye.pitch = Math.max(-1.5, Math.min(1.5, eye.pitch + 0.008 * event.movementY));
  drawn = null;
});
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  eye.distance *= Math.exp(0.001 * event.deltaY);
  drawn = null;
}, { passive: false });

requestAnimationFrame(function each() {
  requestAnimationFrame(each);
  const width = Math.round(canvas.clientWidth * devicePixelRatio), height = Math.round(canvas.clientHeight * devicePixelRatio);
  if (canvas.width !== width || canvas.height !== height) {
    [canvas.width, canvas.height, drawn] = [width, height, null];
  }
  if (draw === null || newest === null || drawn === newest) return;
  drawn = newest;
  draw(newest);
  say(`${scene.scene}: frame ${newest.frame}, ${newest.time.toFixed(2)} s`);
  document.body.dataset.frame = newest.frame;
});

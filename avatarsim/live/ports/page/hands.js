// The page of tracked hands: reads hands in an immersive WebXR session, and sends goals of links to the server that it came from.

import { Alignment, JOINTS, SIDES, fromXr, guess, message } from "/hand_joints.js";

// bytes that may wait to be sent: a sample that is late is worth nothing
const MOST_WAITING = 65536;

const at = (name) => document.getElementById(name);
const say = (name, words) => { if (at(name).textContent !== words) at(name).textContent = words; };
const shown = {};
let bodies = [], alignment = null, session = null, tracker = null, mode = "";

function opened(path, listener) {
  const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}${path}`);
  socket.onmessage = (event) => listener(JSON.parse(event.data));
  socket.onclose = () => say("server", "The server is gone, or takes no more connections. Reload this page once it runs.");
  return socket;
}

function select(link, links, label) {
  const choice = document.createElement("select");
  choice.setAttribute("aria-label", label);
  for (const name of ["", ...links]) choice.add(new Option(name || "none", name, false, name === link));
  return choice;
}

function propose(links) {
  const leads = guess(links);
  at("joints").replaceChildren(...JOINTS.map((joint) => {
    const row = document.createElement("tr"), name = document.createElement("td");
    name.textContent = joint.replaceAll("-", " ");
    row.append(name, ...SIDES.map((side) => {
      const cell = document.createElement("td"), choice = select(leads[side][joint], links, `${side} ${joint}`);
      choice.dataset.side = side;
      choice.dataset.joint = joint;
      cell.append(choice);
      return cell;
    }));
    return row;
  }));
}

function leading() {
  const leads = { left: {}, right: {} };
  for (const choice of at("joints").querySelectorAll("select")) leads[choice.dataset.side][choice.dataset.joint] = choice.value;
  return leads;
}

function align() {
  alignment = new Alignment(Number(at("yaw").value) * Math.PI / 180);
}

function seenIn(frame, space) {
  const seen = {};
  for (const source of session.inputSources) {
    if (!source.hand) continue;
    const hand = seen[source.handedness] = {};
    for (const joint of JOINTS) {
      const pose = frame.getJointPose(source.hand.get(joint), space);
      if (pose) hand[joint] = fromXr(pose.transform.position, pose.transform.orientation);
    }
  }
  return seen;
}

function send(text) {
  if (tracker.readyState === WebSocket.OPEN && tracker.bufferedAmount < MOST_WAITING) tracker.send(JSON.stringify(text));
}

async function start() {
  try {
    session = await navigator.xr.requestSession(mode, { requiredFeatures: ["local-floor", "hand-tracking"] });
    const gl = document.createElement("canvas").getContext("webgl", { xrCompatible: true });
    if (gl === null) throw new Error("this browser draws no WebGL");
    await gl.makeXRCompatible();
    session.updateRenderState({ baseLayer: new XRWebGLLayer(session, gl) });
    const space = await session.requestReferenceSpace("local-floor");
    session.addEventListener("end", ended);
    align();
    at("start").disabled = true;
    at("align").disabled = false;
    session.requestAnimationFrame(function each(_, frame) {
      if (session === null) return;
      session.requestAnimationFrame(each);
      const seen = seenIn(frame, space);
      send(message(seen, leading(), shown, alignment, at("turn").checked));
      say("said", Object.keys(seen).length ? "Hands are sent." : "No hand is seen.");
    });
  } catch (error) {
    say("said", `The browser refused: ${error.message}`);
    const begun = session;
    session = null;
    begun?.end().catch(() => {});
  }
}

function ended() {
  session = null;
  // a message of goals lets go all links that it does not name
  send({ links: {} });
  at("start").disabled = false;
  at("align").disabled = true;
  say("said", "The session has ended; the avatar is let go.");
}

async function ask() {
  if (!window.isSecureContext) return "This page is not at localhost and not encrypted, so browsers keep WebXR from it.";
  if (!navigator.xr) return "This browser has no WebXR. Open this page in the browser of a headset that tracks hands.";
  for (const kind of ["immersive-ar", "immersive-vr"]) {
    if (await navigator.xr.isSessionSupported(kind).catch(() => false)) mode ||= kind;
  }
  if (!mode) return "This browser has WebXR, but no headset that it can show an immersive session on.";
  at("start").disabled = false;
  return "WebXR is there. Whether hands are tracked shows when the session starts.";
}

tracker = opened("/tracker", (told) => {
  if (told.refused) say("said", `The server refused: ${told.refused}`);
});
opened("/poses", (told) => {
  if (told.bodies) {
    bodies = told.bodies.map((body) => body.name);
    propose(told.links);
    say("server", `Connected to the scene ${told.scene}, links: ${told.links.length}.`);
    return;
  }
  bodies.forEach((name, k) => { shown[name] = { position: told.positions[k], orientation: told.orientations[k] }; });
});
at("start").addEventListener("click", start);
at("align").addEventListener("click", align);
ask().then((words) => say("browser", words), (error) => say("browser", `WebXR cannot be asked: ${error.message}`));

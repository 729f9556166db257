// Plays a scene again: one canvas, one view per engine, one timeline. Draws what was recorded, never between two states.
function startReplay(data) {
  const root = document.getElementById("replay");
  const stage = root.querySelector(".stage");
  const say = (name) => root.querySelector(`[data-part="${name}"]`);
  const bytes = (text) => Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0)).buffer;

  // what all views share
  const geometries = data.meshes.map((mesh) => {
    const made = new THREE.BufferGeometry();
    made.setAttribute("position", new THREE.BufferAttribute(new Float32Array(bytes(mesh.corners)), 3));
    made.setIndex(new THREE.BufferAttribute(new Uint32Array(bytes(mesh.faces)), 1));
    made.computeVertexNormals();
    made.computeBoundingBox();
    return made;
  });
  const solid = (colour) => new THREE.MeshLambertMaterial({ color: colour });
  const thin = (colour, opacity) =>
    new THREE.MeshLambertMaterial({ color: colour, transparent: true, opacity, depthWrite: false, side: THREE.DoubleSide });
  const ink = {
    driven: solid(0x7b9cc4), simulated: solid(0xd9a33c), fixed: thin(0x8b95a5, 0.22), ghost: thin(0x9b59d0, 0.26),
    bad: solid(0xe02020), edge: new THREE.LineBasicMaterial({ color: 0x8b95a5, transparent: true, opacity: 0.55 }),
    outline: new THREE.LineBasicMaterial({ color: 0x5b6b80 }),
    dark: new THREE.LineBasicMaterial({ color: 0x4a3a12, transparent: true, opacity: 0.7 }),
    ring: new THREE.MeshBasicMaterial({ color: 0xe02020, depthTest: false, transparent: true, opacity: 0.85 }),
  };
  const edges = [], edgesOf = (k) => edges[k] ||= new THREE.EdgesGeometry(geometries[k], 25);
  // a plate seen from its edge is all but invisible: its outline is not
  const THIN = 0.03;
  const isThin = (k) => {
    const size = geometries[k].boundingBox.getSize(new THREE.Vector3()).toArray();
    return Math.min(...size) < THIN * Math.max(...size);
  };
  const ringShape = new THREE.TorusGeometry(1, 0.12, 8, 32);

  // poses, unpacked once
  const poses = (packed, bodies) => ({
    frames: packed.frames, count: bodies.length, bodies,
    places: new Uint16Array(bytes(packed.places)), turns: new Int16Array(bytes(packed.turns)),
  });
  const span = data.high.map((high, k) => (high - data.low[k]) / 65534);
  const put = (mesh, from, frame, slot) => {
    const row = Math.min(frame, from.frames - 1) * from.count + slot, at = 3 * row, turn = 4 * row;
    const place = [...from.places.subarray(at, at + 3)], [w, ...xyz] = from.turns.subarray(turn, turn + 4);
    mesh.visible = place.every((code) => code > 0);
    mesh.position.set(...place.map((code, k) => data.low[k] + (code - 1) * span[k]));
    mesh.quaternion.set(...xyz, w).normalize();
  };
  const ghost = data.ghost && poses(data.ghost, data.links);

  const views = data.runs.map((run, number) => {
    const world = new THREE.Scene();
    world.add(new THREE.HemisphereLight(0xffffff, 0x8a8f99, 0.75));
    const lamp = new THREE.DirectionalLight(0xffffff, 0.55);
    world.add(lamp, lamp.target);
    const meshes = data.bodies.map((body) => new THREE.Mesh(geometries[body.mesh], ink[body.role]));
    world.add(...meshes);
    // boxes in a stack are told apart by their edges; round bodies have none
    data.moving.forEach((k) => {
      const sharp = data.bodies[k].role === "simulated" && edgesOf(data.bodies[k].mesh);
      if (sharp && sharp.attributes.position.count) meshes[k].add(new THREE.LineSegments(sharp, ink.dark));
    });
    for (const still of data.still) {
      const mesh = meshes[still.body], shape = data.bodies[still.body].mesh;
      mesh.position.set(...still.place);
      mesh.quaternion.set(...still.turn.slice(1), still.turn[0]);
      mesh.add(new THREE.LineSegments(edgesOf(shape), isThin(shape) ? ink.outline : ink.edge));
    }
    const above = (mesh, order) => { mesh.renderOrder = order; world.add(mesh); return mesh; };
    const ghosts = ghost ? data.links.map((k) => above(new THREE.Mesh(geometries[data.bodies[k].mesh], ink.ghost), 2)) : [];
    const rings = [0, 1, 2].map(() => above(new THREE.Mesh(ringShape, ink.ring), 3));
    const cell = stage.querySelectorAll(".view")[number];
    return { run, world, lamp, meshes, ghosts, rings, moves: poses(run, data.moving), cell, picture: cell.querySelector(".picture"),
      said: cell.querySelector(".said"), remarks: new Map(run.remarks) };
  });
  const last = Math.max(...views.map((view) => view.moves.frames)) - 1;

  // where two bodies overlap, nearly: the middle of what their boxes share
  const boxOf = (mesh) => { mesh.updateMatrixWorld(); return mesh.geometry.boundingBox.clone().applyMatrix4(mesh.matrixWorld); };
  function mark(view, frame) {
    view.meshes.forEach((mesh, k) => { mesh.material = ink[data.bodies[k].role]; });
    // of a run that has ended there are none
    const pairs = view.run.pairs[frame] || [];
    view.rings.forEach((ring, k) => {
      const pair = pairs[k];
      ring.visible = Boolean(pair);
      if (!pair) return;
      const shared = boxOf(view.meshes[pair[0]]).intersect(boxOf(view.meshes[pair[1]]));
      ring.visible = !shared.isEmpty();
      if (!ring.visible) return;
      shared.getCenter(ring.position);
      ring.scale.setScalar(Math.max(0.035 * eye.distance, 0.4 * Math.min(shared.getSize(new THREE.Vector3()).length(), 0.2 * eye.distance)));
    });
    // fixed bodies keep their colour: a whole floor in red would hide where it happens
    for (const k of pairs.flatMap((pair) => pair.slice(0, 2))) {
      if (data.bodies[k].role !== "fixed") view.meshes[k].material = ink.bad;
    }
  }
  function caption(view, frame) {
    const deepest = view.run.pairs[frame]?.[0], broken = view.run.broken.includes(frame);
    const [one, other] = !deepest ? [] : data.bodies[deepest[0]].role === "fixed" ? [deepest[1], deepest[0]] : deepest;
    const remark = broken ? undefined : view.remarks.get(frame);
    view.cell.classList.toggle("overlaps", Boolean(deepest) || broken);
    view.cell.classList.toggle("moves", Boolean(remark) && !deepest);
    view.said.textContent = frame >= view.moves.frames ? "ended here" : broken ? "a pose here is no number"
      : !deepest ? (remark ? `no overlap; ${remark}` : "no overlap")
      : `${deepest[2]}: ${data.bodies[one].name} in ${data.bodies[other].name}`;
  }

  // one eye for all views
  const home = { azimuth: data.azimuth, height: 0.4, distance: 2.7 * data.radius, focus: new THREE.Vector3(...data.focus) };
  const follow = say("follow");
  const start = () => ({ ...home, distance: follow.checked ? 2.6 * data.near : home.distance, focus: home.focus.clone() });
  const eye = start();
  // the middle of what is followed, in our engine's view, so that all views look at the same place
  const leader = views[data.leader];
  // with the user's, which may be elsewhere
  function places() {
    const found = [];
    data.moving.forEach((k, slot) => {
      if (!data.followed.includes(k)) return;
      put(leader.meshes[k], leader.moves, frame, slot);
      if (leader.meshes[k].visible) found.push(leader.meshes[k].position);
    });
    leader.ghosts.forEach((mesh, slot) => { put(mesh, ghost, frame, slot); if (mesh.visible) found.push(mesh.position); });
    return found;
  }
  function followed() {
    const found = places(), middle = new THREE.Vector3();
    found.forEach((place) => middle.add(place));
    return found.length ? middle.divideScalar(found.length) : home.focus.clone();
  }
  // near enough to see all of avatar and user, and no nearer: for a moment that a reader is led to
  function fit() {
    if (!ghost) return;
    const middle = followed(), reach = Math.max(...data.reach);
    const needed = Math.max(...places().map((place) => place.distanceTo(middle) + reach), data.least);
    const wanted = 2.6 * needed;
    if (follow.checked) eye.distance = wanted;
    else if (wanted < home.distance) { eye.distance = wanted; eye.focus.copy(middle); }
  }
  const camera = new THREE.PerspectiveCamera(38, 1, 0.02 * data.radius, 60 * data.radius);
  camera.up.set(0, 0, 1);
  function look() {
    eye.height = Math.max(-1.5, Math.min(1.5, eye.height));
    const flat = Math.cos(eye.height) * eye.distance;
    camera.position.set(Math.cos(eye.azimuth) * flat, Math.sin(eye.azimuth) * flat, Math.sin(eye.height) * eye.distance).add(eye.focus);
    camera.lookAt(eye.focus);
    // in a large scene what the eye is near to must not lie before the near plane
    camera.near = Math.min(0.02 * data.radius, 0.1 * eye.distance);
  }

  let renderer;
  const canvas = stage.querySelector("canvas");
  try {
    renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
  } catch (error) {
    say("trouble").hidden = false;
    root.dataset.state = "no-webgl";
    return;
  }
  renderer.setScissorTest(true);
  const lead = home.focus.clone();
  let frame = 0, playing = false, speed = 1, clock = 0, poster = true;
  function draw(whole = false) {
    // words first: they may change how high a view is, and so where the next one is
    views.forEach((view) => caption(view, frame));
    const all = stage.getBoundingClientRect();
    const wide = Math.round(all.width), high = Math.round(all.height);
    const size = renderer.getSize(new THREE.Vector2());
    if (size.x !== wide || size.y !== high) {
      renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
      renderer.setSize(wide, high, false);
    }
    if (follow.checked) { const at = followed(); eye.focus.add(at).sub(lead); lead.copy(at); }
    look();
    for (const view of views) {
      if (view.cell.hidden) continue;
      const cell = view.picture.getBoundingClientRect();
      if (!whole && (cell.bottom < 0 || cell.top > window.innerHeight)) continue;
      data.moving.forEach((k, slot) => put(view.meshes[k], view.moves, frame, slot));
      view.ghosts.forEach((mesh, slot) => put(mesh, ghost, frame, slot));
      mark(view, frame);
      view.rings.forEach((ring) => ring.quaternion.copy(camera.quaternion));
      view.lamp.position.copy(camera.position);
      view.lamp.target.position.copy(eye.focus);
      const left = cell.left - all.left, bottom = all.bottom - cell.bottom;
      renderer.setViewport(left, bottom, cell.width, cell.height);
      renderer.setScissor(left, bottom, cell.width, cell.height);
      camera.aspect = cell.width / cell.height;
      camera.updateProjectionMatrix();
      renderer.render(view.world, camera);
    }
    root.dataset.frame = frame;
  }

  let asked = 0;
  const redraw = () => { asked ||= requestAnimationFrame(() => { asked = 0; draw(); }); };
  const bar = say("bar"), time = say("time"), button = say("play");
  function show(wanted) {
    frame = Math.max(0, Math.min(last, Math.round(wanted)));
    bar.value = frame;
    const seconds = (frame * data.dt).toFixed(2);
    bar.setAttribute("aria-valuetext", `${seconds} seconds`);
    time.textContent = `${seconds} s`;
    document.dispatchEvent(new CustomEvent("shown-time", { detail: { time: frame * data.dt, length: data.dt } }));
    redraw();
  }
  function play(on) {
    playing = on;
    if (playing && poster) reset();
    if (playing && (frame >= last || poster)) show(0);
    poster = false;
    button.textContent = playing ? "Pause" : "Play";
    root.dataset.state = playing ? "playing" : "paused";
    clock = performance.now();
    if (playing) requestAnimationFrame(tick);
  }
  let rest = 0;
  function tick(now) {
    if (!playing) return;
    rest += ((now - clock) / 1000) * speed / data.dt;
    clock = now;
    const steps = Math.floor(rest);
    rest -= steps;
    if (steps) show(frame + steps);
    if (frame >= last) { play(false); return; }
    requestAnimationFrame(tick);
  }

  bar.max = last;
  bar.addEventListener("input", () => { poster = false; show(Number(bar.value)); });
  button.addEventListener("click", () => play(!playing));
  const speeds = say("speed");
  speeds.addEventListener("change", () => { speed = Number(speeds.value); });
  if (last * data.dt < 1.6) { speeds.value = "0.25"; speed = 0.25; }
  const reset = () => { Object.assign(eye, start()); lead.copy(home.focus); redraw(); };
  say("home").addEventListener("click", reset);
  follow.addEventListener("change", reset);
  root.querySelectorAll("[data-view]").forEach((box) => box.addEventListener("change", () => {
    views[Number(box.dataset.view)].cell.hidden = !box.checked;
    redraw();
  }));
  const ghostBox = say("ghost");
  if (ghostBox) ghostBox.addEventListener("change", () => { ink.ghost.visible = ghostBox.checked; redraw(); });
  document.addEventListener("seek-time", (event) => show(event.detail / data.dt));
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const tag = event.target.tagName;
    if (tag === "SELECT" || (tag === "INPUT" && event.target !== bar) || (tag === "BUTTON" && event.key === " ") || tag === "SUMMARY") return;
    const far = event.shiftKey ? 10 : 1;
    const turn = (part, change) => () => { eye[part] += change; redraw(); }, zoom = (factor) => () => { eye.distance *= factor; redraw(); };
    const acts = {
      " ": () => play(!playing), ArrowRight: () => show(frame + far), ArrowLeft: () => show(frame - far),
      Home: () => show(0), End: () => show(last), r: reset, f: () => follow.click(),
      a: turn("azimuth", -0.1), d: turn("azimuth", 0.1), w: turn("height", 0.08), s: turn("height", -0.08), "+": zoom(1 / 1.12), "-": zoom(1.12),
    };
    const act = acts[event.key];
    if (act) { event.preventDefault(); act(); }
  });

  // a link to a moment, the worst moment of each engine, and a moving picture to keep
  const told = say("told");
  const link = (state) => `t=${Number((state * data.dt).toPrecision(6))}`;
  // a drawn state stands for those until the next; the share makes up for digits that an address leaves out
  const ROUNDED = 0.05;
  function seek() {
    const wanted = /^#(?:.*&)?t=([^&]+)/.exec(location.hash), seconds = wanted ? Number(wanted[1]) : NaN;
    if (!Number.isFinite(seconds)) return false;
    if (playing) play(false);
    poster = false;
    show(Math.floor(seconds / data.dt + ROUNDED));
    fit();
    return true;
  }
  window.addEventListener("hashchange", seek);
  say("link").addEventListener("click", () => {
    location.hash = link(frame);
    told.textContent = "The address bar links to this moment.";
    if (!navigator.clipboard) return;
    navigator.clipboard.writeText(location.href).then(() => { told.textContent = "A link to this moment is copied."; }, () => {});
  });
  root.querySelectorAll("[data-worst]").forEach((one) => one.addEventListener("click", () => {
    // no navigation, which would end the scrolling below
    history.replaceState(null, "", `#${link(Number(one.dataset.worst))}`);
    seek();
    const cell = views[Number(one.dataset.of)].cell;
    (cell.hidden ? stage : cell).scrollIntoView({ block: "nearest" });
  }));

  // of what is shown above, at the chosen speed; nothing leaves the page but the file that is saved
  const film = say("film"), filmed = film.textContent;
  const WIDEST = 720, MOST_PICTURES = 200, LEAST_DELAY = 0.04, SAMPLES = 12, MOST_LINES = 3;
  let filming = false;
  // words of a caption in few lines that fit; a word that is wider than a line is squeezed
  function wrapped(pen, text, wide) {
    const lines = [""];
    for (const word of text.split(" ")) {
      const longer = `${lines.at(-1)} ${word}`.trim();
      if (pen.measureText(longer).width > wide) lines.push(word); else lines[lines.length - 1] = longer;
    }
    return lines.filter(Boolean).slice(0, MOST_LINES);
  }
  function shot(pen, ratio) {
    draw(true);
    const all = stage.getBoundingClientRect(), style = getComputedStyle(document.body);
    pen.fillStyle = style.backgroundColor;
    pen.fillRect(0, 0, pen.canvas.width, pen.canvas.height);
    pen.drawImage(canvas, 0, 0, pen.canvas.width, pen.canvas.height);
    const size = Math.max(10, Math.round(12.5 * ratio));
    pen.font = `${size}px sans-serif`;
    pen.textBaseline = "top";
    const place = (part) => {
      const box = part.getBoundingClientRect();
      return [box.left - all.left, box.top - all.top, box.width, box.height].map((length) => length * ratio);
    };
    for (const view of views) {
      if (view.cell.hidden) continue;
      const [x, y, wide, tall] = place(view.cell), [, top, , deep] = place(view.said);
      pen.strokeStyle = getComputedStyle(view.cell).borderTopColor;
      pen.strokeRect(x + 0.5, y + 0.5, wide - 1, tall - 1);
      if (view.cell.classList.contains("overlaps")) pen.strokeRect(x + 1.5, y + 1.5, wide - 3, tall - 3);
      pen.fillStyle = style.color;
      pen.fillText(view.cell.querySelector(".called").textContent.trim(), x + 7, y + 6);
      pen.fillStyle = getComputedStyle(view.said).color;
      const lines = wrapped(pen, view.said.textContent, wide - 14), high = 1.3 * size;
      // below the picture where the page has them there, else at its lower edge
      const begins = getComputedStyle(view.said).position === "static" ? top : top + deep - high * lines.length;
      lines.forEach((line, k) => pen.fillText(line, x + 7, begins + k * high, wide - 14));
    }
    return pen.getImageData(0, 0, pen.canvas.width, pen.canvas.height).data;
  }
  async function record() {
    play(false);
    filming = true;
    const [begun, all] = [frame, stage.getBoundingClientRect()], ratio = Math.min(1, WIDEST / all.width);
    const still = data.dt / speed, step = Math.max(1, Math.ceil(LEAST_DELAY / still), Math.ceil((last + 1) / MOST_PICTURES));
    const states = Array.from({ length: Math.floor(last / step) + 1 }, (_, k) => k * step);
    const sheet = document.createElement("canvas");
    sheet.width = Math.round(all.width * ratio);
    sheet.height = Math.round(all.height * ratio);
    const pen = sheet.getContext("2d", { willReadFrequently: true });
    const gif = animatedGif(sheet.width, sheet.height);
    const at = (state) => { show(state); return shot(pen, ratio); };
    const samples = views.flatMap((view) => view.run.worst.map((moment) => moment.state))
      .concat(Array.from({ length: SAMPLES }, (_, k) => Math.round((k * last) / SAMPLES)));
    gif.choose(samples.map(at));
    for (const [k, state] of states.entries()) {
      film.textContent = `Stop: picture ${k + 1} of ${states.length}`;
      gif.add(at(state), Math.max(2, Math.round(100 * step * still)));
      await new Promise((done) => setTimeout(done));
      if (!filming) break;
    }
    if (filming) {
      const made = new Blob([gif.bytes()], { type: "image/gif" }), anchor = document.createElement("a");
      anchor.href = URL.createObjectURL(made);
      anchor.download = `${root.dataset.scene}.gif`;
      anchor.click();
      setTimeout(() => URL.revokeObjectURL(anchor.href), 10000);
      told.textContent = `Saved ${anchor.download}: ${states.length} pictures, ${(made.size / 1e6).toFixed(1)} MB.`;
      root.dataset.filmed = made.size;
    } else { told.textContent = "Stopped; nothing was saved."; }
    filming = false;
    film.textContent = filmed;
    show(begun);
  }
  film.addEventListener("click", () => { if (filming) filming = false; else record(); });

  // drag turns, with the right button or shift it moves; the wheel brings nearer only where the canvas has been touched
  let held = null;
  stage.addEventListener("pointerdown", (event) => { held = [event.clientX, event.clientY]; stage.setPointerCapture(event.pointerId); stage.focus({ preventScroll: true }); });
  for (const end of ["pointerup", "pointercancel"]) stage.addEventListener(end, () => { held = null; });
  stage.addEventListener("pointermove", (event) => {
    if (!held) return;
    const [x, y] = [event.clientX - held[0], event.clientY - held[1]];
    held = [event.clientX, event.clientY];
    if (event.shiftKey || event.buttons === 2) {
      const unit = eye.distance / 500;
      const side = new THREE.Vector3().setFromMatrixColumn(camera.matrix, 0), up = new THREE.Vector3().setFromMatrixColumn(camera.matrix, 1);
      eye.focus.addScaledVector(side, -x * unit).addScaledVector(up, y * unit);
    } else { eye.azimuth -= 0.008 * x; eye.height += 0.008 * y; }
    redraw();
  });
  stage.addEventListener("contextmenu", (event) => event.preventDefault());
  stage.addEventListener("wheel", (event) => {
    if (document.activeElement !== stage) return;
    event.preventDefault();
    eye.distance *= Math.exp(0.0012 * event.deltaY);
    redraw();
  }, { passive: false });
  for (const change of ["resize", "scroll"]) window.addEventListener(change, redraw, { passive: true });
  root.dataset.state = "paused";
  // open on the moment that the address names, else where ours looks worst, else on the deepest overlap of the others
  if (!seek()) {
    show((data.opens.ours ?? data.opens.others ?? { state: 0 }).state);
    fit();
  }
}

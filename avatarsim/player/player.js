// Plays recorded motion: one canvas, a view per run, one timeline. Draws the stored states, never between two of them.
function startPlayer(root, data) {
  const bytes = (text) => Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0)).buffer;
  // a coordinate in a box, as a code from 1 to 65535
  const placed = (box, code, k) => box.low[k] + (code - 1) * (box.high[k] - box.low[k]) / 65534;
  const make = (tag, about = {}, ...inside) => {
    const made = Object.assign(document.createElement(tag), about);
    made.append(...inside);
    return made;
  };
  const single = data.views.length === 1;

  // ---------------------------------------------------------------- the parts of the page
  const option = (value, name) => `<option value="${value}"${value === 1 ? " selected" : ""}>${name}×</option>`;
  const speedNames = [[0.0625, "1/16"], [0.125, "1/8"], [0.25, "1/4"], [0.5, "1/2"], [1, "1"], [2, "2"]];
  root.innerHTML = `
    <div class="stage${single ? " single" : ""}" tabindex="0" role="group" aria-label="Views"><canvas aria-hidden="true"></canvas></div>
    <div class="controls">
      <button type="button" data-part="play">Play</button><input type="range" data-part="bar" min="0" value="0" aria-label="Time">
      <span class="time" data-part="time"></span>
      <label>speed <select data-part="speed">${speedNames.map((one) => option(...one)).join("")}</select></label>
    </div>
    <div class="controls more" data-part="more">
      <label><input type="checkbox" data-part="follow"> follow</label>
      <button type="button" data-part="home">Reset view</button><button type="button" data-part="link">Link to this moment</button>
      <button type="button" data-part="film">Save as GIF</button>
      <fieldset class="shown" data-part="shown" aria-label="Shown"></fieldset>
      <span class="told" data-part="told" role="status"></span>
    </div>
    <div class="moments" data-part="moments" role="group" aria-label="Moments"></div>
    <p class="keys"><kbd>space</kbd> play, <kbd>←</kbd> <kbd>→</kbd> a state, <kbd>home</kbd> <kbd>end</kbd>, drag or <kbd>w</kbd>
      <kbd>a</kbd> <kbd>s</kbd> <kbd>d</kbd> turn, <kbd>+</kbd> <kbd>−</kbd> zoom, <kbd>f</kbd> follow, <kbd>r</kbd> reset.</p>`;
  const part = (name) => root.querySelector(`[data-part="${name}"]`);
  const stage = root.querySelector(".stage"), canvas = stage.querySelector("canvas");
  const fail = (state, words) => {
    root.replaceChildren(make("p", { className: "bad" }, words));
    root.dataset.state = state;
  };
  if (typeof THREE === "undefined") {
    fail("no-three", "No 3D view: three.js is not here. It comes with the Python package trimesh: install that, and run the command of this page again.");
    return;
  }

  // ---------------------------------------------------------------- what all views share
  const geometries = data.meshes.map((mesh) => {
    const made = new THREE.BufferGeometry();
    const corners = Float32Array.from(new Uint16Array(bytes(mesh.corners)), (code, k) => placed(mesh, code, k % 3));
    const Whole = corners.length <= 3 * 65536 ? Uint16Array : Uint32Array;
    made.setAttribute("position", new THREE.BufferAttribute(corners, 3));
    made.setIndex(new THREE.BufferAttribute(new Whole(bytes(mesh.faces)), 1));
    made.computeVertexNormals();
    made.computeBoundingBox();
    return made;
  });
  // the inside too: surfaces of files may have gaps
  const solid = (colour) => new THREE.MeshLambertMaterial({ color: colour, side: THREE.DoubleSide });
  const thin = (colour, opacity, more) =>
    new THREE.MeshLambertMaterial({ color: colour, transparent: true, opacity, depthWrite: false, side: THREE.DoubleSide, ...more });
  const line = (colour, opacity = 1) => new THREE.LineBasicMaterial({ color: colour, transparent: opacity < 1, opacity });
  const VEIL = 0.26;
  const ink = {
    driven: solid(0x7b9cc4), simulated: solid(0xd9a33c), fixed: thin(0x8b95a5, 0.22), furniture: thin(0xb5793a, 0.5), bad: solid(0xe02020),
    // where a ghost is just where its body is, the body is seen
    ghost: thin(0x9b59d0, VEIL, { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 4 }),
    ghostBad: thin(0xe02020, 0.6, { polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -4 }),
    edge: line(0x8b95a5, 0.55), outline: line(0x5b6b80), dark: line(0x4a3a12, 0.7),
    ring: new THREE.MeshBasicMaterial({ color: 0xe02020, depthTest: false, transparent: true, opacity: 0.85 }),
  };
  let tested = false;
  const shapeOf = (k) => (tested ? data.bodies[k].tested : undefined) ?? data.bodies[k].mesh;
  const edges = [], edgesOf = (k) => edges[k] ||= new THREE.EdgesGeometry(geometries[k], 25);
  // a plate seen from its edge is all but invisible: its outline is not
  const THIN = 0.03;
  const isThin = (k) => {
    const size = geometries[k].boundingBox.getSize(new THREE.Vector3()).toArray();
    return Math.min(...size) < THIN * Math.max(...size);
  };
  const ringShape = new THREE.TorusGeometry(1, 0.12, 8, 32);
  const unpacked = (packed) => ({
    states: packed.states, places: new Uint16Array(bytes(packed.places)), turns: new Int16Array(bytes(packed.turns)),
  });
  function put(mesh, from, state, slot, count) {
    const row = Math.min(state, from.states - 1) * count + slot, at = 3 * row, turn = 4 * row;
    const place = [...from.places.subarray(at, at + 3)], [w, ...xyz] = from.turns.subarray(turn, turn + 4);
    mesh.visible = place.every((code) => code > 0);
    mesh.position.set(...place.map((code, k) => placed(data, code, k)));
    mesh.quaternion.set(...xyz, w).normalize();
  }
  const ghost = data.ghost && unpacked(data.ghost);
  // the share makes up for digits that an address leaves out: a drawn state stands for those until the next
  const ROUNDED = 0.05, last = data.times.length - 1, dt = last ? data.times[last] / last : 1 / 60;
  const stateAt = (seconds) => Math.max(0, data.times.findLastIndex((time) => time <= seconds + ROUNDED * dt));

  const views = data.views.map((view) => {
    const world = new THREE.Scene();
    world.add(new THREE.HemisphereLight(0xffffff, 0x8a8f99, 0.75));
    const lamp = new THREE.DirectionalLight(0xffffff, 0.55);
    world.add(lamp, lamp.target);
    const meshes = data.bodies.map((body) => new THREE.Mesh(geometries[body.mesh], ink[body.role]));
    world.add(...meshes);
    // boxes in a stack are told apart by their edges; round bodies have none
    for (const k of data.moving) {
      const sharp = data.bodies[k].role === "simulated" && edgesOf(data.bodies[k].mesh);
      if (sharp && sharp.attributes.position.count) meshes[k].add(new THREE.LineSegments(sharp, ink.dark));
    }
    for (const still of data.still) {
      const mesh = meshes[still.body], shape = data.bodies[still.body].mesh;
      mesh.position.set(...still.place);
      mesh.quaternion.set(...still.turn.slice(1), still.turn[0]);
      mesh.add(new THREE.LineSegments(edgesOf(shape), isThin(shape) ? ink.outline : ink.edge));
    }
    const above = (mesh, order) => { mesh.renderOrder = order; world.add(mesh); return mesh; };
    const ghosts = ghost ? data.ghost.bodies.map((k) => above(new THREE.Mesh(geometries[data.bodies[k].mesh], ink.ghost), 2)) : [];
    const rings = [0, 1, 2].map(() => above(new THREE.Mesh(ringShape, ink.ring), 3));
    // lines of a metre, to see how far bodies go
    const ground = data.ground && new THREE.GridHelper(8, 8, 0x8b95a5, 0x8b95a5);
    if (ground) world.add(ground.rotateX(Math.PI / 2));
    const dot = make("span", { className: "dot" }), picture = make("div", { className: "picture" });
    dot.style.background = view.colour;
    const said = make("p", { className: "said" }), called = make("p", { className: "called" }, dot, view.label);
    const cell = make("div", { className: "view" }, called, picture, said);
    stage.append(cell);
    return { ...view, world, lamp, meshes, ghosts, rings, ground, cell, picture, said, called, from: unpacked(view) };
  });

  // where two bodies overlap, nearly: the middle of what their boxes share
  const boxOf = (mesh) => { mesh.updateMatrixWorld(); return mesh.geometry.boundingBox.clone().applyMatrix4(mesh.matrixWorld); };
  function mark(view) {
    view.meshes.forEach((mesh, k) => { mesh.material = ink[data.bodies[k].role]; });
    const pairs = view.pairs[state] || [];
    view.rings.forEach((ring, k) => {
      ring.visible = k < pairs.length;
      if (!ring.visible) return;
      const [a, b] = pairs[k].map((body) => boxOf(view.meshes[body])), shared = a.intersect(b);
      ring.visible = !shared.isEmpty();
      if (!ring.visible) return;
      shared.getCenter(ring.position);
      ring.scale.setScalar(Math.max(0.035 * eye.distance, 0.4 * Math.min(shared.getSize(new THREE.Vector3()).length(), 0.2 * eye.distance)));
      ring.quaternion.copy(camera.quaternion);
    });
    const overlapping = data.ghost_overlaps?.[state] || [];
    view.ghosts.forEach((mesh, slot) => { mesh.material = overlapping.includes(data.ghost.bodies[slot]) ? ink.ghostBad : ink.ghost; });
    // fixed bodies keep their colour: a whole floor in red would hide where it happens
    for (const k of pairs.flat()) if (data.bodies[k].role !== "fixed") view.meshes[k].material = ink.bad;
  }
  function caption(view) {
    const [kind, text] = view.captions[state] ?? ["", state < view.from.states ? data.calm : "ended here"];
    view.cell.classList.toggle("overlaps", kind === "overlap" || (kind === "ghost" && ink.ghost.visible));
    view.cell.classList.toggle("moves", kind === "moves");
    view.said.textContent = text;
  }

  // ---------------------------------------------------------------- one eye for all views
  const follow = part("follow"), home = data.eye, middle = new THREE.Vector3(...home.focus);
  follow.checked = home.follows;
  const start = () => ({ azimuth: home.azimuth, height: 0.4, distance: follow.checked ? 2.6 * home.near : 2.7 * home.radius, focus: middle.clone() });
  const eye = start(), lead = middle.clone(), leader = views[home.leader];
  // the places of what is followed in the leading view, so that all views look at the same place, and those of the ghost
  function places() {
    const found = [];
    data.moving.forEach((k, slot) => {
      if (!home.followed.includes(k)) return;
      put(leader.meshes[k], leader.from, state, slot, data.moving.length);
      if (leader.meshes[k].visible) found.push(leader.meshes[k].position);
    });
    leader.ghosts.forEach((mesh, slot) => { put(mesh, ghost, state, slot, leader.ghosts.length); if (mesh.visible) found.push(mesh.position); });
    return found;
  }
  function mean(found) {
    const sum = new THREE.Vector3();
    found.forEach((place) => sum.add(place));
    return found.length ? sum.divideScalar(found.length) : middle.clone();
  }
  // near enough to see all that is followed, and no nearer: for a moment that a reader is led to
  function fit() {
    if (!ghost) return;
    const found = places(), centre = mean(found);
    const wanted = 2.6 * Math.max(...found.map((place) => place.distanceTo(centre) + home.reach), home.least);
    if (follow.checked) eye.distance = wanted;
    else if (wanted < 2.7 * home.radius) { eye.distance = wanted; eye.focus.copy(centre); }
  }
  const camera = new THREE.PerspectiveCamera(38, 1, 0.02 * home.radius, 60 * home.radius);
  camera.up.set(0, 0, 1);
  function look() {
    if (follow.checked) { const at = mean(places()); eye.focus.add(at).sub(lead); lead.copy(at); }
    eye.height = Math.max(-1.5, Math.min(1.5, eye.height));
    const flat = Math.cos(eye.height) * eye.distance;
    camera.position.set(Math.cos(eye.azimuth) * flat, Math.sin(eye.azimuth) * flat, Math.sin(eye.height) * eye.distance).add(eye.focus);
    camera.lookAt(eye.focus);
    // in a large scene what the eye is near to must not lie before the near plane
    camera.near = Math.min(0.02 * home.radius, 0.1 * eye.distance);
  }

  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
  } catch (error) {
    fail("no-webgl", "No 3D view: this browser has no WebGL.");
    return;
  }
  renderer.setScissorTest(true);
  const hidden = { bodies: false, room: false };
  let state = 0, playing = false, began = 0, from = 0, poster = true;
  function draw(whole = false) {
    // words first: they may change how high a view is, and so where the next one is
    views.forEach(caption);
    const all = stage.getBoundingClientRect(), wide = Math.round(all.width), high = Math.round(all.height);
    const size = renderer.getSize(new THREE.Vector2());
    if (size.x !== wide || size.y !== high) {
      renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
      renderer.setSize(wide, high, false);
    }
    look();
    for (const view of views) {
      if (view.cell.hidden) continue;
      const cell = view.picture.getBoundingClientRect();
      if (!whole && (cell.bottom < 0 || cell.top > window.innerHeight)) continue;
      data.moving.forEach((k, slot) => {
        put(view.meshes[k], view.from, state, slot, data.moving.length);
        view.meshes[k].visible &&= !hidden.bodies;
      });
      for (const { body } of data.still) view.meshes[body].visible = !hidden.room;
      view.ghosts.forEach((mesh, slot) => put(mesh, ghost, state, slot, view.ghosts.length));
      mark(view);
      if (view.ground) view.ground.position.set(Math.round(eye.focus.x), Math.round(eye.focus.y), 0);
      view.lamp.position.copy(camera.position);
      view.lamp.target.position.copy(eye.focus);
      const box = [cell.left - all.left, all.bottom - cell.bottom, cell.width, cell.height];
      renderer.setViewport(...box);
      renderer.setScissor(...box);
      camera.aspect = cell.width / cell.height;
      camera.updateProjectionMatrix();
      renderer.render(view.world, camera);
    }
    root.dataset.frame = state;
  }

  // ---------------------------------------------------------------- time
  let asked = 0;
  const redraw = () => { asked ||= requestAnimationFrame(() => { asked = 0; draw(); }); };
  const bar = part("bar"), button = part("play"), speeds = part("speed");
  const begin = () => { began = performance.now(); from = data.times[state]; };
  function show(wanted) {
    state = Math.max(0, Math.min(last, Math.round(wanted)));
    bar.value = state;
    const seconds = data.times[state].toFixed(2);
    bar.setAttribute("aria-valuetext", `${seconds} seconds`);
    part("time").textContent = `${data.frames ? `frame ${data.frames[state]}, ` : ""}${seconds} s`;
    document.dispatchEvent(new CustomEvent("shown-time", { detail: { time: data.times[state], state } }));
    redraw();
  }
  function seek(wanted) { poster = false; show(wanted); begin(); }
  function play(on) {
    playing = on;
    if (playing && poster) reset();
    if (playing && (state >= last || poster)) show(0);
    poster = false;
    button.textContent = playing ? "Pause" : "Play";
    root.dataset.state = playing ? "playing" : "paused";
    begin();
    if (playing) requestAnimationFrame(tick);
  }
  function tick(now) {
    if (!playing) return;
    const wanted = stateAt(from + Math.max(0, now - began) / 1000 * Number(speeds.value));
    if (wanted > state) show(wanted);
    if (state >= last) play(false); else requestAnimationFrame(tick);
  }
  bar.max = last;
  bar.addEventListener("input", () => seek(Number(bar.value)));
  button.addEventListener("click", () => play(!playing));
  speeds.addEventListener("change", begin);
  if (data.times[last] < 1.6) speeds.value = "0.25";
  const reset = () => { Object.assign(eye, start()); lead.copy(middle); redraw(); };
  part("home").addEventListener("click", reset);
  follow.addEventListener("change", reset);
  document.addEventListener("seek-time", (event) => seek(stateAt(event.detail)));

  // ---------------------------------------------------------------- what is shown
  function box(name, act, colour, checked = true) {
    const input = make("input", { type: "checkbox", checked }), key = make("span", { className: "key" });
    key.style.background = colour || "none";
    input.addEventListener("change", () => { act(input.checked); redraw(); });
    part("shown").append(make("label", {}, input, " ", ...(colour ? [key] : []), name));
    return input;
  }
  function dress(mesh, k) {
    mesh.geometry = geometries[shapeOf(k)];
    for (const lines of mesh.children) lines.geometry = edgesOf(shapeOf(k));
  }
  views.forEach((view, k) => {
    view.input = box(view.label, (on) => {
      if (!single) { view.cell.hidden = !on; return; }
      hidden.bodies = !on;
      // a ghost alone is solid
      Object.assign(ink.ghost, { opacity: on ? VEIL : 1, depthWrite: !on });
    }, single && view.colour);
    view.input.dataset.view = k;
  });
  if (ghost) box(data.ghost.name, (on) => { ink.ghost.visible = ink.ghostBad.visible = on; }, "#9b59d0").dataset.part = "ghost";
  if (data.still.length) box("room", (on) => { hidden.room = !on; }, "#8b95a5").dataset.part = "room";
  if (data.bodies.some((body) => body.tested !== undefined)) {
    box("shapes that are tested", (on) => {
      tested = on;
      for (const view of views) {
        view.meshes.forEach(dress);
        view.ghosts.forEach((mesh, slot) => dress(mesh, data.ghost.bodies[slot]));
      }
    }, "", false).dataset.part = "tested";
  }

  // ---------------------------------------------------------------- keys
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const tag = event.target.tagName;
    if (tag === "SELECT" || (tag === "INPUT" && event.target !== bar) || (tag === "BUTTON" && event.key === " ") || tag === "SUMMARY") return;
    const far = event.shiftKey ? 10 : 1, to = (wanted) => () => { play(false); seek(wanted); };
    const turn = (name, change) => () => { eye[name] += change; redraw(); }, zoom = (factor) => () => { eye.distance *= factor; redraw(); };
    const acts = {
      " ": () => play(!playing), ArrowRight: to(state + far), ArrowLeft: to(state - far), Home: to(0), End: to(last),
      r: reset, f: () => follow.click(), a: turn("azimuth", -0.1), d: turn("azimuth", 0.1), w: turn("height", 0.08),
      s: turn("height", -0.08), "+": zoom(1 / 1.12), "-": zoom(1.12),
    };
    const act = acts[event.key];
    if (act) { event.preventDefault(); act(); }
  });

  // ---------------------------------------------------------------- moments, and links to them
  const told = part("told"), link = (wanted) => `#t=${Number(data.times[wanted].toFixed(5))}`;
  // views by their labels: a link can lead to two of many
  function chosen() {
    const found = /[#&]only=([^&]+)/.exec(location.hash), only = found ? decodeURIComponent(found[1]).split("|") : [];
    if (single || !views.some((view) => only.includes(view.label))) return;
    for (const view of views) view.cell.hidden = !(view.input.checked = only.includes(view.label));
    redraw();
  }
  function follows() {
    chosen();
    const found = /^#(?:.*&)?t=([^&]+)/.exec(location.hash), seconds = found ? Number(found[1]) : NaN;
    if (!Number.isFinite(seconds)) return false;
    if (playing) play(false);
    seek(stateAt(seconds));
    fit();
    return true;
  }
  window.addEventListener("hashchange", follows);
  part("link").addEventListener("click", () => {
    location.hash = link(state);
    told.textContent = "The address bar links to this moment.";
    if (!navigator.clipboard) return;
    navigator.clipboard.writeText(location.href).then(() => { told.textContent = "A link to this moment is copied."; }, () => {});
  });
  function moment(view, one) {
    const made = make("button", { type: "button", className: one.is_worst ? "worst" : "" }, one.said);
    made.dataset.worst = one.state;
    made.addEventListener("click", () => {
      // no navigation, which would end the scrolling below
      history.replaceState(null, "", link(one.state));
      follows();
      (view.cell.hidden ? stage : view.cell).scrollIntoView({ block: "nearest" });
    });
    return made;
  }
  views.forEach((view) => {
    if (!view.moments.length) return;
    const list = make("div", {}, ...view.moments.map((one) => moment(view, one)));
    const title = make("summary", {}, "Worst moments", ...(single ? [] : [" of ", make("b", {}, view.label)]));
    part("moments").append(make("details", { open: view === leader }, title, list));
  });

  // ---------------------------------------------------------------- a moving picture, of what is shown at the chosen speed
  const film = part("film"), filmed = film.textContent;
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
    const all = stage.getBoundingClientRect(), style = getComputedStyle(document.body), size = Math.max(10, Math.round(12.5 * ratio));
    pen.fillStyle = style.backgroundColor;
    pen.fillRect(0, 0, pen.canvas.width, pen.canvas.height);
    pen.drawImage(canvas, 0, 0, pen.canvas.width, pen.canvas.height);
    pen.font = `${size}px sans-serif`;
    pen.textBaseline = "top";
    for (const view of views) {
      if (view.cell.hidden) continue;
      const at = view.cell.getBoundingClientRect(), top = (view.said.getBoundingClientRect().top - all.top) * ratio;
      const [x, y, wide, tall] = [at.left - all.left, at.top - all.top, at.width, at.height].map((length) => length * ratio);
      pen.strokeStyle = getComputedStyle(view.cell).borderTopColor;
      pen.strokeRect(x + 0.5, y + 0.5, wide - 1, tall - 1);
      pen.fillStyle = style.color;
      pen.fillText(view.called.textContent, x + 7, y + 6 * ratio);
      pen.fillStyle = getComputedStyle(view.said).color;
      // letters are no smaller than they can be read, and so may need more room than on the page
      const lines = wrapped(pen, view.said.textContent, wide - 14), begins = Math.min(top, y + tall - 1.3 * size * lines.length);
      lines.forEach((words, k) => pen.fillText(words, x + 7, begins + 1.3 * size * k, wide - 14));
    }
    return pen.getImageData(0, 0, pen.canvas.width, pen.canvas.height).data;
  }
  async function record() {
    play(false);
    filming = true;
    const begun = state, all = stage.getBoundingClientRect(), ratio = Math.min(1, WIDEST / all.width);
    const still = dt / Number(speeds.value), step = Math.max(1, Math.ceil(LEAST_DELAY / still), Math.ceil((last + 1) / MOST_PICTURES));
    const states = Array.from({ length: Math.floor(last / step) + 1 }, (_, k) => k * step);
    const sheet = make("canvas", { width: Math.round(all.width * ratio), height: Math.round(all.height * ratio) });
    const pen = sheet.getContext("2d", { willReadFrequently: true }), gif = animatedGif(sheet.width, sheet.height);
    const at = (wanted) => { show(wanted); return shot(pen, ratio); };
    const worst = views.flatMap((view) => view.moments.slice(0, SAMPLES).map((one) => one.state));
    gif.choose([...worst, ...Array.from({ length: SAMPLES }, (_, k) => Math.round((k * last) / SAMPLES))].map(at));
    for (const [k, wanted] of states.entries()) {
      film.textContent = `Stop: picture ${k + 1} of ${states.length}`;
      gif.add(at(wanted), Math.max(2, Math.round(100 * step * still)));
      await new Promise((done) => setTimeout(done));
      if (!filming) break;
    }
    if (filming) {
      const whole = new Blob([gif.bytes()], { type: "image/gif" });
      const anchor = make("a", { href: URL.createObjectURL(whole), download: `${data.name}.gif` });
      anchor.click();
      setTimeout(() => URL.revokeObjectURL(anchor.href), 10000);
      told.textContent = `Saved ${anchor.download}: ${states.length} pictures, ${(whole.size / 1e6).toFixed(1)} MB.`;
      root.dataset.filmed = whole.size;
    } else { told.textContent = "Stopped; nothing was saved."; }
    filming = false;
    film.textContent = filmed;
    show(begun);
  }
  film.addEventListener("click", () => { if (filming) filming = false; else record(); });

  // ---------------------------------------------------------------- drag turns, with the right button or shift it moves
  let held = null;
  stage.addEventListener("pointerdown", (event) => { held = [event.clientX, event.clientY]; stage.setPointerCapture(event.pointerId); stage.focus({ preventScroll: true }); });
  for (const end of ["pointerup", "pointercancel"]) stage.addEventListener(end, () => { held = null; });
  stage.addEventListener("pointermove", (event) => {
    if (!held) return;
    const [x, y] = [event.clientX - held[0], event.clientY - held[1]];
    held = [event.clientX, event.clientY];
    if (event.shiftKey || event.buttons === 2) {
      const unit = eye.distance / 500, axis = (k) => new THREE.Vector3().setFromMatrixColumn(camera.matrix, k);
      eye.focus.addScaledVector(axis(0), -x * unit).addScaledVector(axis(1), y * unit);
    } else { eye.azimuth -= 0.008 * x; eye.height += 0.008 * y; }
    redraw();
  });
  stage.addEventListener("contextmenu", (event) => event.preventDefault());
  // the wheel scrolls the page unless the stage has been touched
  stage.addEventListener("wheel", (event) => {
    if (document.activeElement !== stage && !event.ctrlKey) return;
    event.preventDefault();
    eye.distance *= Math.exp(0.0012 * event.deltaY);
    redraw();
  }, { passive: false });
  for (const change of ["resize", "scroll"]) window.addEventListener(change, redraw, { passive: true });
  root.dataset.state = "paused";
  // opens on the moment that the address names, else on the one that the page names
  if (!follows()) { show(data.opens); fit(); }
}

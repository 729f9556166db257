// Plays a motion before and after in one view: orthographic projection, faces sorted from far to near (painter's algorithm).
"use strict";
(() => {
  const clip = JSON.parse(document.getElementById("clip").textContent);
  const at = (id) => document.getElementById(id);
  const canvas = at("view"), stage = at("stage"), pen = canvas.getContext("2d"), bar = at("bar");
  const STEPS = 65535, UNIT = 32767, LIGHT = [0.55, -0.25, 0.8];

  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;
  const motions = [clip.before, clip.after].map((one) => ({
    places: new Uint16Array(bytes(one.places)), turns: new Int16Array(bytes(one.turns)),
  }));
  const links = clip.links.map((one) => ({ v: Float64Array.from(one.v), t: one.t }));
  const room = clip.room.map((one) => ({ v: Float64Array.from(one.v), t: one.t }));
  let shown = 0, playing = false, began = 0, from = 0, yaw = -0.6, pitch = 0.35, zoom = 1, centre = [0, 0, 0];

  // where the vertices of a link are in the world: a quaternion, scalar first, made unit again after rounding
  function placed(motion, k, link) {
    const n = (k * links.length + link), p = motion.places, q = motion.turns, s = clip.size / STEPS;
    let [w, x, y, z] = [q[4 * n], q[4 * n + 1], q[4 * n + 2], q[4 * n + 3]];
    const norm = Math.hypot(w, x, y, z) || UNIT;
    w /= norm; x /= norm; y /= norm; z /= norm;
    const r = [
      1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z), 1 - 2 * (x * x + z * z),
      2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
    ];
    const o = [0, 1, 2].map((c) => clip.least[c] + s * p[3 * n + c]), v = links[link].v, out = new Float64Array(v.length);
    for (let i = 0; i < v.length; i += 3) {
      for (let c = 0; c < 3; c++) out[i + c] = o[c] + r[3 * c] * v[i] + r[3 * c + 1] * v[i + 1] + r[3 * c + 2] * v[i + 2];
    }
    return out;
  }

  function axes() {
    const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
    return { right: [-sy, cy, 0], up: [-sp * cy, -sp * sy, cp], to: [cp * cy, cp * sy, sp] };
  }
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

  // faces of a surface that are turned to the eye, with what their colour and order depend on
  function faces(v, t, view, colour, alpha, into) {
    for (let i = 0; i < t.length; i += 3) {
      const [a, b, c] = [t[i], t[i + 1], t[i + 2]].map((n) => [v[3 * n], v[3 * n + 1], v[3 * n + 2]]);
      const u = [b[0] - a[0], b[1] - a[1], b[2] - a[2]], w = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
      const normal = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]];
      const size = Math.hypot(...normal);
      if (!(size > 0) || dot(normal, view.to) <= 0) continue;
      const bright = 0.72 + 0.28 * Math.max(-1, Math.min(1, dot(normal, LIGHT) / size));
      into.push({ p: [a, b, c], depth: dot(a, view.to) + dot(b, view.to) + dot(c, view.to), colour, bright, alpha, normal });
    }
  }

  function fill(face, view, scale, width, height) {
    pen.beginPath();
    for (const p of face.p) {
      const d = [p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]];
      pen.lineTo(width / 2 + scale * dot(d, view.right), height / 2 - scale * dot(d, view.up));
    }
    pen.closePath();
    const [r, g, b] = face.colour.map((part) => Math.round(part * face.bright));
    pen.globalAlpha = face.alpha;
    pen.fillStyle = pen.strokeStyle = `rgb(${r},${g},${b})`;
    pen.fill();
    // seams between neighbours would show what is behind
    if (face.alpha === 1) pen.stroke();
  }

  const colour = (key) => getComputedStyle(document.querySelector(key)).backgroundColor.match(/[\d.]+/g).slice(0, 3).map(Number);

  function draw() {
    const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.globalAlpha = 1;
    pen.clearRect(0, 0, width, height);
    pen.lineWidth = 0.6;
    const view = axes(), scale = zoom * Math.min(width, height) / (1.8 * clip.extent);
    const wanted = [at("show-before").checked, at("show-after").checked];
    const inks = [colour(".key.before"), colour(".key.after")];
    // what was before lies as a veil over what is after
    const figures = [[], []];
    motions.forEach((motion, m) => {
      if (!wanted[m]) return;
      const alpha = m === 0 && wanted[1] ? 0.35 : 1;
      links.forEach((link, k) => faces(placed(motion, shown, k), link.t, view, inks[m], alpha, figures[m]));
    });
    if (at("follow").checked || !draw.done) {
      centre = [0, 1, 2].map((c) => clip.least[c] + clip.size / STEPS * motions[1].places[3 * shown * links.length + c]);
      draw.done = true;
    }
    const far = [], near = [];
    if (at("show-room").checked) {
      const all = [], grey = colour(".key.room");
      for (const one of room) faces(one.v, one.t, view, grey, 1, all);
      for (const face of all) {
        const behind = dot(face.normal, [0, 1, 2].map((c) => centre[c] - face.p[0][c])) > 0;
        if (!behind) { face.alpha = 0.3; face.bright *= 0.75; }
        (behind ? far : near).push(face);
      }
    }
    for (const group of [far, figures[1], figures[0], near]) {
      group.sort((a, b) => a.depth - b.depth);
      for (const face of group) fill(face, view, scale, width, height);
      if (group === far) grid(view, scale, width, height);
    }
    pen.globalAlpha = 1;
    tell();
  }

  // lines of a metre on the level ground, so that it is seen how far the avatar goes
  function grid(view, scale, width, height) {
    pen.globalAlpha = 0.5;
    pen.strokeStyle = getComputedStyle(at("told")).color;
    pen.lineWidth = 0.3;
    const [x, y] = [Math.round(centre[0]), Math.round(centre[1])];
    const spot = (p) => {
      const d = [p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]];
      return [width / 2 + scale * dot(d, view.right), height / 2 - scale * dot(d, view.up)];
    };
    for (let k = -4; k <= 4; k++) {
      for (const [a, b] of [[[x + k, y - 4, 0], [x + k, y + 4, 0]], [[x - 4, y + k, 0], [x + 4, y + k, 0]]]) {
        pen.beginPath();
        pen.moveTo(...spot(a));
        pen.lineTo(...spot(b));
        pen.stroke();
      }
    }
    pen.lineWidth = 0.6;
  }

  function quantity(metres) {
    for (const [unit, size] of [["m", 1], ["mm", 1e-3], ["µm", 1e-6]]) {
      if (metres >= size) return `${Number((metres / size).toPrecision(3))} ${unit}`;
    }
    return `${Number((metres / 1e-9).toPrecision(3))} nm`;
  }

  function tell() {
    const said = ["before", "after"].map((name, m) => {
      const depth = clip.depths[m][shown];
      return `${name}: ${depth > 0 ? `overlap ${quantity(depth)}` : "no overlap"}`;
    });
    const frame = clip.frames[shown];
    at("told").textContent = `frame ${frame} · ${clip.seconds[shown].toFixed(2)} s · ${said.join(" · ")}`;
    const overlaps = (at("show-before").checked && clip.depths[0][shown] > 0) || (at("show-after").checked && clip.depths[1][shown] > 0);
    stage.classList.toggle("overlaps", overlaps);
    stage.dataset.frame = String(frame);
    bar.value = String(frame);
    at("now").setAttribute("x", String(frame));
  }

  // the drawn frame nearest to one of the clip
  function nearest(frame) {
    let low = 0, high = clip.frames.length - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (clip.frames[middle] < frame) low = middle + 1; else high = middle;
    }
    return low > 0 && frame - clip.frames[low - 1] < clip.frames[low] - frame ? low - 1 : low;
  }
  function go(frame) {
    shown = nearest(Math.max(0, Math.min(clip.frames[clip.frames.length - 1], frame)));
    began = performance.now();
    from = clip.seconds[shown];
    draw();
  }

  function step(now) {
    if (!playing) return;
    const last = clip.frames.length - 1, time = from + (now - began) / 1000 * Number(at("speed").value);
    let k = shown;
    while (k < last && clip.seconds[k + 1] <= time) k++;
    if (k !== shown) { shown = k; draw(); }
    if (k === last) play(false); else requestAnimationFrame(step);
  }
  function play(on) {
    if (on && shown === clip.frames.length - 1) shown = 0;
    playing = on;
    at("play").textContent = on ? "Pause" : "Play";
    stage.dataset.state = on ? "playing" : "paused";
    began = performance.now();
    from = clip.seconds[shown];
    if (on) requestAnimationFrame(step);
  }

  at("play").addEventListener("click", () => play(!playing));
  at("speed").addEventListener("change", () => { began = performance.now(); from = clip.seconds[shown]; });
  bar.addEventListener("input", () => { play(false); go(Number(bar.value)); });
  for (const id of ["show-before", "show-after", "show-room", "follow"]) at(id).addEventListener("change", draw);
  document.querySelectorAll("[data-frame]").forEach((one) => {
    if (one === stage) return;
    one.addEventListener("click", () => { play(false); go(Number(one.dataset.frame)); stage.scrollIntoView({ block: "nearest" }); });
  });
  at("line").addEventListener("click", (event) => {
    const box = at("line").getBoundingClientRect();
    play(false);
    go(Math.floor((event.clientX - box.left) / box.width * (clip.frames[clip.frames.length - 1] + 1)));
  });
  let held = null;
  canvas.addEventListener("pointerdown", (event) => { held = [event.clientX, event.clientY]; canvas.setPointerCapture(event.pointerId); });
  canvas.addEventListener("pointermove", (event) => {
    if (!held) return;
    yaw -= (event.clientX - held[0]) * 0.008;
    pitch = Math.max(-1.5, Math.min(1.5, pitch + (event.clientY - held[1]) * 0.008));
    held = [event.clientX, event.clientY];
    draw();
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { held = null; });
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    zoom = Math.max(0.2, Math.min(12, zoom * Math.exp(-0.002 * event.deltaY)));
    draw();
  }, { passive: false });
  document.addEventListener("keydown", (event) => {
    const part = event.target && event.target.tagName;
    if (part === "INPUT" || part === "SELECT" || part === "BUTTON") return;
    const frame = clip.frames[shown];
    if (event.key === " ") play(!playing);
    else if (event.key === "ArrowRight") { play(false); go(clip.frames[Math.min(shown + 1, clip.frames.length - 1)]); }
    else if (event.key === "ArrowLeft") { play(false); go(clip.frames[Math.max(shown - 1, 0)]); }
    else if (event.key === "Home") { play(false); go(0); }
    else if (event.key === "End") { play(false); go(clip.frames[clip.frames.length - 1]); }
    else if (event.key === "+" || event.key === "-") { zoom *= event.key === "+" ? 1.15 : 1 / 1.15; go(frame); }
    else return;
    event.preventDefault();
  });
  window.addEventListener("resize", draw);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  const asked = () => { const found = /^#f=(\d+)$/.exec(location.hash); return found ? Number(found[1]) : clip.first; };
  window.addEventListener("hashchange", () => { play(false); go(asked()); });
  stage.dataset.state = "paused";
  go(asked());
})();

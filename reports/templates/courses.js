// Lines over the time of a scene, with one cursor through all charts; listens to a replay on the same page, and leads it.
"use strict";
(() => {
  const found = document.getElementById("courses-data");
  if (!found) return;
  const data = JSON.parse(found.textContent);
  const root = document.getElementById("courses-charts");
  // drawn narrower where there is little room, so that the words keep their size
  const WIDTH = window.innerWidth < 520 ? 340 : 560, HEIGHT = 132, LEFT = 62, RIGHT = 10, TOP = 8, BOTTOM = 22;
  const make = (name, about, inside) => {
    const node = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(about)) node.setAttribute(key, value);
    if (inside !== undefined) node.textContent = inside;
    return node;
  };
  const html = (name, style, inside) => {
    const node = document.createElement(name);
    if (style) node.className = style;
    if (inside !== undefined) node.textContent = inside;
    return node;
  };
  const numbers = (packed) => new Uint16Array(Uint8Array.from(atob(packed), (sign) => sign.charCodeAt(0)).buffer);
  const reals = (packed) => new Float32Array(Uint8Array.from(atob(packed), (sign) => sign.charCodeAt(0)).buffer);
  let cursors = [], end = 1, now = 0;

  function chart(about) {
    const box = html("figure", "plot course");
    box.append(html("h4", "", about.title + (about.unit === "J" ? " [J]" : "")));
    const low = about.log ? Math.log10(about.low) : about.low, high = about.log ? Math.log10(about.high) : about.high;
    const across = (time) => LEFT + (WIDTH - LEFT - RIGHT) * Math.min(1, Math.max(0, time / end));
    const up = (line, code) => TOP + (HEIGHT - TOP - BOTTOM) * (1 - Math.min(1, Math.max(0, (share(line, code) - low) / (high - low))));
    // a line has its own scale, so that none loses digits to another that explodes; what is beyond the axis is drawn at its end
    const share = (line, code) => line.low + ((code - 1) / 65534) * (line.high - line.low);
    const real = (line, code) => about.log ? 10 ** share(line, code) : share(line, code);
    const picture = make("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": `${about.title} over time. ${about.text}` });
    const ticks = about.log ? Array.from({ length: Math.round(high - low) + 1 }, (_, k) => low + k) : [low, (low + high) / 2, high];
    const every = about.log ? Math.ceil(ticks.length / 5) : 1;
    ticks.forEach((tick, k) => {
      if (k % every) return;
      const y = TOP + (HEIGHT - TOP - BOTTOM) * (1 - (tick - low) / (high - low));
      const value = about.log ? 10 ** tick : tick;
      const floor = about.key === "overlap" && k === 0 ? "≤ " : "";
      picture.append(make("line", { x1: LEFT, x2: WIDTH - RIGHT, y1: y, y2: y, stroke: data.grid }));
      picture.append(make("text", { x: LEFT - 6, y: y + 3.5, "text-anchor": "end", "font-size": 10, fill: data.muted }, floor + quantity(value, about.unit === "J" ? "" : about.unit, true)));
    });
    for (const share of [0, 0.25, 0.5, 0.75, 1]) {
      picture.append(make("text", { x: across(share * end), y: HEIGHT - 6, "text-anchor": share === 1 ? "end" : "middle", "font-size": 10, fill: data.muted }, `${quantity(share * end, "", true)} s`));
    }
    if (about.key === "overlap") {
      const y = TOP + (HEIGHT - TOP - BOTTOM) * (1 - (-6 - low) / (high - low));
      picture.append(make("line", { x1: LEFT, x2: WIDTH - RIGHT, y1: y, y2: y, stroke: data.alarm, "stroke-dasharray": "4 3" }));
    }
    const lines = about.lines.map((line) => ({ ...line, codes: numbers(line.values), moments: reals(line.times) }));
    lines.sort((a, b) => Number(b.run.startsWith("tracker/")) - Number(a.run.startsWith("tracker/")));
    for (const line of lines) {
      let path = "", begun = false;
      line.codes.forEach((code, k) => {
        if (!code) { begun = false; return; }
        path += `${begun ? "L" : "M"}${across(line.moments[k]).toFixed(1)} ${up(line, code).toFixed(1)}`;
        begun = true;
      });
      const stroke = data.strokes[line.run] || { light: data.muted, dash: "" };
      picture.append(make("path", { d: path || "M0 0", fill: "none", stroke: stroke.light, "stroke-width": 1.6, "stroke-dasharray": stroke.dash, "stroke-linejoin": "round" }));
    }
    const cursor = make("line", { x1: LEFT, x2: LEFT, y1: TOP, y2: HEIGHT - BOTTOM, stroke: data.ink, "stroke-width": 1 });
    picture.append(cursor);
    const told = html("p", "told");
    cursors.push((time, length) => {
      cursor.setAttribute("x1", across(time));
      cursor.setAttribute("x2", across(time));
      told.textContent = lines.map((line) => {
        // a point stands for the frames from its own on to the next point's
        const later = line.moments.findIndex((moment) => moment > time + 1e-4), k = (later < 0 ? line.codes.length : later) - 1;
        const last = line.moments.at(-1), apart = line.codes.length > 1 ? last - line.moments.at(-2) : 0;
        // times end, and may begin, where timing did; what is measured of every state has a value at any time
        if (about.key === "time" && (k < 0 || time > last + apart)) return `${line.run} not timed`;
        const first = Math.max(0, Math.min(line.codes.length - 1, k));
        // of all points that the state shown stands for, the largest
        const beyond = line.moments.findIndex((moment) => moment > time + length - 1e-4);
        const codes = line.codes.slice(first, Math.max(first + 1, beyond < 0 ? line.codes.length : beyond));
        if (codes.includes(0)) return `${line.run} no number`;
        const value = real(line, Math.max(...codes));
        return `${line.run} ${about.key === "overlap" && value <= about.low * 1.0005 ? "0" : about.unit ? quantity(value, about.unit) : Math.round(value).toLocaleString("en")}`;
      }).join(" · ");
    });
    const seek = (event) => {
      const frame = picture.getBoundingClientRect();
      const share = ((event.clientX - frame.left) / frame.width * WIDTH - LEFT) / (WIDTH - LEFT - RIGHT);
      move(Math.max(0, Math.min(1, share)) * end, true);
    };
    // beside a replay the pointer leads only while it is held down
    picture.addEventListener("pointermove", (event) => { if (event.buttons || !document.getElementById("replay-data")) seek(event); });
    picture.addEventListener("pointerdown", seek);
    const caption = html("figcaption");
    caption.append(html("span", "", about.shows + " "), html("b", "", about.concludes));
    const words = html("details");
    words.append(html("summary", "", "in words"), html("p", "", about.text));
    box.append(picture, told, caption, words);
    return box;
  }

  // to a time [s], and to all of the `length` [s] from there on that a drawn state stands for
  function move(time, lead, length = 0) {
    now = time;
    cursors.forEach((cursor) => cursor(time, length));
    root.dataset.time = time.toFixed(3);
    if (lead) document.dispatchEvent(new CustomEvent("seek-time", { detail: time }));
  }
  function choose(scene) {
    const charts = data.scenes[scene];
    cursors = [];
    end = Math.max(1e-9, ...charts.flatMap((about) => about.lines.map((line) => reals(line.times).at(-1) ?? 0)));
    root.replaceChildren(...charts.map(chart));
    move(Math.min(now, end), false);
    root.dataset.drawn = charts.length;
  }
  const picker = document.getElementById("courses-scene");
  if (picker) picker.addEventListener("change", () => { now = 0; choose(picker.value); });
  root.tabIndex = 0;
  root.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step || document.getElementById("replay-data")) return;
    event.preventDefault();
    move(Math.max(0, Math.min(end, now + step * end / (event.shiftKey ? 16 : 160))), true);
  });
  document.addEventListener("shown-time", (event) => move(event.detail.time, false, event.detail.length));
  choose(picker ? picker.value : Object.keys(data.scenes)[0]);
})();

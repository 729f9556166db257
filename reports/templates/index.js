// The page of a comparison: linked charts, settings of a scene, the table, the player.
const find = (id) => document.getElementById(id);
const STRIPS = ["overlap", "bounce", "limits", "time"];
let level = 1e-3;

function link(view) {
  view.addEventListener("mouseover", (event, item) => near(item?.datum?.scene || ""));
  view.addEventListener("mouseout", () => near(""));
  view.addEventListener("click", (event, item) => { if (item?.datum?.scene) play(item.datum.scene); });
}
function near(scene) {
  for (const name of STRIPS) if (views[name]) views[name].signal("near", scene).runAsync();
}
async function drawAll() {
  if (page.settings) page.specs.settings.datasets = { points: dots(), limit: limit() };
  // charts under each other have no row in common: each names its engines
  const below = matchMedia("(max-width:900px)").matches;
  for (const name of STRIPS) page.specs[name].layer.forEach((one) => { if (one.encoding.y && one.encoding.y.axis) one.encoding.y.axis.labels = below || name === STRIPS[0]; });
  for (const name of Object.keys(page.specs)) {
    const view = await draw(name, page.specs[name]);
    if (view && STRIPS.includes(name)) link(view);
    if (name === "losses" && view) {
      view.addEventListener("click", (event, item) => { if (item?.datum?.metric) { find("loss").value = item.datum.metric; chooseLoss(); } });
      chooseLoss();
    }
    if (name === "settings") view.addEventListener("click", (event, item) => { if (item?.datum?.at) copyable(item.datum.at); });
  }
  if (page.settings) chooseScene();
}

// ---------------------------------------------------------------- settings of a scene
function dot(engine, hollow) { return `<span class="dot${hollow ? " open" : ""}" style="background:${page.palette[theme()][engine] || "gray"}"></span>`; }
function escaped(text) { const made = document.createElement("i"); made.textContent = text; return made.innerHTML.replaceAll('"', "&quot;"); }
function row(cells) { return `<tr>${cells.map((cell, k) => `<td${k > 1 ? ' class="n"' : ""}>${cell}</td>`).join("")}</tr>`; }
function chosen() { return page.settings[find("scene").value]; }

function limit() { return [{ place: Math.max(level, 1e-7) }]; }
function dots() {
  return unlabelled(chosen().filter((one) => one.measured).map((one) => ({
    engine: one.engine, name: `${one.label} ${one.setting}`, place: one.error === null ? 0.3 : Math.max(one.error, 1e-7), time: one.median,
    text: one.shown.error, which: one.worst, when: one.shown.median, state: one.asleep ? "asleep" : "awake", asleep: one.asleep, preset: one.preset,
    step: one.step || 0, ladder: `${one.engine} ${one.step ? one.base : one.setting}`, short: one.preset ? (["default", "tuned"].includes(one.setting) ? one.setting : "") : one.step ? `1/${one.step}` : "", at: one,
  })));
}
// labels of presets first, then of steps; one that would cover another is left out: a pointed dot says it all
function unlabelled(points) {
  const WIDE = 0.2, HIGH = 0.055, DECADES = 7, kept = [];
  const [least, most] = [Math.min, Math.max].map((of) => Math.log10(of(...points.map((one) => one.time))));
  const place = (one) => [Math.log10(one.time) / (most - least || 1), Math.log10(one.place) / DECADES];
  for (const one of [...points].sort((a, b) => b.preset - a.preset)) {
    const [x, y] = place(one);
    if (one.short && kept.some(([u, v]) => Math.abs(u - x) < WIDE && Math.abs(v - y) < HIGH)) one.short = "";
    if (one.short) kept.push([x, y]);
  }
  return points;
}
function chooseScene() {
  document.querySelectorAll("[data-scene]").forEach((one) => { one.textContent = find("scene").value; });
  find("copied-page").href = `scenes/${find("scene").value}.html#settings`;
  if (views.settings) views.settings.data("points", dots()).resize().runAsync();
  chooseLevel();
  const ladders = chosen().filter((one) => one.measured && one.step && (one.base === "tuned")).sort((a, b) => a.engine.localeCompare(b.engine) || a.step - b.step);
  find("step-rows").innerHTML = ladders.map((one, k) => {
    const before = ladders[k - 1];
    const times = (ratio) => Number(ratio.toPrecision(2));
    const factor = before && before.engine === one.engine ? `×${times(one.median / before.median)}` : "";
    // a rung that was not run leaves a wider one
    const wide = factor && one.step !== 2 * before.step ? `, step ÷ ${times(one.step / before.step)}` : "";
    return row([`${dot(one.engine)}${escaped(one.label)}`, `1/${one.step} s`, fair(one, one.shown.median), factor + wide, one.shown.error]);
  }).join("");
  find("step-unlike").hidden = !find("step-rows").innerText.includes("(");
}
function chooseLevel() {
  const all = chosen(), measured = all.filter((one) => one.measured);
  const engines = [...new Set(all.map((one) => one.engine))];
  const rows = [];
  let first = null;
  for (const engine of engines) {
    const able = measured.filter((one) => one.engine === engine && one.error !== null && one.error <= level).sort((a, b) => a.median - b.median);
    const planned = all.filter((one) => one.engine === engine).length, tried = measured.filter((one) => one.engine === engine).length;
    const label = all.find((one) => one.engine === engine).label;
    if (!able.length) {
      rows.push(row([`${dot(engine)}${escaped(label)}`, `none of ${tried} measured; ${planned - tried} not run`, "–", "–", "–", "–", ""]));
      continue;
    }
    // of times within 3 % a preset is the simpler answer
    const best = able.filter((one) => one.median <= 1.03 * able[0].median).sort((a, b) => rank(b) - rank(a))[0];
    if (!first || engine !== page.gated) first = first && first.engine !== page.gated ? first : best;
    rows.push(`<tr data-at="${all.indexOf(best)}"><td>${dot(engine)}${escaped(label)}</td><td><button type="button" data-copy="${all.indexOf(best)}">${escaped(best.setting)}</button></td><td class="n">${fair(best, best.shown.median)}${best.asleep ? " asleep" : ""}</td><td class="n">${fair(best, best.shown.p95, best.few)}</td><td class="n">${fair(best, best.shown.slowest, best.few)}</td><td class="n">${best.shown.error}</td><td>${escaped(best.worst)}</td></tr>`);
  }
  find("cheapest-rows").innerHTML = rows.join("");
  find("cheapest-rows").querySelectorAll("[data-copy]").forEach((one) => one.addEventListener("click", () => copyable(all[one.dataset.copy])));
  const unlike = find("cheapest-rows").innerText.includes("(");
  find("planned").textContent = `${measured.length} of ${all.length} planned settings were run; make study NAME=settings runs the rest.${unlike ? " In brackets: not like for like." : ""}`;
  if (first) copyable(first);
  if (views.settings) views.settings.data("limit", limit()).runAsync();
}
// times that do not compare engines stand in brackets: those of avatars and of sleep, and tails of too few frames
function fair(one, text, few = false) { return (one.avatar || one.asleep || few) && text !== "–" ? `(${text})` : text; }
// of equal settings: default and tuned, then another preset, then one that its engine's own words make whole
function rank(one) { return ["default", "tuned"].includes(one.setting) ? 3 : one.preset ? 2 : one.alone ? 1 : 0; }
function copyable(one) {
  find("copied-of").textContent = `${one.label} ${one.setting}`;
  find("setting").textContent = one.copy;
}

// ---------------------------------------------------------------- scenes in which another engine is better
function chooseLoss() {
  const metric = find("loss").value;
  document.querySelectorAll("[data-loss]").forEach((one) => { one.hidden = one.dataset.loss !== metric; });
  views.losses.signal("chosen", metric).runAsync();
}

// ---------------------------------------------------------------- stills and player
function showStills() {
  const scene = find("replay-scene").value, strip = find("replays");
  strip.querySelectorAll("figure").forEach((one) => one.remove());
  for (const [label, svg, words] of page.stills[scene]) {
    const figure = document.createElement("figure");
    figure.innerHTML = `${svg}<figcaption><b>${escaped(label)}</b> ${escaped(words)}</figcaption>`;
    strip.append(figure);
  }
}
function play(scene, hash = "") {
  find("player-frame").src = find("player-page").href = `scenes/${scene}.html${hash}`;
  find("player").showModal();
}

// ---------------------------------------------------------------- all figures
async function loadTable() {
  find("load").disabled = true;
  const columns = JSON.parse(await unpack("rows"));
  const style = document.createElement("style");
  style.textContent = await unpack("tables-css");
  document.head.append(style);
  const { default: DataTable } = await import(URL.createObjectURL(new Blob([await unpack("tables")], { type: "text/javascript" })));
  const cell = (name, k) => (["value", "bound"].includes(name) ? columns[name][k] : columns[name][0][columns[name][1][k]]);
  const names = ["scenario", "run", "metric", "value", "unit", "bound", "status", "comparable"];
  const data = columns.value.map((value, k) => names.map((name) => cell(name, k)));
  find("grid").innerHTML = "<table class='display compact'></table>";
  new DataTable("#grid table", {
    data, deferRender: true, pageLength: 25, order: [[0, "asc"]],
    columns: ["scene", "engine", "measure", "value", "unit", "limit", "status", "comparable"].map((title) => ({ title, defaultContent: "", render: DataTable.render.text() })),
  });
}

if (page.stills) {
  find("replay-scene").addEventListener("change", showStills);
  find("play").addEventListener("click", () => { const scene = find("replay-scene").value; play(scene, `#t=${page.instants[scene]}`); });
  showStills();
}
find("player").addEventListener("close", () => { find("player-frame").src = "about:blank"; });
if (page.settings) {
  find("scene").innerHTML = Object.keys(page.settings).map((name) => `<option>${escaped(name)}</option>`).join("");
  find("scene").value = page.first;
  find("scene").addEventListener("change", chooseScene);
  document.querySelectorAll("[data-level]").forEach((one) => one.addEventListener("click", () => {
    document.querySelectorAll("[data-level]").forEach((other) => other.setAttribute("aria-pressed", String(other === one)));
    level = Number(one.dataset.level);
    chooseLevel();
  }));
  find("copy").addEventListener("click", () => navigator.clipboard.writeText(find("setting").textContent));
}
find("loss")?.addEventListener("change", chooseLoss);
find("load").addEventListener("click", loadTable);
onTheme(drawAll);
drawAll();

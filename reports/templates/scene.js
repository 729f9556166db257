// The page of a scene: the replay, and charts over time that share its cursor.
async function drawAll() {
  for (const name of Object.keys(page.specs)) {
    const rows = ([run, { engine, label, t, v }]) => t.map((at, k) => ({ t: at, v: v[k], run, engine, label }));
    const lines = Object.entries(page.specs[name].usermeta.lines).flatMap(rows);
    const view = await draw(name, { ...page.specs[name], datasets: { lines } });
    if (!view) continue;
    view.signal("now", now).runAsync();
    view.addEventListener("click", (event) => {
      const x = view.scale("x").invert(vegaPoint(event, view));
      document.dispatchEvent(new CustomEvent("seek-time", { detail: Math.max(0, x) }));
    });
  }
}
function vegaPoint(event, view) {
  return event.clientX - view.container().getBoundingClientRect().left - view.origin()[0];
}
let now = 0;
let waiting = false;
document.addEventListener("shown-time", (event) => {
  now = event.detail.time;
  if (waiting) return;
  waiting = true;
  setTimeout(() => { waiting = false; for (const view of Object.values(views)) view.signal("now", now).runAsync(); }, 60);
});
onTheme(drawAll);
if (page.replay) startPlayer(document.getElementById("replay"), page.replay);
drawAll();

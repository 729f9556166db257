// Theme and charts: specifications hold colours as tokens ("@ink"); each theme has its own palette.
const page = JSON.parse(document.getElementById("data").textContent);
const views = {};
const root = document.documentElement;
function theme() { return root.dataset.theme || (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light"); }
function tinted(value) {
  const colours = page.palette[theme()];
  return JSON.parse(JSON.stringify(value).replace(/"@(\w+)"/g, (all, name) => JSON.stringify(colours[name] || all)));
}
function config() {
  return tinted({
    background: null, font: "system-ui, sans-serif", view: { stroke: null },
    axis: { labelColor: "@muted", titleColor: "@muted", gridColor: "@grid", labelFontSize: 11.5, titleFontSize: 11.5, titleFontWeight: "normal" },
    text: { color: "@ink" },
  });
}
async function draw(name, spec) {
  const place = document.querySelector(`[data-chart="${name}"]`);
  if (!place) return null;
  const shown = await vegaEmbed(place, tinted(spec), { actions: false, renderer: "svg", ast: true, config: config(), tooltip: { theme: theme() } });
  views[name] = shown.view;
  return shown.view;
}
function onTheme(redraw) {
  const button = document.getElementById("theme");
  // DataTables goes by a class
  const say = () => { button.textContent = theme() === "dark" ? "light" : "dark"; root.classList.toggle("dark", theme() === "dark"); };
  try { if (localStorage.theme) root.dataset.theme = localStorage.theme; } catch { /* files may have no storage */ }
  button.addEventListener("click", () => {
    root.dataset.theme = theme() === "dark" ? "light" : "dark";
    try { localStorage.theme = root.dataset.theme; } catch { /* as above */ }
    say();
    redraw();
  });
  say();
}

// what is wider than its card fades at the edge behind which there is more
function fade() { document.querySelectorAll(".scroll").forEach((one) => one.classList.toggle("more", one.scrollLeft + one.clientWidth < one.scrollWidth - 1)); }
const wider = new ResizeObserver(fade);
document.querySelectorAll(".scroll, .scroll > *").forEach((one) => wider.observe(one));
addEventListener("scroll", fade, { capture: true, passive: true });

async function unpack(id) {
  const bytes = Uint8Array.from(atob(document.getElementById(id).textContent), (sign) => sign.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
}

"""Shared by tests of report pages: a small run made by hand, expressions, and conditions of a page that is ready."""

import json
from pathlib import Path

import pytest

from reports import write_report
from runfiles import array_file
from tests.look.browser import Browser
from tests.reports.conftest import row, whole_run
from tests.reports.pages.reading import data_of
from tests.reports.recorded import recording, scene
from tests.reports.small_runs import FINE, MUJOCO, OURS, OVERLAP, SETTING, Part, write_all, write_study

SCENES = ("arm_wall", "hand_over_table")
LONG = 1300
"""States of the run made by hand: more than a page draws, so that a drawn state represents three."""
MARKUP = "<b>odd</b> & <img src=x onerror=alert(1)>"

SHOWN = "Number(document.getElementById('replay').dataset.frame)"
"""State that the replay shows."""
PIXELS = """
new Promise((done) => {
  window.dispatchEvent(new Event("resize"));
  // after the player's own drawing, within the same frame, while the picture still is there
  requestAnimationFrame(() => {
    const from = document.querySelector(".stage canvas"), pen = new OffscreenCanvas(from.width, from.height).getContext("2d");
    pen.drawImage(from, 0, 0);
    done(new Uint32Array(pen.getImageData(0, 0, from.width, from.height).data.buffer));
  });
})"""
COLOURS, PICTURE = f"{PIXELS}.then((all) => new Set(all).size)", f"{PIXELS}.then((all) => all.reduce((a, b) => (31 * a + b) | 0))"
"""Number of different colours of the player's canvas, and a number that depends on all its pixels."""
BLANK = """
[...document.querySelectorAll("[data-chart]")].filter((place) => {
  const svg = place.querySelector("svg"), box = svg && svg.getBoundingClientRect();
  const marks = svg ? svg.querySelectorAll(".role-mark path, .role-mark line, .role-mark rect, .role-mark text") : [];
  return !svg || box.width < 50 || box.height < 30 || !marks.length || !place.closest("[aria-label]")
      && !place.querySelector("[aria-label]");
}).map((place) => place.dataset.chart)
"""
"""Charts that are not drawn, or have no text in place of the picture."""
PAGE_IS_DRAWN = """
typeof page !== "undefined" && Object.keys(page.specs).every((name) => !document.querySelector(`[data-chart="${name}"]`)
    || views[name] && document.querySelector(`[data-chart="${name}"] svg`))
"""
DOT = """
(() => {
  const place = document.querySelector('[data-chart="overlap"]');
  place.scrollIntoView({ block: "center", behavior: "instant" });
  for (const dot of place.querySelectorAll("path")) {
    const box = dot.getBoundingClientRect(), at = [box.x + box.width / 2, box.y + box.height / 2];
    if (dot.__data__?.datum?.scene && document.elementFromPoint(...at) === dot) return [...at, dot.__data__.datum.scene];
  }
  return null;
})()
"""
"""Middle of a dot that nothing covers in the strip of overlaps [px], and its scene."""
DIMMED = """
STRIPS.map((name) => {
  const dots = [...document.querySelectorAll(`[data-chart="${name}"] path`)].filter((dot) => dot.__data__?.datum?.scene);
  return dots.every((dot) => (dot.__data__.opacity < 0.2) === (dot.__data__.datum.scene !== NEAR));
}).every(Boolean)
"""
"""True if in every strip the dots of scenes other than NEAR are dimmed, and only those."""
CONTROLS = """
[...document.querySelectorAll("a[href], button, select, input, summary, [tabindex='0']")].filter((one) => {
  return one.checkVisibility({ visibilityProperty: true }) && one.getBoundingClientRect().height && !one.disabled;
})
"""


def _aside(path: Path) -> None:
    """End all motion after half a second, with the ball in sight, and move the hand aside in states not drawn themselves."""
    arrays = array_file.read(path)
    for name in ("positions", "raw_positions"):
        arrays[name][30:] = arrays[name][29]
    arrays["positions"][500, 2, 0] += 0.037
    arrays["positions"][1001, 2, 1] += 0.4735
    with path.open("wb") as file:
        array_file.write(file, arrays)


def by_hand(folder: Path) -> Path:
    """Write a small run: recordings of two scenes, settings of both, and a figure whose name is markup."""
    folder.mkdir()
    data, runs, names = whole_run(), ("avatarsim/default", "mujoco/default", "mujoco/tuned", "pybullet/default"), SCENES
    assert isinstance(data["rows"], list)
    rows = [*data["rows"], row("arm_wall", "mujoco/tuned", MARKUP, 1.0, "m")]
    sinking, free = [0.0] * 9 + [0.01, 0.02] + [0.0] * (LONG - 11), [0.0] * LONG
    series = {run: {"overlap_m": free if run == runs[0] else sinking, "frame_time_us": []} for run in runs}
    (folder / "results.json").write_text(json.dumps(data | {"rows": rows, "series": dict.fromkeys(names, series)}))
    for name in names:
        scene(folder, name)
        for run in runs:
            recording(folder, name, run, states=LONG, sinks=run != runs[0])
            _aside(folder / "recordings" / f"{name}.{run.replace('/', '.')}.0.npz")
    write_all(folder)
    write_study(
        folder, "settings",
        Part("arm_wall", OURS, "", SETTING), Part("arm_wall", MUJOCO, "", {**SETTING, OVERLAP: 4e-3}),
        Part("arm_wall", MUJOCO, "tuned dt 1/1000", {**SETTING, "frame_time_p50": 70.0}, FINE),
        Part("hand_over_table", OURS, "", {**SETTING, OVERLAP: 2e-7}),
        Part("hand_over_table", MUJOCO, "", {**SETTING, "frame_time_p50": 33.0}),
    )
    write_report(folder)
    return folder


def show(one: Browser, page: Path, hash_: str = "") -> None:
    """Open a page and wait until its charts are drawn."""
    one.open(page, hash_)
    one.until(PAGE_IS_DRAWN)


def replayed(one: Browser, page: Path, hash_: str = "") -> None:
    """Open a page of a scene and wait until its replay has drawn a state; skip the test without WebGL."""
    show(one, page, hash_)
    one.until("['paused', 'no-webgl'].includes(document.getElementById('replay').dataset.state)")
    if one.value("document.getElementById('replay').dataset.state") == "no-webgl":
        pytest.skip("the browser offers no WebGL")
    one.until("document.getElementById('replay').dataset.frame !== undefined")


def quiet(one: Browser, page: Path) -> None:
    """Check that the console is empty, only the page's own address is requested, and nothing is wider than the window."""
    assert one.errors == []
    own = (page.resolve().as_uri(), *(f"{(folder / 'lib').as_uri()}/" for folder in page.resolve().parents[:2]), "data:", "blob:")
    assert [asked for asked in one.requests if not asked.startswith(own)] == []
    assert one.value("document.documentElement.scrollWidth <= window.innerWidth")


def states(page: Path) -> int:
    """Return the number of states that a page can show, 0 without a replay."""
    [data] = data_of(page)
    return len(data["replay"]["times"]) if data["replay"] else 0


def scenes(run: Path) -> list[Path]:
    """Return pages of scenes that can be played, at most three."""
    found = [page for page in sorted((run / "scenes").glob("*.html")) if states(page)]
    assert found
    return found[:3]


def shortest(run: Path) -> Path:
    """Return the page with the fewest states to draw, of those that have more than a few: each is drawn in software."""
    lengths = {page: count for page in sorted(run.glob("scenes/*.html")) if (count := states(page)) > 20}
    return min(lengths, key=lengths.__getitem__)


def choose(one: Browser, control: str, value: str) -> None:
    """Choose a value of a select."""
    one.value(f"""(() => {{ const box = document.getElementById({control!r}); box.value = {json.dumps(value)};
        box.dispatchEvent(new Event('change')); }})()""")

"""`python -m tests.look.pictures [RUN]`: the pictures of the README, taken from a run's report by a headless browser.

report.png is the top of index.html; strip.png shows one scene at a few instants, a row per engine, as its page plays it.
"""

import argparse
import base64
import html
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from reports import write_report
from tests.look.browser import Browser, browser

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "reports" / "pictures"
SCENE, RUNS = "mocap_punch_wall", ("avatarsim/default", "mujoco/default", "pybullet/default")
SHARES = (0.08, 0.22, 0.31, 0.42, 0.55)
"""Instants of the strip, as shares of the scene's length."""
TURNS = 7 * "d" + 4 * "s"
"""Keys that lead the eye round from where the page begins."""
REPORT = (1280, 1000)
CELL = (360, 270)
"""Size [px] of a view on the page; in the strip each takes NARROW."""
NARROW = 250


def views(one: Browser, page: Path, folder: Path) -> list[list[Path]]:
    """A picture of each engine's view at each instant: a row per engine."""
    one.open(page)
    one.until("document.getElementById('replay').dataset.frame !== undefined")
    names = one.value("JSON.parse(document.getElementById('replay-data').textContent).runs.map((run) => run.run)")
    wanted = [names.index(run) for run in RUNS if run in names]
    one.value(f"document.querySelector('.stage').style.gridTemplateColumns = 'repeat(3, {CELL[0]}px)'")
    for number in range(len(names)):
        if number not in wanted:
            one.value(f"document.querySelector('[data-view=\"{number}\"]').click()")
    # from where a fist in the wall is seen from the side
    for key in TURNS:
        one.value(f"document.body.dispatchEvent(new KeyboardEvent('keydown', {{key: '{key}', bubbles: true}}))")
    last = int(one.value("document.querySelector('[data-part=bar]').max"))
    step = float(one.value("JSON.parse(document.getElementById('replay-data').textContent).dt"))
    one.value("document.querySelector('.controls').style.display = 'none'")
    one.value("document.querySelector('.stage').scrollIntoView()")
    rows: list[list[Path]] = [[] for _ in wanted]
    for share in SHARES:
        frame = round(share * last)
        one.value(f"document.dispatchEvent(new CustomEvent('seek-time', {{detail: {frame * step}}}))")
        one.until(f"document.getElementById('replay').dataset.frame === '{frame}'")
        one.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        for row, number in enumerate(wanted):
            box = one.value(f"(() => {{ const box = document.querySelectorAll('.view')[{number}].getBoundingClientRect(); "
                            "return [box.x + scrollX, box.y + scrollY, box.width, box.height]; })()")
            place = folder / f"{row}-{frame}.png"
            one.picture(place, {"x": box[0], "y": box[1], "width": box[2], "height": box[3], "scale": NARROW / box[2]})
            rows[row].append(place)
    return rows


def strip(one: Browser, rows: Sequence[Sequence[Path]], folder: Path, to: Path) -> None:
    """All pictures as one, rows under each other."""
    def line(row: Sequence[Path]) -> str:
        return "".join(f'<img src="data:image/png;base64,{base64.b64encode(path.read_bytes()).decode()}">' for path in row)

    page = folder / "strip.html"
    style = "body{margin:0;background:#fff;display:inline-block}div{display:flex;gap:4px;margin-bottom:4px}img{display:block}"
    page.write_text(f"<!doctype html><title>{html.escape(to.name)}</title><style>{style}</style>"
                    + "".join(f"<div>{line(row)}</div>" for row in rows))
    one.open(page)
    box = one.value("[document.body.getBoundingClientRect().width, document.body.getBoundingClientRect().height]")
    one.picture(to, {"x": 0, "y": 0, "width": box[0], "height": box[1] - 4, "scale": 1})


def main(arguments: Sequence[str] | None = None) -> int:
    """Write both pictures. 0: done; 2: no browser, or a run without that scene."""
    parser = argparse.ArgumentParser(prog="python -m tests.look.pictures", description="The pictures of the README.")
    parser.add_argument("run", type=Path, nargs="?", default=ROOT / "reports" / "out" / "latest", help="folder of a run")
    chosen = parser.parse_args(arguments)
    write_report(chosen.run)
    page = chosen.run / "scenes" / f"{SCENE}.html"
    if not page.exists():
        print(f"no page of {SCENE} in {chosen.run}", file=sys.stderr)
        return 2
    FOLDER.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as name, browser(*REPORT) as one:
        strip(one, views(one, page, Path(name)), Path(name), FOLDER / "strip.png")
        one.open(chosen.run / "index.html")
        one.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        one.picture(FOLDER / "report.png")
    print("\n".join(str(path) for path in sorted(FOLDER.glob("*.png"))))
    return 0


if __name__ == "__main__":
    sys.exit(main())

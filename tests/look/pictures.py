"""`python -m tests.look.pictures [RUN]`: the pictures of the README, taken from a run's report by a headless browser.

report.png is the top of index.html; strip.png shows one scene at a few instants, a row per engine, as its page plays it;
moving.gif is the same scene as its page saves it. about.json names them, and the run, the commit and the day they are of.
`make headline` writes them together with the README's table.
"""

import argparse
import base64
import html
import json
import os
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from avatarsim.errors import AvatarsimError
from reports import write_report
from reports.summaries import readme
from reports.tables.run import read
from tests.look.browser import Browser, browser

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "reports" / "pictures"
SCENE, RUNS = "mocap_punch_wall", ("avatarsim/default", "mujoco/default", "pybullet/default")
SHARES = (0.08, 0.22, 0.31, 0.42, 0.55)
"""Instants of the strip, as shares of the scene's length."""
TURNS = 7 * "d" + 4 * "s"
"""Keys that lead the eye round from where the page begins."""
NEARER = 5 * "+"
"""Keys that bring the moving picture's eye nearer than one that holds the whole room: it has a quarter of the width."""
REPORT = (1280, 1000)
CELL = (360, 270)
"""Size [px] of a view on the page; in the strip each takes NARROW."""
NARROW = 250
MOVING, STRIP, REPORT_TOP, ABOUT = "moving.gif", "strip.png", "report.png", "about.json"
LARGEST, LARGEST_TOP = 500_000, 400_000
"""Bytes at most of the moving picture and of the top of the page: a README is read over slow lines too."""
SMALLER = ((240, 1.0), (200, 1.0), (200, 2.0), (170, 2.0), (140, 2.0))
"""(width of a view [px], speed) of the moving picture, tried in this order until it is small enough."""


def views(one: Browser, page: Path, folder: Path) -> list[list[Path]]:
    """A picture of each engine's view at each instant: a row per engine."""
    one.open(page)
    one.until("document.getElementById('replay').dataset.frame !== undefined")
    names = one.value("page.replay.runs.map((run) => run.run)")
    wanted = [names.index(run) for run in RUNS if run in names]
    one.value(f"document.querySelector('.stage').style.gridTemplateColumns = 'repeat(3, {CELL[0]}px)'")
    for number in range(len(names)):
        if number not in wanted:
            one.value(f"document.querySelector('[data-view=\"{number}\"]').click()")
    # from where a fist in the wall is seen from the side
    one.press(TURNS)
    last = int(one.value("document.querySelector('[data-part=bar]').max"))
    step = float(one.value("page.replay.dt"))
    one.value("document.querySelectorAll('.controls').forEach((one) => { one.style.display = 'none'; })")
    one.value("document.querySelector('.stage').scrollIntoView()")
    rows: list[list[Path]] = [[] for _ in wanted]
    for share in SHARES:
        frame = round(share * last)
        one.value(f"document.dispatchEvent(new CustomEvent('seek-time', {{detail: {frame * step}}}))")
        one.until(f"document.getElementById('replay').dataset.frame === '{frame}'")
        one.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        for row, number in enumerate(wanted):
            box = one.value(
                f"(() => {{ const box = document.querySelectorAll('.view')[{number}].getBoundingClientRect(); "
                "return [box.x + scrollX, box.y + scrollY, box.width, box.height]; })()"
            )
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
    page.write_text(
        f"<!doctype html><title>{html.escape(to.name)}</title><style>{style}</style>"
        + "".join(f"<div>{line(row)}</div>" for row in rows)
    )
    one.open(page)
    box = one.value("[document.body.getBoundingClientRect().width, document.body.getBoundingClientRect().height]")
    one.picture(to, {"x": 0, "y": 0, "width": box[0], "height": box[1] - 4, "scale": 1})


def moving(one: Browser, page: Path, folder: Path) -> Path:
    """The scene as its page saves it, a view per engine of RUNS side by side. RuntimeError when it stays too large."""
    one.downloads(folder)
    for width, speed in SMALLER:
        one.open(page)
        one.until("document.getElementById('replay').dataset.frame !== undefined")
        names = one.value("page.replay.runs.map((run) => run.run)")
        for number, name in enumerate(names):
            if name not in RUNS:
                one.value(f"document.querySelector('[data-view=\"{number}\"]').click()")
        columns = sum(name in RUNS for name in names)
        one.value(
            f"document.querySelector('.stage').style.cssText += ';width:{columns * width + 8 * (columns - 1)}px;"
            f"grid-template-columns:repeat({columns}, {width}px)'"
        )
        # from one place, so that what stands still need not be drawn again
        one.value("(() => { const box = document.querySelector('[data-part=follow]'); if (box.checked) box.click(); })()")
        one.press(TURNS + NEARER)
        one.value(f"""(() => {{ const box = document.querySelector('[data-part=speed]');
            box.value = '{speed:g}'; box.dispatchEvent(new Event('change')); }})()""")
        one.value("document.querySelector('[data-part=film]').click()")
        one.until("document.getElementById('replay').dataset.filmed !== undefined", patience=600.0)
        saved, size = folder / f"{page.stem}.gif", int(one.value("document.getElementById('replay').dataset.filmed"))
        until = time.monotonic() + 30.0
        while not saved.exists() and time.monotonic() < until:
            time.sleep(0.1)
        if size < LARGEST:
            return saved
        saved.unlink()
    raise RuntimeError(f"the moving picture of {page.stem} has {size:,} bytes at its smallest; at most {LARGEST:,} may be kept")


def about(run: Path) -> str:
    """What about.json holds."""
    told = readme.origin(read(run.resolve())) | {"scene": SCENE, "pictures": [REPORT_TOP, STRIP, MOVING]}
    return json.dumps(told, indent=1) + "\n"


def main(arguments: Sequence[str] | None = None) -> int:
    """Write all pictures, or none. 0: done; 2: no browser, no run, or a run without that scene."""
    parser = argparse.ArgumentParser(prog="python -m tests.look.pictures", description="The pictures of the README.")
    parser.add_argument("run", type=Path, nargs="?", default=ROOT / "reports" / "out" / "latest", help="folder of a run")
    chosen = parser.parse_args(arguments)
    page = chosen.run / "scenes" / f"{SCENE}.html"
    try:
        write_report(chosen.run)
        if not page.exists():
            raise RuntimeError(f"no page of {SCENE} in {chosen.run}")
        with tempfile.TemporaryDirectory() as name:
            folder, made = Path(name), Path(name) / "made"
            made.mkdir()
            with browser(*REPORT) as one:
                strip(one, views(one, page, folder), folder, made / STRIP)
                one.open(chosen.run / "index.html")
                one.until("Object.keys(page.specs).every((name) => views[name])")
                one.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
                one.picture(made / REPORT_TOP)
                (made / MOVING).write_bytes(moving(one, page, folder).read_bytes())
            if (size := (made / REPORT_TOP).stat().st_size) > LARGEST_TOP:
                raise RuntimeError(f"{REPORT_TOP} has {size:,} bytes; at most {LARGEST_TOP:,} may be kept")
            (made / ABOUT).write_text(about(chosen.run), encoding="utf-8")
            _replace(made)
    except (AvatarsimError, RuntimeError) as error:
        print(f"pictures: {error}", file=sys.stderr)
        return 2
    print("\n".join(str(path) for path in sorted(FOLDER.iterdir())))
    return 0


def _replace(made: Path) -> None:
    """Put the new pictures in the place of the old ones, about.json last."""
    FOLDER.mkdir(exist_ok=True)
    for name in (STRIP, REPORT_TOP, MOVING, ABOUT):
        half = FOLDER / f".{name}.part"
        half.write_bytes((made / name).read_bytes())
        os.replace(half, FOLDER / name)


if __name__ == "__main__":
    sys.exit(main())

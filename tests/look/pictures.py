"""`python -m tests.look.pictures [RUN]`: the pictures of the README, taken from a run's report by a headless browser.

strip.png shows one scene at a few instants, a row per engine, as its page plays it;
moving.gif is the same scene as its page saves it. about.json names them, with their run, commit and day.
`make headline` writes them together with the README's table.
"""

import argparse
import json
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from PIL import Image

from avatarsim.errors import AvatarsimError
from reports import write_report
from reports.summaries import readme
from reports.tables.run import read
from runfiles.engines import run_label
from runfiles.files import write_whole
from tests.look.browser import Browser, browser

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "reports" / "pictures"
SCENE, RUNS = "mocap_punch_wall", tuple(map(run_label, ("avatarsim/default", "mujoco/default", "pybullet/default")))
SHARES = (0.08, 0.22, 0.31, 0.42, 0.55)
"""Instants of the strip, as shares of the scene's length."""
TURNS = 7 * "d" + 4 * "s"
"""Keys that turn the eye from its first direction."""
NEARER = 5 * "+"
"""Keys that bring the moving picture's eye nearer than one that shows the whole room: it has a quarter of the width."""
REPORT = (1280, 1000)
CELL = (360, 270)
"""Size [px] of a view on the page; in the strip each takes NARROW."""
NARROW = 250
MOVING, STRIP, ABOUT = "moving.gif", "strip.png", "about.json"
LARGEST = 500_000
"""Largest size of the moving picture [bytes]: a README is read over slow lines too."""
SMALLER = ((240, 1.0), (200, 1.0), (200, 2.0), (170, 2.0), (140, 2.0))
"""(width of a view [px], speed) of the moving picture, tried in this order until it is small enough."""


def chosen(one: Browser, page: Path) -> list[int]:
    """Open a page, hide all views but those of RUNS, and return their numbers."""
    one.open(page)
    one.until("document.getElementById('replay').dataset.frame !== undefined")
    names = one.value("page.replay.views.map((view) => view.label)")
    for number, name in enumerate(names):
        if name not in RUNS:
            one.value(f"document.querySelector('[data-view=\"{number}\"]').click()")
    return [names.index(run) for run in RUNS if run in names]


def views(one: Browser, page: Path, folder: Path) -> list[list[Path]]:
    """Return a picture of each engine's view at each instant: a row per engine."""
    wanted = chosen(one, page)
    one.value(f"document.querySelector('.stage').style.cssText = 'display:grid;grid-template-columns:repeat(3, {CELL[0]}px)'")
    one.value(f"document.querySelectorAll('.picture').forEach((one) => {{ one.style.height = '{CELL[1]}px'; }})")
    # from a side view of the fist in the wall
    one.press(TURNS)
    last = int(one.value("document.querySelector('[data-part=bar]').max"))
    step = float(one.value("page.replay.times[1]"))
    one.value("document.querySelectorAll('.controls').forEach((one) => { one.style.display = 'none'; })")
    one.value("document.querySelector('.stage').scrollIntoView()")
    rows: list[list[Path]] = [[] for _ in wanted]
    for share in SHARES:
        frame = round(share * last)
        one.value(f"document.dispatchEvent(new CustomEvent('seek-time', {{detail: {frame * step}}}))")
        one.until(f"document.getElementById('replay').dataset.frame === '{frame}'")
        one.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        for row, number in enumerate(wanted):
            box = one.value(f"document.querySelectorAll('.view')[{number}].getBoundingClientRect().toJSON()")
            x, y = (box[axis] + one.value(f"scroll{axis.upper()}") for axis in "xy")
            place = folder / f"{row}-{frame}.png"
            one.picture(place, {"x": x, "y": y, "width": box["width"], "height": box["height"], "scale": NARROW / box["width"]})
            rows[row].append(place)
    return rows


def strip(rows: Sequence[Sequence[Path]], to: Path) -> None:
    """Save all pictures as one, rows under each other."""
    pictures = [[Image.open(path).convert("RGB") for path in row] for row in rows]
    wide, high = (max(picture.size[axis] for row in pictures for picture in row) + 4 for axis in (0, 1))
    whole = Image.new("RGB", (wide * len(pictures[0]), high * len(pictures) - 4), "white")
    for line, row in enumerate(pictures):
        for column, picture in enumerate(row):
            whole.paste(picture, (wide * column, high * line))
    whole.save(to, optimize=True)


def moving(one: Browser, page: Path, folder: Path) -> Path:
    """Return the scene as its page saves it, a view per engine of RUNS side by side. Raises RuntimeError if it is too large."""
    one.downloads(folder)
    for width, speed in SMALLER:
        columns = len(chosen(one, page))
        one.value(
            f"document.querySelector('.stage').style.cssText += ';width:{columns * width + 8 * (columns - 1)}px;"
            f"display:grid;grid-template-columns:repeat({columns}, {width}px)'"
        )
        one.value(f"""document.querySelectorAll('.picture').forEach((one) => {{ one.style.height = '{3 * width // 4}px';
            one.nextElementSibling.style.cssText = 'height:44px;min-height:0;overflow:hidden'; }})""")
        # from one place, so that resting bodies need not be drawn again
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


def main(arguments: Sequence[str] | None = None) -> int:
    """Write all pictures, or none. 0: done; 2: no browser, no run, or a run without that scene."""
    parser = argparse.ArgumentParser(prog="python -m tests.look.pictures", description="The pictures of the README.")
    parser.add_argument("run", type=Path, nargs="?", default=ROOT / "reports" / "out" / "latest", help="folder of a run")
    options = parser.parse_args(arguments)
    page = options.run / "scenes" / f"{SCENE}.html"
    try:
        write_report(options.run)
        if not page.exists():
            raise RuntimeError(f"no page of {SCENE} in {options.run}")
        with tempfile.TemporaryDirectory() as name:
            folder, made = Path(name), Path(name) / "made"
            made.mkdir()
            with browser(*REPORT) as one:
                strip(views(one, page, folder), made / STRIP)
                (made / MOVING).write_bytes(moving(one, page, folder).read_bytes())
            of = readme.origin(read(options.run.resolve())) | {"scene": SCENE, "pictures": [STRIP, MOVING]}
            (made / ABOUT).write_text(json.dumps(of, indent=1) + "\n")
            # about.json last
            for name in (STRIP, MOVING, ABOUT):
                write_whole(FOLDER / name, lambda file, name=name: file.write((made / name).read_bytes()))  # type: ignore[misc]
    except (AvatarsimError, RuntimeError) as error:
        print(f"pictures: {error}", file=sys.stderr)
        return 2
    print("\n".join(str(path) for path in sorted(FOLDER.iterdir())))
    return 0


if __name__ == "__main__":
    sys.exit(main())

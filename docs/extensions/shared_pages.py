"""Pages of the site that play a drive, made while it is built, of sessions that scripts drive and record, the same each time.

A page is the output of *Share* in `avatarsim live`: one file that needs no network, no server and no Python.
"""

import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

from avatarsim.engine import Settings
from avatarsim.live.drive.driver import Driver
from avatarsim.live.messages import Command, Order, Plan
from avatarsim.live.orders import World
from avatarsim.live.recording import ENGINE, Recorder
from avatarsim.live.show import recording_page
from avatarsim.live.stages import stage
from avatarsim.scene.checks import Vector

FOLDER = "live"
"""Folder of the pages, next to live.md."""
RATE = 60.0
"""[1/s] frames of a drive."""
REPEAT = 6
"""Frames between two repeats of a key that is held: 10 a second, as a keyboard does."""
LARGEST = 1_500_000
"""Bytes of a page at most: a reader on a slow line waits for all of them."""


class Drive:
    """A stage that a script drives, and its recording at `path`."""

    def __init__(self, name: str, path: Path) -> None:
        self._world = World(Plan(ENGINE, stage(name).scene, Settings(), RATE))
        self._driver = Driver(self._world.scene)
        self.log = Recorder(path, self._world.plan, self._world.shown.state_hash())

    def drag(self, link: str, place: Vector, frames: int) -> None:
        """Pull a link to a place [m] for some frames, and let go of it."""
        self._driver.drag(link, place)
        self._pass(frames)
        self._driver.release(link)

    def press(self, key: str, frames: int) -> None:
        """Hold a key for some frames."""
        for _ in range(0, frames, REPEAT):
            self._driver.press(key)
            self._pass(REPEAT)

    def take(self) -> None:
        """Take the objects that the avatar touches, or let go. Raises ExtensionError where there is nothing to take."""
        command = Command(Order.TAKE)
        if refused := self._world.apply(command):
            raise ExtensionError(refused)
        self.log.command(command)

    def _pass(self, frames: int) -> None:
        for _ in range(frames):
            sample = self._driver.tick(1.0 / RATE)
            self.log.frame(sample, self._world.advance(sample).state_hash())


def hand(drive: Drive) -> None:
    """Press a hand into the table, over it against the wall, and up."""
    for place, frames in (((-0.05, 0.0, 0.68), 80), ((0.5, 0.1, 0.7), 120), ((0.5, 0.0, 0.9), 60), ((0.1, 0.0, 1.0), 60)):
        drive.drag("hand/palm", place, frames)


def mug(drive: Drive) -> None:
    """Take a mug, carry it over the tower, put it down and let go."""
    drive.drag("hand/palm", (0.03, -0.05, 0.86), 60)
    drive.take()
    drive.drag("hand/palm", (0.0, 0.0, 1.15), 80)
    drive.drag("hand/palm", (0.1, -0.1, 0.85), 80)
    drive.take()
    drive.drag("hand/palm", (-0.1, 0.0, 1.0), 60)


def toys(drive: Drive) -> None:
    """Knock over a row of dominoes, then a tower."""
    for place, frames in (((-0.24, -0.28, 0.8), 50), ((-0.1, -0.28, 0.8), 90), ((-0.1, 0.0, 1.0), 40), ((0.02, 0.1, 0.9), 40),
                          ((0.05, 0.4, 0.88), 100)):
        drive.drag("hand/palm", place, frames)


def door(drive: Drive) -> None:
    """Walk through a door and on to the next room."""
    drive.press("i", 330)


def humanoid(drive: Drive) -> None:
    """Step aside into boxes, then reach down through a box and up."""
    drive.press("l", 90)
    drive.drag("human/right_hand", (-1.0, -0.9, 0.2), 150)
    drive.drag("human/right_hand", (-1.2, -0.5, 1.6), 90)


DRIVES: Mapping[str, tuple[str, str, Callable[[Drive], None]]] = {
    "hand": ("a hand that is pressed into a table", "hand", hand),
    "mug": ("a mug that is lifted and put down", "toys", mug),
    "toys": ("dominoes and a tower", "toys", toys),
    "door": ("a door in a house", "house", door),
    "humanoid": ("a humanoid among boxes", "gallery", humanoid),
}
"""Title, stage and script of each page, by the name of its file."""


def links() -> str:
    """Return the list of the pages. They are not there yet when Sphinx looks for a link's target, so that it is HTML."""
    return "\n".join(f'- <a href="{FOLDER}/{name}.html">{title}</a>' for name, (title, _, _) in DRIVES.items())


def write(folder: Path) -> None:
    """Drive, record and write all pages. Raises ExtensionError for one that is too large."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as logs:
        for name, (_, where, script) in DRIVES.items():
            path = Path(logs) / f"{name}.live"
            drive = Drive(where, path)
            script(drive)
            drive.log.close()
            page = recording_page(path)
            if len(page) > LARGEST:
                raise ExtensionError(f"page {name}.html has {len(page)} bytes, at most {LARGEST} may be")
            (folder / f"{name}.html").write_bytes(page)


def finished(app: Sphinx, error: Exception | None) -> None:
    """Called by Sphinx when the pages are written."""
    if error is None and app.builder.format == "html":
        write(Path(app.outdir) / "docs" / FOLDER)


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    # before `no_request` looks at all pages
    app.connect("build-finished", finished, priority=400)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

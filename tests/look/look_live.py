"""The live page in a browser: it comes up at once and requests nothing beyond its own address; a hand that is dragged through
table and wall never overlaps by the judge; switches, keys and recordings work as labelled.

Not part of `make test`, which needs no browser: `make look` runs it, and leaves screenshots in reports/out/look/ to inspect.
"""

import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from avatarsim.engine import Settings, Snapshot
from avatarsim.live.drive.driver import Driver
from avatarsim.live.drive.keys import KEYS
from avatarsim.live.messages import Order, Plan, State
from avatarsim.live.recording import ENGINE, read
from avatarsim.live.replaying import replay
from avatarsim.live.session import Session
from avatarsim.live.stages import stage
from avatarsim.live.view import share
from avatarsim.live.view.depth import own_depth
from avatarsim.live.view.page import Page, Shows
from avatarsim.spatial import rotation
from reference.judging.judge import Judge
from scenarios.live import installed
from tests.look.browser import Browser, browser
from tests.look.conftest import SCREENSHOTS

WARM = 5.0
"""[s] in which the page has to appear."""
OF_LIBRARIES = ("THREE.Clock", "preventDefault inside passive", "Software WebGL")
"""Console messages of viser's own page, which are ignored."""
HUD = "!!document.querySelector('[data-overlap]')"
RED = (80, 40)
"""Least excess of a pixel's red over its green and blue, and largest difference of these: overlapping parts and the ghost, in
light and in shade."""
COVERED = """(() => {
  const boxes = (which) => [...document.querySelectorAll(which)].map((each) => each.getBoundingClientRect());
  const over = boxes("#root .mantine-Paper-root, .mantine-Notification-root");
  return boxes("[data-overlap]").map((a) => a.width === 0 || a.left < 0 || a.right > innerWidth
    || over.some((b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom));
})()"""
"""Flags: each number over the scene is hidden, or lies under the panel or a notice."""
DRAWER = "document.querySelector('[aria-hidden] .overlaps').closest('[aria-hidden]').ariaHidden"
PATIENCE = 10.0


class Running:
    """A live page of a built-in stage, its rounds in a thread of their own."""

    def __init__(self, name: str, folder: Path, dark: bool = False, offered: Sequence[Plan] = ()) -> None:
        found = stage(name)
        self.session = Session([Plan(ENGINE, found.scene, Settings(time_stages=True), 60.0)])
        shows = Shows(found, {}, own_depth(found.scene), port=0, dark=dark, folder=folder, offered=offered)
        self.page = Page(self.session, Driver(found.scene), shows)
        self._is_over = False
        self._thread = threading.Thread(target=lambda: self.page.rounds(lambda: self._is_over))
        self._thread.start()

    @property
    def state(self) -> State:
        """Newest shown state."""
        state = self.session.first.state
        assert state is not None
        return state

    def wait(self, frames: int) -> State:
        """Return the state so many frames later."""
        first, end = self.state.frame, time.monotonic() + PATIENCE
        while self.state.frame < first + frames and time.monotonic() < end:
            time.sleep(0.01)
        assert self.state.frame >= first + frames
        return self.state

    def on_screen(self, point: np.ndarray) -> tuple[float, float]:
        """Return where a point of the world [m] is in the first browser's window [px]."""
        end = time.monotonic() + PATIENCE
        while not self.page.server.get_clients() and time.monotonic() < end:
            time.sleep(0.05)
        camera = next(iter(self.page.server.get_clients().values())).camera
        x, y, z = rotation.rotate(rotation.conjugate(np.asarray(camera.wxyz)), point - np.asarray(camera.position))
        half = 0.5 * camera.image_height / np.tan(0.5 * camera.fov)
        return 0.5 * camera.image_width + half * x / z, 0.5 * camera.image_height + half * y / z

    def __enter__(self) -> "Running":
        return self

    def __exit__(self, *error: object) -> None:
        self._is_over = True
        self._thread.join()
        self.page.close()
        self.session.close()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of saved recordings."""
    return tmp_path_factory.mktemp("live")


@pytest.fixture(scope="module")
def running(folder: Path) -> Iterator[Running]:
    """Yield the running page of the hand over the table."""
    with Running("hand", folder) as one:
        yield one


@pytest.fixture(scope="module")
def seen(running: Running) -> Iterator[Browser]:
    """Yield a browser that shows it."""
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    with browser(1400, 900) as one:
        begun = time.monotonic()
        one.visit(running.page.address)
        one.until(HUD)
        took = time.monotonic() - begun
        assert took <= WARM, f"the page took {took:.1f} s"
        yield one


@contextmanager
def window_on(running: Running, size: tuple[int, int], rest: float = 0.0, saves: Path | None = None) -> Iterator[Browser]:
    """Yield another browser that shows a page, some time [s] after it came up; its files go into the folder `saves`."""
    with browser(*size) as one:
        if saves is not None:
            one.downloads(saves)
        one.visit(running.page.address)
        one.until(HUD)
        time.sleep(rest)
        yield one


def quiet(one: Browser, running: Running) -> None:
    """Check that the console has no message of ours, and only the page's own address is requested."""
    assert [error for error in one.errors if not any(known in error for known in OF_LIBRARIES)] == []
    own = (running.page.address, running.page.address.replace("http", "ws"), "data:", "blob:")
    assert [address for address in one.requests if not address.startswith(own)] == []


def drag(one: Browser, running: Running, name: str, way: tuple[float, float], steps: int = 12) -> None:
    """Drag a link over the window by so many pixels."""
    x, y = running.on_screen(running.state.positions[running.session.scene.names.index(name)])
    one.mouse("Moved", x, y, is_down=False)
    one.mouse("Pressed", x, y)
    for k in range(1, steps + 1):
        one.mouse("Moved", x + way[0] * k / steps, y + way[1] * k / steps)
        time.sleep(0.05)
    time.sleep(0.5)


def inside(one: Browser) -> list[float]:
    """Return the overlaps over the scene [mm]: the user's own, and each engine's."""
    found = one.value("[...document.querySelectorAll('[data-overlap]')].map(each => each.dataset.overlap)")
    return [float(each) for each in found]


def red(one: Browser, place: Path) -> np.ndarray:
    """Take a screenshot, and return which pixels of the scene, below the numbers, are red (height, width)."""
    one.picture(place)
    pixels = np.asarray(Image.open(place).convert("RGB")).astype(int)[80:]
    colours = pixels[..., 1:]
    return (pixels[..., 0] - colours.max(axis=2) >= RED[0]) & (np.ptp(colours, axis=2) <= RED[1])


def test_effects_switch_between_two_frames(running: Running, seen: Browser) -> None:
    time.sleep(2.0)
    seen.picture(SCREENSHOTS / "live-hand-light-1400.png")
    seen.click("Effects and method")
    for off in (("friction",), ()):
        frame = running.state.frame
        seen.click("friction")
        end = time.monotonic() + PATIENCE
        while running.page.panel.off != off and time.monotonic() < end:
            time.sleep(0.1)
        assert running.page.panel.off == off and running.wait(30).frame > frame
        seen.picture(SCREENSHOTS / "live-hand-effects.png")
    quiet(seen, running)


def test_a_hand_dragged_through_table_and_wall_never_overlaps(running: Running, seen: Browser, folder: Path) -> None:
    running.page.post(lambda: (running.session.command(Order.RESET), None)[1])
    running.page.post(running.page.driver.reset)
    running.wait(10)
    root = running.session.scene.avatars[0].links[0].name
    names = running.session.scene.names
    link = next(name for name in running.page.driver.links if name.endswith(root))
    before = running.state.positions[names.index(link)].copy()
    assert red(seen, SCREENSHOTS / "live-hand-free.png").sum() == 0
    drag(seen, running, link, (0.0, 400.0))
    held = running.state
    assert np.linalg.norm(held.positions[names.index(link)] - before) > 0.05
    you, shown = inside(seen)
    assert you > 1.0 and shown == 0.0
    assert red(seen, SCREENSHOTS / "live-hand-pressed.png").sum() > 500
    seen.mouse("Released", 700.0, 600.0)
    drag(seen, running, link, (260.0, -120.0))
    seen.mouse("Released", 900.0, 300.0)
    running.wait(30)
    saved = list(folder.glob("*.live"))
    seen.click("Save recording")
    seen.until("document.body.innerText.includes('Saved as')")
    (path,) = set(folder.glob("*.live")) - set(saved)
    found = read(path)
    states = list[Snapshot]()
    done = replay(found, lambda frame, record: states.append(record.shown))
    assert done.difference is None and done.frames == len(states) > 60
    places, turns = (np.array([getattr(one, name) for one in states]) for name in ("positions", "orientations"))
    assert Judge(found.plan.scene).deepest(places, turns) <= 1e-6
    quiet(seen, running)


def viewed(running: Running) -> np.ndarray:
    """Return the place and direction of the camera of the first browser, once they are still."""
    camera = next(iter(running.page.server.get_clients().values())).camera
    last, end = np.zeros(6), time.monotonic() + PATIENCE
    while time.monotonic() < end:
        time.sleep(0.5)
        now = np.concatenate([camera.position, camera.look_at])
        if np.array_equal(now, last):
            return now
        last = now
    raise AssertionError("the camera does not come to rest")


def test_keys_move_the_hand_and_no_camera(running: Running, seen: Browser) -> None:
    root = len(running.session.scene.bodies)
    place = running.wait(5).positions[root].copy()
    seen.mouse("Moved", 300.0, 600.0, is_down=False)
    for _ in range(10):
        seen.key("i", 0.05)
    assert np.linalg.norm(running.wait(10).positions[root] - place) > 0.01
    before = viewed(running)
    for key in KEYS:
        seen.key(key.key, 0.3)
        assert viewed(running) == pytest.approx(before, abs=1e-6), key.key


@pytest.mark.parametrize("way", ["button", "key"])
def test_home_brings_a_camera_back_that_flew_away(running: Running, seen: Browser, way: str) -> None:
    camera = running.page.worlds.camera("Home")
    seen.mouse("Moved", 300.0, 600.0, is_down=False)
    for key in ("s", "d", "ArrowUp"):
        seen.key(key, 1.0)
    assert np.linalg.norm(viewed(running)[:3] - camera.position) > 0.5
    seen.click("Home") if way == "button" else seen.key("Home", 0.05)
    assert viewed(running) == pytest.approx(np.array([*camera.position, *camera.look_at]), abs=1e-3)


def test_a_human_pushes_a_door_open_and_the_lift_rises(folder: Path) -> None:
    with Running("house", folder) as one, window_on(one, (1400, 900), 4.0) as window:
        window.picture(SCREENSHOTS / "live-house-start.png")

        # not by the browser's keys, which wait for each picture that it draws without a graphics card
        def press(key: str) -> None:
            one.page.post(lambda: one.page.driver.press(key))
            time.sleep(0.1)

        root, lift = len(one.session.scene.bodies), one.session.scene.names.index("lift")
        end = time.monotonic() + 30.0
        while one.state.positions[root][0] < 0.9 and time.monotonic() < end:
            press("i")
        assert abs(one.state.angles[-1]) > 1.0
        for _ in range(30):
            press("y")
        assert one.state.positions[lift][2] > 0.3
        window.picture(SCREENSHOTS / "live-house-through.png")
        # nothing loose is near, and the page reports it
        window.key("c", 0.1)
        window.until("document.body.innerText.includes('nothing loose')")
        quiet(window, one)


def test_the_same_drag_beside_in_mujoco_is_red_there(folder: Path) -> None:
    offered = [plan for plan in installed(stage("hand").scene, 60.0) if plan.name == "mujoco/default"]
    with Running("hand", folder, offered=offered) as one, window_on(one, (1000, 700), 4.0) as window:
        window.click("mujoco/default")
        window.until("document.querySelectorAll('[data-overlap]').length === 3", 120.0)
        time.sleep(4.0)
        drag(window, one, "hand/palm", (5.0, 120.0))
        _, shown, other = inside(window)
        assert shown == 0.0 and other > 0.1
        found = red(window, SCREENSHOTS / "live-split.png")
        middle = round(one.on_screen(one.page.worlds.camera("Home").look_at)[0])
        assert found[:, middle:].sum() > 200
        quiet(window, one)


def test_the_last_seconds_are_an_offline_page(running: Running, folder: Path) -> None:
    running.page.post(lambda: running.page.driver.drag("hand/palm", (-0.05, 0.0, 0.74)))
    with window_on(running, (1000, 800), 3.0, folder):
        running.page.share(list(running.page.server.get_clients().values())[-1])
        end = time.monotonic() + 60.0
        while not (pages := list(folder.glob("*.html"))) and time.monotonic() < end:
            time.sleep(0.2)
        [page] = pages
        time.sleep(1.0)
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    with browser(1000, 800) as other:
        other.open(page)
        other.until("document.getElementById('replay').dataset.state === 'paused'")
        other.click("Play")
        other.until("Number(document.getElementById('replay').dataset.frame) > 5")
        other.picture(SCREENSHOTS / "live-shared.png")
        assert other.errors == [] and [one for one in other.requests if not one.startswith(("file:", "data:", "blob:"))] == []


def test_six_seconds_are_recorded_of_a_slow_browser_too(running: Running, folder: Path) -> None:
    with window_on(running, (500, 400), saves=folder):
        client = list(running.page.server.get_clients().values())[-1]
        running.page.film(client)
        end = time.monotonic() + 1.5 * share.PATIENCE
        while not (made := list(folder.glob("*.gif"))) and time.monotonic() < end:
            # equal pictures are one in a file, so the hand keeps moving
            place = 0.1 * np.cos(time.monotonic()), 0.0, 0.9
            running.page.post(partial(running.page.driver.drag, "hand/palm", place))
            time.sleep(0.2)
        [path] = made
        time.sleep(1.0)
    picture: Any = Image.open(path)
    with picture as film:
        assert film.n_frames >= 2 and film.size == share.PICTURE[::-1]


@pytest.mark.parametrize(("name", "dark"), [("hand", True), ("gallery", False), ("gallery", True)])
def test_all_stages_come_up_light_and_dark(name: str, dark: bool, folder: Path) -> None:
    with Running(name, folder, dark) as one:
        for width, height in ((1400, 900), (390, 844)):
            # the scene fades in
            with window_on(one, (width, height), 4.0) as window:
                assert window.value("document.documentElement.scrollWidth <= window.innerWidth")
                shade = "dark" if dark else "light"
                window.picture(SCREENSHOTS / f"live-{name}-{shade}-{width}.png")
                quiet(window, one)


@pytest.mark.parametrize("size", [(390, 844), (800, 700), (980, 640), (1400, 900)], ids=lambda size: str(size[0]))
def test_numbers_are_never_covered_and_a_phone_begins_closed(running: Running, size: tuple[int, int]) -> None:
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    with window_on(running, size) as one:
        # viser's own notice comes
        one.until("!!document.querySelector('.mantine-Notification-root')")
        time.sleep(1.0)
        assert not any(one.value(COVERED))
        one.picture(SCREENSHOTS / f"live-numbers-{size[0]}.png")
        if size[0] < 576:
            for hidden in ("true", "false"):
                assert one.value(DRAWER) == hidden
                one.value("document.querySelector('[aria-hidden] .overlaps').closest('[aria-hidden]').previousSibling.click()")
                time.sleep(1.0)
                assert not any(one.value(COVERED))

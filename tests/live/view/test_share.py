"""A drive as a page, and a window for the user's own loop."""

import io
import json
import re
import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image, ImageSequence

pytest.importorskip("viser")

from avatarsim.errors import AvatarsimError, InvalidFile, InvalidInput, InvalidSample
from avatarsim.live.recording import Recorder
from avatarsim.live.show import show
from avatarsim.live.view import share
from avatarsim.simulator import AvatarsimEngine
from tests.live.small import RATE, plan, pushed, scene

FRAMES = 120


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a recording of an arm that is pushed into a table."""
    path, ran, engine = tmp_path_factory.mktemp("share") / "a.live", plan(), AvatarsimEngine()
    first = engine.load(ran.scene, ran.settings, 1.0 / RATE)
    log = Recorder(path, ran, first.state_hash())
    for frame in range(FRAMES):
        log.frame(pushed(frame), engine.advance(pushed(frame), 1.0 / RATE).state_hash())
    log.close()
    return path


def test_a_recording_becomes_a_page_that_marks_its_deepest(recording: Path) -> None:
    page = show(recording, opens_browser=False)
    text = page.read_text(encoding="utf-8")
    assert not re.findall(r'(?:src|href)="(?!#|data:)', text)
    [found] = re.findall(r'<script type="application/json" id="take">(.*?)</script>', text, re.DOTALL)
    take = json.loads(found)
    # the way out of the table: up, or down through its thickness of 0.1 m
    heights = [pushed(frame).positions[0, 2] for frame in range(0, FRAMES, 2)]
    depths = [min(0.015 - z, z + 0.115) for z in heights]
    [worst] = [one for one in take["views"][0]["moments"] if one["is_worst"]]
    assert depths[worst["state"]] > 0.0 and take["opens"] == worst["state"]
    assert len(take["times"]) == FRAMES // 2 and len(take["ghost"]["bodies"]) == 2


def films(monkeypatch: pytest.MonkeyPatch, each: float, patience: float, count: int | None = None) -> tuple[Any, list[str]]:
    """Return half a second of a viewer that takes some time [s] for each picture, of `count` at most, and lines of progress."""
    taken, lines = list[int](), list[str]()

    def render(height: int, width: int, timeout: float) -> np.ndarray:
        time.sleep(min(each, timeout))
        if each > timeout or len(taken) == count:
            raise TimeoutError
        taken.append(len(taken))
        return np.full((height, width, 3), 20 * len(taken) % 250, dtype=np.uint8)

    monkeypatch.setattr(share, "PATIENCE", patience)
    viewer: Any = SimpleNamespace(get_render=render)
    return Image.open(io.BytesIO(share.filmed(viewer, lines.append, 0.5))), lines


@pytest.mark.parametrize(("each", "patience", "least"), [(0.0, 60.0, 2), (0.3, 60.0, share.FEWEST), (0.3, 1.0, 2)])
def test_a_film_lasts_as_long_as_asked_for_of_a_slow_viewer_too(
    monkeypatch: pytest.MonkeyPatch, each: float, patience: float, least: int
) -> None:
    film, lines = films(monkeypatch, each, patience)
    lasts = sum(frame.info["duration"] for frame in ImageSequence.Iterator(film))
    assert film.n_frames == len(lines) >= least and lasts == pytest.approx(500.0, abs=150.0)


def test_one_picture_alone_is_no_film(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InvalidInput):
        films(monkeypatch, 0.0, 60.0, count=2)


def test_what_is_no_recording_and_no_engine_is_refused(tmp_path: Path) -> None:
    (tmp_path / "b.live").write_bytes(b"nothing")
    with pytest.raises(InvalidFile):
        show(tmp_path / "b.live", opens_browser=False)
    with pytest.raises(InvalidInput):
        show(3.0, opens_browser=False)  # type: ignore[call-overload]
    with pytest.raises(AvatarsimError):
        show(AvatarsimEngine(), port=0, opens_browser=False)


def test_a_window_shows_the_users_own_loop() -> None:
    ran, engine = plan(), AvatarsimEngine()
    engine.load(ran.scene, ran.settings, 1.0 / RATE)
    with show(engine, port=0, opens_browser=False) as window:
        window.server.gui.add_button("mine")
        for frame in range(60):
            record = engine.advance(pushed(frame), 1.0 / RATE)
            window.sync(record, pushed(frame))
        shown = window.server.scene.get_handle_by_name("/avatarsim/arm/palm")
        assert shown is not None and window.address.startswith("http://127.0.0.1:")
        with pytest.raises(InvalidSample):
            window.sync_now(record, replace(pushed(0), angles=np.zeros(7)))
        window.sync_now(record, pushed(0))
        assert np.asarray(shown.position) == pytest.approx(record.shown.positions[len(scene().bodies)], abs=1e-6)

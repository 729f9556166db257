"""`docs/live_ports.md`: its tracker leads the palm of the default scene in a circle, its messages are taken, its blocks run."""

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import avatarsim as av
from avatarsim.cli.live import SCENE
from avatarsim.live.drive.driver import Driver
from avatarsim.live.ports.admission import Limits
from avatarsim.live.ports.protocol import Goals, Shape, parse
from avatarsim.live.ports.server import Ports
from avatarsim.live.stages import stage
from avatarsim.live.view.page import Page
from tests.live.ports.opened import scene, state, until

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "live_ports.md").read_text(encoding="utf-8")
TRACKER, OWN = re.findall(r"^```python\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
RADIUS = 0.2
"""[m] of the circle that the page promises."""


def test_the_tracker_leads_the_default_palm_in_a_circle(capsys: pytest.CaptureFixture[str]) -> None:
    found, targets, shown = stage(SCENE).scene, list[Goals](), list[np.ndarray]()
    palm, refused = found.names.index("hand/palm"), list[str]()
    page: Any = SimpleNamespace(driver=Driver(found), _tracked=set())
    with (
        av.AvatarsimEngine() as engine,
        Ports(found, lambda goals, *_: targets.append(goals), ws_port=None, limits=Limits(per_second=10**6),
              on_refusal=lambda source, reason: refused.append(reason)) as ports,
    ):
        engine.load(found, av.Settings(), dt=1.0 / 60.0)

        def pause(seconds: float) -> None:
            # the block's pause is a frame of the scene
            until(lambda: targets or refused)
            assert not refused and seconds == 1.0 / 60.0
            Page._by_tracker(page, targets.pop())
            shown.append(engine.advance(page.driver.tick(1.0 / 60.0), dt=1.0 / 60.0).shown.positions[palm])

        names: dict[str, Any] = {"pause": pause}
        try:
            exec(TRACKER.replace("9870", str(ports.addresses["udp"][1])).replace("time.sleep", "pause"), names)
        finally:
            names["port"].close()
    assert capsys.readouterr().out.split() == ['{"taken":', "1}"]
    # the first second is the way to the circle
    path = np.array(shown)[60:]
    offset = path - (path.max(axis=0) + path.min(axis=0)) / 2.0
    assert len(path) == 1140 and np.hypot(offset[:, 0], offset[:, 1]) == pytest.approx(RADIUS, abs=1e-3)
    assert np.abs(offset[:, 2]).max() < 1e-3
    turned = np.unwrap(np.arctan2(offset[:, 1], offset[:, 0]))
    assert turned[-1] - turned[0] == pytest.approx(2.0 * np.pi * 1139 / 240, abs=0.05)


def test_the_goals_are_those_of_links_of_the_gallery() -> None:
    [goals] = re.findall(r'^\{"links".*\}$', PAGE, re.MULTILINE)
    found = parse(goals.encode(), Shape.of(stage("gallery").scene))
    assert isinstance(found, Goals) and set(found.links) == {"human/left_wrist", "human/head"}


def test_the_block_for_a_program_of_ones_own_runs(capsys: pytest.CaptureFixture[str]) -> None:
    assert OWN.count("9870") == OWN.count("9871") == 1
    exec(OWN.replace("9870", "0").replace("9871", "0"), {"scene": scene(), "state": state(1)})
    assert len(capsys.readouterr().out.splitlines()) == 2

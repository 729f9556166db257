"""`docs/adding.md`: the scene that it shows is a scenario whose every part the harness takes, and which does what it says."""

import re
from pathlib import Path
from typing import Any

import numpy as np

from avatarsim.engine import Settings
from avatarsim.scene.tracker import checked
from avatarsim.simulator import AvatarsimEngine
from runfiles.metrics import METRICS
from scenarios.scenario import Scenario

PAGE = (Path(__file__).parents[2] / "docs" / "adding.md").read_text(encoding="utf-8")


def shown() -> Scenario:
    """The scenario of the page's Python block."""
    (code,) = re.findall(r"^```python\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    names: dict[str, Any] = {}
    exec(code, names)
    scenario = names["SCENARIO"]
    assert isinstance(scenario, Scenario)
    return scenario


def test_its_bounds_are_on_metrics_that_exist() -> None:
    assert {bound.metric for bound in shown().bounds} <= set(METRICS)


def test_its_hand_stops_on_top_of_the_table_and_its_user_does_not() -> None:
    scenario = shown()
    scene = scenario.build()
    samples = scenario.motion(scene, 0)
    with AvatarsimEngine() as engine:
        record = engine.load(scene, Settings(), scenario.dt)
        np.testing.assert_array_equal(record.shown.positions[1], scene.first_sample.positions[0])
        for frame in range(scenario.frames):
            record = engine.advance(checked(samples(frame), scene.avatars), scenario.dt)
    assert samples(scenario.frames - 1).positions[0, 2] < 0.0
    np.testing.assert_allclose(record.shown.positions[1], [0.0, 0.0, 0.025 + 0.04 + 2e-4], atol=1e-9)

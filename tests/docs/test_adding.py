"""`docs/adding.md`: its scene is a scenario whose every part the harness takes, and which behaves as the page describes."""

import re
from pathlib import Path
from typing import Any

import numpy as np

from avatarsim.engine import FrameRecord, Settings
from avatarsim.simulator import AvatarsimEngine
from scenarios.job import Job, Outcome
from scenarios.measure.everything import measured
from scenarios.run.accuracy import Prepared, gathered
from scenarios.run.gate import exit_code, rows_of
from scenarios.scenario import Scenario
from tests.scenarios.scene_rules import begins_free_where_its_regions_allow, moves_soundly, says_what_it_is_and_what_must_hold

PAGE = (Path(__file__).parents[2] / "docs" / "adding.md").read_text(encoding="utf-8")


def shown() -> Scenario:
    """Return the scenario of the page's Python block."""
    (code,) = re.findall(r"^```python\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    names: dict[str, Any] = {}
    exec(code, names)
    scenario = names["SCENARIO"]
    assert isinstance(scenario, Scenario)
    return scenario


def recorded(scenario: Scenario) -> tuple[list[FrameRecord], Prepared]:
    """Return every frame that the engine shows of the scenario, and its input."""
    scene = scenario.build()
    asked = Prepared(scenario, scene, scenario.motion(scene, 0))
    with AvatarsimEngine() as engine:
        frames = [engine.load(scene, Settings(record_inside=True), scenario.dt)]
        frames += [engine.advance(sample, scenario.dt) for sample in asked.samples]
    return frames, asked


def test_it_keeps_every_rule_of_the_catalogue() -> None:
    scenario = shown()
    says_what_it_is_and_what_must_hold(scenario)
    begins_free_where_its_regions_allow(scenario)
    moves_soundly(scenario)


def test_each_of_its_bounds_is_measured_and_holds_at_the_gate() -> None:
    scenario = shown()
    frames, asked = recorded(scenario)
    job = Job(scenario.name, "avatarsim", "default")
    found = measured(gathered(job, scenario, asked.scene, asked.states, frames, {}, asked.raw), asked.known)
    rows = rows_of(Outcome(job, "measured", frames=len(frames), values=found.values), scenario, {}, gated=True)
    bounded = {row.metric: row.status for row in rows if row.bound is not None}
    assert bounded == {bound.metric: "pass" for bound in scenario.bounds} and exit_code(rows) == 0


def test_its_hand_stops_on_the_table_and_its_user_does_not() -> None:
    frames, asked = recorded(shown())
    np.testing.assert_array_equal(frames[0].shown.positions[1], asked.scene.first_sample.positions[0])
    assert asked.samples[-1].positions[0, 2] < 0.0
    np.testing.assert_allclose(frames[-1].shown.positions[1], [0.0, 0.0, 0.025 + 0.04 + 2e-4], atol=1e-9)

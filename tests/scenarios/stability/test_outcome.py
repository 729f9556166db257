"""How a trial is judged: engines that are bad on purpose, and one that is not."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from scenarios.stability import outcome as room
from scenarios.stability.outcome import (
    CRASHED,
    LOST,
    NOT_A_NUMBER,
    SILENT,
    SURVIVED,
    TOO_LATE,
    Outcome,
    Task,
    outcome,
    outside_for,
)
from scenarios.stability.plan import Trial
from scenarios.stability.variation import Variation


def task(engine: str, case: str = "stack_ten", change: Variation | None = None, seconds: float = 0.2) -> Task:
    return Task(case, seconds, engine, "default", Trial("plain", "as it is", change or Variation()))


@pytest.mark.parametrize(("engine", "state", "said"), [
    ("tunnels", LOST, "outside its region"), ("not_a_number", NOT_A_NUMBER, "of 13 states"),
    ("raises", CRASHED, "the solver has lost its way"), ("speechless", SILENT, "it knows spheres only"),
])
def test_a_bad_engine_does_not_survive(site: Path, engine: str, state: str, said: str) -> None:
    found = outcome(task(engine))
    assert found.state == state and said in found.note


def test_one_frame_outside_is_one_frame() -> None:
    assert [outside_for(k) for k in range(3)] == ["", "outside its region in 1 frame", "outside its region in 2 frames"]


def test_who_takes_too_long_is_late(site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(room, "LATE", 0.5)
    found = outcome(task("dawdles", "painleve"))
    assert found.state == TOO_LATE and found.frames == 1


def test_depth_and_end_are_those_of_a_world_of_size_1(site: Path) -> None:
    """What stops 2 mm inside a world of size 10 is 0.2 mm inside as it is told, and ends ten times nearer."""
    here, there = outcome(task("two_millimetres")), outcome(task("two_millimetres", change=Variation(scale=10.0, far=100.0)))
    assert here.overlap == pytest.approx(2e-3, abs=1e-6) and there.overlap == pytest.approx(2e-4, abs=1e-6)
    assert np.abs(np.array(here.end) - np.array(there.end)).max() < 0.05 and len(here.end) == 10


def test_the_engine_itself_survives_and_says_where_all_ended() -> None:
    found = outcome(task("avatarsim", "squeeze"))
    assert found.state == SURVIVED and found.frames == 12 and len(found.end) == 2
    assert found.overlap <= 1e-6 and found.bad == 0


def test_a_scene_that_nobody_can_build_is_no_fault_of_an_engine() -> None:
    assert outcome(task("avatarsim", "split_invariance", Variation(scale=1e-3))).state == SILENT


def test_an_outcome_survives_json() -> None:
    found = Outcome(SURVIVED, 3, math.nan, 1e-9, 0, ((1.0, 2.0, 3.0),), 0.5, "x")
    read = Outcome.from_json({**found.as_json(), "overlap": "NaN", "end": [[1.0, 2.0, 3.0]]})
    assert math.isnan(read.overlap) and read.end == found.end and read.note == "x"
    with pytest.raises(TypeError):
        Outcome.from_json({**found.as_json(), "end": "nowhere"})


def test_a_solver_step_is_changed_from_the_preset_s_and_an_engine_without_one_is_not_asked() -> None:
    """MuJoCo's documented step of 2 ms, twice as long: a box that falls ends elsewhere, by far less than it fell."""
    assert outcome(task("avatarsim", change=Variation(step=2.0))).state == SILENT
    plain, coarse = (outcome(task("mujoco", "tumbling_box", change)) for change in (None, Variation(step=2.0)))
    assert plain.state == coarse.state == SURVIVED
    moved = np.abs(np.array(plain.end) - np.array(coarse.end)).max()
    assert 1e-9 < moved < 0.05


def test_a_margin_that_a_preset_chose_grows_with_the_world() -> None:
    """Ten boxes that MuJoCo's tuned preset holds 0.4 mm apart: at size 0.15 they end where they end at size 1."""
    plain, small = (
        outcome(replace(task("mujoco", change=change), preset="tuned")) for change in (None, Variation(scale=0.15)))
    assert plain.state == small.state == SURVIVED
    assert np.abs(np.array(plain.end) - np.array(small.end)).max() < 2e-4

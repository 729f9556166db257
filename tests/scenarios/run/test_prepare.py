"""What is worked out once for all engines of a scene, and never for another scene."""

import sys
from types import ModuleType

import numpy as np
import pytest

from avatarsim.errors import InvalidSample
from avatarsim.scene.tracker import TrackerSample, link_poses
from scenarios.job import Job
from scenarios.run.accuracy import prepare
from scenarios.scenario import Scenario
from tests.scenarios.examples import drop, fist

CATALOGUE = "a_catalogue_that_asks"


@pytest.fixture
def offered(monkeypatch: pytest.MonkeyPatch) -> dict[str, Scenario]:
    """What a catalogue offers; a test may change it."""
    module, found = ModuleType(CATALOGUE), {"fist": fist(), "drop": drop()}
    monkeypatch.setattr(module, "get", found.__getitem__, raising=False)
    monkeypatch.setitem(sys.modules, CATALOGUE, module)
    return found


def job(scenario: str, engine: str = "tracker", **more: object) -> Job:
    return Job(scenario, engine, "default", catalogue=CATALOGUE, **more)  # type: ignore[arg-type]


@pytest.mark.usefixtures("offered")
def test_engines_of_a_scene_find_what_was_worked_out() -> None:
    first = prepare(job("fist"))
    assert prepare(job("fist", "mujoco", options={"dt": 0.001})) is first
    assert prepare(job("fist", "mujoco")).samples is first.samples


@pytest.mark.usefixtures("offered")
@pytest.mark.parametrize(
    "other", [{"seed": 1}, {"frames": 2}, {"narrow": ("friction",)}, {"force": ("friction",)}, {"full": True}],
)
def test_whoever_asks_anything_else_is_told_anew(other: dict[str, object]) -> None:
    first = prepare(job("fist"))
    assert prepare(job("fist", **other)) is not first
    assert prepare(job("drop")).scene.name != first.scene.name


def test_a_scenario_of_the_same_name_is_another(offered: dict[str, Scenario]) -> None:
    first = prepare(job("fist"))
    offered["fist"] = fist()
    assert prepare(job("fist")) is not first


@pytest.mark.usefixtures("offered")
def test_the_tracker_has_its_links_where_kinematics_says() -> None:
    what = prepare(job("fist"))
    assert len(what.states) == what.scenario.frames + 1 and what.states[0] is what.scene.first_sample
    for k, state in enumerate(what.states):
        positions, orientations = link_poses(what.scene.avatars, state)
        assert what.raw[0][k].tolist() == positions.tolist() and what.raw[1][k].tolist() == orientations.tolist()


def test_a_motion_that_nobody_can_make_is_refused_every_time(offered: dict[str, Scenario]) -> None:
    nowhere = TrackerSample(0.0, np.full((1, 3), np.nan), np.array([[1.0, 0.0, 0.0, 0.0]]), np.zeros(0))
    was = fist()
    offered["fist"] = Scenario("fist", was.title, was.judged, was.build, lambda scene, seed: lambda frame: nowhere, 3)
    for _ in range(2):
        with pytest.raises(InvalidSample):
            _ = prepare(job("fist")).samples

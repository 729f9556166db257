"""Known faults in recordings pass through a file, all measures and the gate, and their figures are exact."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from avatarsim.scene.scene import Scene
from runfiles.record import Recording, load, save
from runfiles.table import Row
from scenarios.job import Job, Outcome
from scenarios.measure.everything import measured
from scenarios.measure.known import Known
from scenarios.run.gate import rows_of
from scenarios.scenario import Bound, Scenario
from tests.scenarios.examples import RADIUS, WALL_FACE, arm_scene, drop, drop_scene, fist, fist_scene, nobody, resting
from tests.scenarios.measure.bodies.test_bounce import by_events
from tests.scenarios.measure.posture.test_limits import posed


def rows(recording: Recording, scenario: Scenario, scene: Scene, folder: Path) -> dict[str, Row]:
    """Return the gate's rows of a recording that was saved and loaded."""
    path = folder / "recording.npz"
    save(recording, path)
    found = measured(load(path), Known(scenario, scene))
    outcome = Outcome(Job(scenario.name, "e", "default"), "measured", "", recording.frames, found.values, found.notes)
    return {row.metric: row for row in rows_of(outcome, scenario, {}, True)}


@pytest.mark.parametrize("depth", [0.0, 2e-6, 1e-5, 3.21e-3, 0.0437])
def test_a_known_overlap(depth: float, tmp_path: Path) -> None:
    recording = resting(fist_scene(), 20)
    recording.positions[12, 1, 0] = WALL_FACE - RADIUS + depth
    found = rows(recording, fist(20), fist_scene(), tmp_path)
    assert found["residual_overlap_max"].value == pytest.approx(depth, abs=1e-8)
    assert found["residual_overlap_max"].status == ("fail" if depth else "pass")
    assert found["overlap_frames"].value == pytest.approx(100.0 / 21.0 if depth else 0.0)
    # the fist's middle stays before the wall
    assert found["wrong_side_frames"].value == 0.0


@pytest.mark.parametrize("error", [-0.0875, 2e-3, 0.0125])
def test_a_known_bounce_error(error: float, tmp_path: Path) -> None:
    found = rows(by_events([0.3, 0.3 + error, 0.3]), drop(), drop_scene(), tmp_path)
    assert found["restitution_error_max"].value == pytest.approx(abs(error), abs=1e-12)
    assert found["restitution_error_max"].status == "fail"
    # the second apex is off by the square of it: h (e^2 (e + error)^2 - e^4)
    assert found["apex_error_max"].value == pytest.approx(abs(0.09 * ((0.3 + error) ** 2 - 0.09)), abs=1e-6)
    assert found["residual_overlap_max"].value == 0.0


@pytest.mark.parametrize("excess", [0.001, 2.5, 71.0])
def test_a_known_limit_excess(excess: float, tmp_path: Path) -> None:
    asks = Scenario("arm", "An arm.", "Limits.", arm_scene, nobody, 2, bounds=(Bound("joint_limit_excess_max", 1e-9, "no"),))
    found = rows(posed(arm=60.0 + excess), asks, arm_scene(), tmp_path)
    assert found["joint_limit_excess_max"].value == pytest.approx(excess, abs=1e-10)
    assert found["joint_limit_excess_max"].status == "fail"
    kept = rows(posed(arm=60.0), asks, arm_scene(), tmp_path)
    assert kept["joint_limit_excess_max"].status == "pass"


def test_a_known_kick_and_a_known_offset(tmp_path: Path) -> None:
    """2 kg that have 0.7 m/s from nowhere: 0.49 J. A fist 5 mm off its user in every frame: 5 mm."""
    recording = resting(drop_scene(), 10)
    recording.velocities[6:, 1, 0] = 0.7
    assert rows(recording, drop(10), drop_scene(), tmp_path)["energy_added_max"].value == pytest.approx(0.49, abs=1e-12)
    shifted = resting(fist_scene(), 10)
    shifted = replace(shifted, positions=shifted.positions + np.array([0.0, 0.005, 0.0]) * (np.arange(2) == 1)[:, None])
    found = rows(shifted, fist(10), fist_scene(), tmp_path)
    assert found["tracker_offset_rms"].value == pytest.approx(0.005, abs=1e-15)


def test_a_sound_recording_has_none_of_it(tmp_path: Path) -> None:
    found = rows(by_events([0.3, 0.3, 0.3]), drop(), drop_scene(), tmp_path)
    for metric in ("residual_overlap_max", "restitution_error_max", "apex_error_max", "energy_added_max", "not_finite_frames"):
        assert found[metric].value == pytest.approx(0.0, abs=1e-9)

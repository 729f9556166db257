"""Lines over time show the recorded numbers of a run at their times."""

from pathlib import Path

import numpy as np
import pytest

from reports.reading.kept import read_scene, shown
from reports.reading.load import Series
from reports.replay.courses import MEASURES, courses
from tests.reports.recorded import STATES, recording, scene
from tests.reports.small_runs import MUJOCO, OURS, RAW


def test_lines_of_overlap_and_time_have_their_first_instants() -> None:
    depths, costs = np.array([0.0, 1e-3, np.nan]), np.array([10.0, 20.0])
    lines = courses({OURS: Series(depths, costs)}, [], None, 0.5)
    times, values = lines["overlap"][OURS]
    assert times.tolist() == [0.0, 0.5, 1.0] and values is depths
    times, values = lines["time"][OURS]
    assert times.tolist() == [0.5, 1.0] and values is costs
    nothing = Series(np.zeros(0), np.array([np.nan, np.nan]))
    assert courses({}, [], None, 0.1) == courses({OURS: nothing}, [], None, 0.1) == {}


def test_a_falling_ball_keeps_its_energy_and_a_hand_its_user(tmp_path: Path) -> None:
    scene(tmp_path, "falls")
    for run in (OURS, MUJOCO, RAW):
        recording(tmp_path, "falls", run)
    found = shown(tmp_path, "falls", [OURS, MUJOCO, RAW])
    found[1].positions[4, 2] += [0.03, 0.04, 0.0]
    lines = courses({}, found, read_scene(tmp_path, "falls"), 1.0 / 60.0)
    assert set(lines) == {"offset", "energy"} <= set(MEASURES) and "energy" not in courses({}, found, None, 0.1)
    assert all(set(measure) == {OURS, MUJOCO} for measure in lines.values())
    times, energy = lines["energy"][OURS]
    assert len(times) == STATES and energy == pytest.approx(np.zeros(STATES), abs=1e-9)
    assert not lines["offset"][OURS][1].any()
    assert lines["offset"][MUJOCO][1][4] == pytest.approx(0.05) and np.count_nonzero(lines["offset"][MUJOCO][1]) == 1

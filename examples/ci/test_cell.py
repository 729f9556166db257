"""Limits that a robot cell has to keep in every simulator of this machine: copy this file and two of your own next to it.

Shows: the fixture `compare`, which `pip install 'avatarsim[compare]'` brings; a table with a row per engine and preset.
Run: pytest examples/ci
"""

from typing import Any

import pytest

from avatarsim.pytest_plugin import Compare

CELL: dict[str, Any] = {"scene": "cell.xml", "motion": "joints.csv", "engines": ["avatarsim", "mujoco"]}
"""A model and a motion from this file's folder, and the engines that it has to run in."""


def test_nothing_overlaps_in_avatarsim(compare: Compare) -> None:
    table = compare(**CELL)
    assert table.overlap["avatarsim/default"] <= 1e-6  # [m]


def test_mujoco_stays_within_a_millimetre_once_it_is_tuned(compare: Compare) -> None:
    table = compare(**CELL)
    assert table.overlap["mujoco/tuned"] < 1e-3, "the arm of the cell sinks into its wall"


@pytest.mark.parametrize("engine", ["avatarsim/default", "mujoco/tuned"])
def test_joints_keep_their_limits(compare: Compare, engine: str) -> None:
    assert compare(**CELL).joint_limit_excess_max[engine] < 1.0  # [deg]

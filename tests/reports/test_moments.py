"""The worst moment of a run: what is no number first, then the deepest overlap, then the farthest from the user."""

import json
from pathlib import Path

import numpy as np
import pytest

from reports.kept import Shown, shown
from reports.moments import worst
from tests.reports.recorded import STATES, recording


@pytest.fixture
def one(tmp_path: Path) -> Shown:
    recording(tmp_path, "falls", "mine/default")
    return shown(tmp_path, "falls", ["mine/default"])[0]


def test_nothing_wrong_is_no_moment(one: Shown) -> None:
    assert worst(one, np.zeros(STATES)) is None
    assert worst(one, None) is None


def test_the_deepest_overlap_by_the_judge_or_by_the_pairs(one: Shown, tmp_path: Path) -> None:
    depth = np.zeros(STATES)
    depth[[4, 7]] = 1e-3, 2e-3
    found = worst(one, depth)
    assert found is not None and (found.state, found.said) == (7, "overlap of 2.00 mm")
    recording(tmp_path, "sinks", "mine/default", sinks=True)
    sinking = shown(tmp_path, "sinks", ["mine/default"])[0]
    found = worst(sinking, None)
    assert found is not None and (found.state, found.said) == (10, "overlap of 20.0 mm")


def test_without_overlap_the_farthest_from_the_user(one: Shown) -> None:
    one.raw_positions[5, 0, 0] += 0.25
    found = worst(one, np.full(STATES, 1e-7))
    assert found is not None and (found.state, found.said) == (5, "250 mm from its user")


def test_what_is_no_number_is_worst(one: Shown) -> None:
    one.positions[12:, 1] = np.nan
    depth = np.full(STATES, 0.5)
    depth[3] = np.nan
    found = worst(one, depth)
    assert found is not None and (found.state, found.said) == (12, "a pose is no number")
    json.dumps({"state": found.state})

"""The worst moment of a run: what is no number first, then the deepest overlap, then the farthest from the user."""

import json
from pathlib import Path

import numpy as np
import pytest

from reports.deciding.moments import Moment, called, moments, remarks, states_of_metrics
from reports.reading.kept import Array, Shown, shown
from tests.reports.recorded import STATES, recording


@pytest.fixture
def one(tmp_path: Path) -> Shown:
    recording(tmp_path, "falls", "mine/default")
    return shown(tmp_path, "falls", ["mine/default"])[0]


def worst(one: Shown, depth: Array | None) -> Moment | None:
    """The first of all that is wrong, or None."""
    return next(iter(moments(one, depth)), None)


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
    assert found is not None and (found.state, found.said) == (5, "a link 250 mm from its user")


def test_what_is_no_number_is_worst(one: Shown) -> None:
    one.positions[12:, 1] = np.nan
    depth = np.full(STATES, 0.5)
    depth[3] = np.nan
    found = worst(one, depth)
    assert found is not None and (found.state, found.said) == (12, "a pose is no number")
    json.dumps({"state": found.state})


def test_a_link_that_goes_to_and_fro_shakes_and_jumps(one: Shown) -> None:
    one.positions[:] = one.positions[:1]
    one.raw_positions[:] = one.positions[:, -one.raw_positions.shape[1] :]
    # 20 mm to and fro from state 6 to state 11, 100 mm from state 14 on
    one.positions[6:12:2, -1, 0] += 0.02
    one.positions[14:, -1, 0] += 0.1
    found = {moment.said: moment.state for moment in moments(one, np.zeros(STATES))}
    assert found == {
        "a link 100 mm from its user": 14, "a link shakes by 20.0 mm, frame after frame": 9,
        "a link 20.0 mm to and fro over two frames": 7, "a link jumps 100 mm beyond its user in one frame": 14,
    }
    said = dict(remarks(one, 1))
    assert said[8] == "20.0 mm to and fro, 20.0 mm beyond its user in a frame" and 3 not in said
    # of three states that are drawn as one the worst is told
    assert dict(remarks(one, 3))[2] == said[8]


def test_root_and_links_are_called_by_their_names_and_a_turn_is_a_turn(one: Shown) -> None:
    names = ["one/root", "one/arm", "two/root"]
    assert [called(k, names) for k in range(4)] == ["root", "link arm", "root", "a link"]
    one.orientations[9:, -1] = np.cos(np.radians(20.0)), 0.0, 0.0, np.sin(np.radians(20.0))
    found = {moment.said: moment.state for moment in moments(one, np.zeros(STATES), ["hand"])}
    assert found == {"root changes its orientation by 40.0° beyond its user in one frame": 9}
    assert remarks(one, 1) == [(9, "orientation 40.0° beyond its user's in a frame")]


def test_each_metric_has_its_own_state_and_a_joint_is_no_link(tmp_path: Path) -> None:
    states, angle = 30, np.radians(20.0)
    positions, orientations = np.zeros((states, 3, 3)), np.zeros((states, 3, 4))
    orientations[..., 0] = 1.0
    raw_positions, raw_orientations = positions.copy(), orientations.copy()
    # the root turns by 80 degrees and its arm stays where it is in the world, then the hand by 20; the hand jumps, the root too
    orientations[5:, 0] = np.cos(2.0 * angle), 0.0, 0.0, np.sin(2.0 * angle)
    orientations[9:, 2] = np.cos(0.5 * angle), 0.0, 0.0, np.sin(0.5 * angle)
    positions[12, 2, 0], positions[17:, 0, 0], positions[20:, 1, 0] = 0.03, 0.02, 0.5
    one = Shown("mine/default", np.arange(states) / 60.0, positions, orientations, positions, positions, raw_positions,
                raw_orientations)
    names = ["human/root", "human/arm", "human/hand"]
    assert states_of_metrics(one, names) == {
        "link_jump_max": 20, "root_jump_max": 17, "reversal_max": 13, "tracker_offset_max": 20}
    assert states_of_metrics(one, names, (None, 0, 1))["pose_jump_max"] == 5
    # a joint that turns against its parent's turn leaves its link where it was: of orientations nothing shows, of joints it does
    orientations[:, 0], orientations[9:, 2] = orientations[0, 0], orientations[0, 0]
    orientations[7:, 1] = np.cos(angle), 0.0, 0.0, np.sin(angle)
    assert states_of_metrics(one, names, (None, 0, 1))["pose_jump_max"] == 7

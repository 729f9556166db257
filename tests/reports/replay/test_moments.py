"""The worst moments of a run are where its figures are largest."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from reports.reading.kept import Array, Drawn, Shown, shown
from reports.reading.load import Series
from reports.replay.moments import Kind, instants, moment, moments, remarks
from tests.reports.recorded import STATES, recording
from tests.reports.small_runs import OURS, OVERLAP, figure, run_of


@pytest.fixture
def one(tmp_path: Path) -> Shown:
    recording(tmp_path, "falls", "mine/default")
    return shown(tmp_path, "falls", ["mine/default"])[0]


def worst(one: Shown, depth: Array | None) -> tuple[int, Kind] | None:
    """Return the state and kind of the first of all moments, or None."""
    return next(((found.state, found.kind) for found in moments(one, depth)), None)


def test_the_deepest_overlap_by_the_judge_or_by_the_pairs(one: Shown, tmp_path: Path) -> None:
    assert worst(one, np.zeros(STATES)) is None is worst(one, None)
    depth = np.zeros(STATES)
    depth[[4, 7]] = 1e-3, 2e-3
    assert worst(one, depth) == (7, Kind.OVERLAP)
    recording(tmp_path, "sinks", "mine/default", sinks=True)
    assert worst(shown(tmp_path, "sinks", ["mine/default"])[0], None) == (10, Kind.OVERLAP)
    # without overlap it is where it is farthest from the user
    one.raw_positions[5, 0, 0] += 0.25
    assert worst(one, np.full(STATES, 1e-7)) == (5, Kind.APART)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_what_is_no_number_is_worst(one: Shown, value: float) -> None:
    one.positions[12:, 1] = value
    depth = np.full(STATES, 0.5)
    depth[3] = np.nan
    assert worst(one, depth) == (12, Kind.NO_NUMBER)


def test_a_link_that_goes_to_and_fro_shakes_and_jumps(one: Shown) -> None:
    one.positions[:] = one.positions[:1]
    one.raw_positions[:] = one.positions[:, -one.raw_positions.shape[1] :]
    # 20 mm to and fro from state 6 to state 11, 100 mm from state 14 on
    one.positions[6:12:2, -1, 0] += 0.02
    one.positions[14:, -1, 0] += 0.1
    found = {moment.kind: moment.state for moment in moments(one, np.zeros(STATES))}
    assert found == {Kind.APART: 14, Kind.SHAKES: 9, Kind.BACK: 7, Kind.JUMP: 14}
    said = dict(remarks(one, 1))
    assert 8 in said and 3 not in said
    # of three states drawn as one the worst is reported
    assert dict(remarks(one, 3))[2] == said[8]


def test_a_turn_is_a_turn(one: Shown) -> None:
    one.orientations[9:, -1] = np.cos(np.radians(20.0)), 0.0, 0.0, np.sin(np.radians(20.0))
    [found] = moments(one, np.zeros(STATES), ["hand"])
    assert (found.state, found.kind) == (9, Kind.ORIENTATION)
    assert [state for state, _ in remarks(one, 1)] == [9]


def test_each_metric_has_its_own_state_and_a_joint_is_no_link() -> None:
    states, angle = 30, np.radians(20.0)
    places, turns = np.zeros((states, 3, 3)), np.zeros((states, 3, 4))
    turns[..., 0] = 1.0
    raw_places, raw_turns = places.copy(), turns.copy()
    # the root turns by 80 degrees and its arm stays in place in the world, then the hand by 20; the hand jumps, the root too
    turns[5:, 0] = np.cos(2.0 * angle), 0.0, 0.0, np.sin(2.0 * angle)
    turns[9:, 2] = np.cos(0.5 * angle), 0.0, 0.0, np.sin(0.5 * angle)
    places[12, 2, 0], places[17:, 0, 0], places[20:, 1, 0] = 0.03, 0.02, 0.5
    one = Shown("mine/default", np.arange(states) / 60.0, places, turns, places, places, raw_places, raw_turns)
    bodies = [{"name": name} for name in ("human/root", "human/arm", "human/hand")]

    def states_of(parents: Sequence[int | None]) -> dict[str, int]:
        return {metric: round(60.0 * time) for metric, time in instants(one, Drawn(bodies, np.zeros(3), parents)).items()}

    found = {"link_jump_max": 20, "root_jump_max": 17, "reversal_max": 13, "tracker_offset_max": 20}
    assert states_of(()) == found
    assert states_of((None, 0, 1))["pose_jump_max"] == 5
    # a joint that compensates its parent's turn leaves its link in place: visible in joints, not in orientations
    turns[:, 0], turns[9:, 2] = turns[0, 0], turns[0, 0]
    turns[7:, 1] = np.cos(angle), 0.0, 0.0, np.sin(angle)
    assert states_of((None, 0, 1))["pose_jump_max"] == 7


def test_an_address_leads_to_the_time_of_the_largest_value() -> None:
    rows = [figure("a", OURS, OVERLAP, 1.0)]
    series = {"a": {OURS: Series(np.array([0.0, np.nan, 3.0, 1.0]), np.array([1.0, 9.0, 2.0]))}}
    results = run_of(rows, series).results
    assert moment(results, "a", OURS, OVERLAP, {}) == ""
    object.__setattr__(results, "frame_times", {"a": 0.5})
    assert moment(results, "a", OURS, OVERLAP, {}) == "#t=1"
    assert moment(results, "a", OURS, "frame_time_p95", {}) == "#t=1"
    assert moment(results, "a", OURS, "course_error_max", {}) == moment(results, "b", OURS, OVERLAP, {}) == ""
    assert moment(results, "a", OURS, OVERLAP, {"a": {OVERLAP: 0.25}}) == "#t=0.25"
    # a mean distance is worst where the distance is largest
    assert moment(results, "a", OURS, "tracker_offset_rms", {"a": {"tracker_offset_max": 0.5}}) == "#t=0.5"

"""Untying: a stated jump where links block each other and nothing fixed is crossed; never through furniture."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.posture.goal import aim, clip_to_limits
from avatarsim.posture.untie import forget, tracker_is_reachable
from avatarsim.posture.workspace import LISTED
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import rest
from avatarsim.simulator import AvatarsimEngine
from avatarsim.world.world import posture_of
from reference.judge import Judge
from tests.ik.test_two_hands import tube
from tests.stability.hostile import DT, link_error
from tests.worlds.little_worlds import SETTINGS, Little, hand, little, panel

PAIR = (hand(), hand(name="other"))
APART = replace(rest(PAIR), positions=np.array([[-0.4, 0.0, 0.0], [0.4, 0.0, 0.0]]))
SWAPPED = replace(APART, positions=-APART.positions)


def reachable(found: Little, positions: list[list[float]]) -> bool:
    """Whether a jump to the hands at `positions` is allowed."""
    geo, skel, posture, poses = found.parts
    tracker = posture_of(skel, found.world.hinges, replace(APART, positions=np.array(positions)))
    clip_to_limits(skel, tracker, found.memory.goal)
    aim(skel, posture, SETTINGS, found.memory.goal)
    return bool(tracker_is_reachable(geo, skel, posture, poses, SETTINGS, found.memory))


def test_links_may_jump_past_each_other_but_not_into_each_other() -> None:
    found = little(Scene("s", tube(), PAIR, start=APART))
    assert reachable(found, [[0.4, 0, 0], [-0.4, 0, 0]])
    assert not reachable(found, [[0.0, 0, 0], [0.05, 0, 0]])
    assert not reachable(found, [[0.0, 0, 0], [0.1 + 0.5 * SETTINGS.least_gap, 0, 0]])


def test_no_jump_leads_into_or_through_what_is_fixed() -> None:
    found = little(Scene("s", (panel(0.002, 0.6),), PAIR, start=APART))
    assert reachable(found, [[-0.4, 1.0, 0], [0.4, 0, 0]])
    for x in (0.6, 0.56, 0.7, 3.0):
        assert not reachable(found, [[-0.4, 1.0, 0], [x, 0, 0]])


@pytest.mark.parametrize("untie", [0, 1])
def test_hands_that_block_each_other_swap_places_in_one_stated_jump(untie: int) -> None:
    scene = Scene("s", tube(), PAIR, start=APART)
    engine, judge = AvatarsimEngine(), Judge(scene)
    engine.load(scene, Settings(options={"untie": untie}), DT)
    jumps, before = 0, None
    for k in range(60):
        record = engine.advance(SWAPPED, DT)
        assert judge.overlaps(record.shown.positions, record.shown.orientations).deepest == 0.0
        if before is not None and np.abs(record.shown.positions - before).max() > 0.31:
            # two steps of 0.15 m are the most that is walked
            assert record.counts["resyncs"] == 1
        jumps += record.counts["resyncs"]
        if k < SETTINGS.stuck_frames:
            assert jumps == 0
        before = record.shown.positions
    assert jumps == untie
    assert (link_error(scene, record, SWAPPED) < 1e-9) == bool(untie)


def test_a_tracker_behind_a_panel_is_not_jumped_to() -> None:
    scene = Scene("s", (panel(),), (hand(),), start=replace(rest((hand(),)), positions=np.array([[-0.3, 0.0, 0.0]])))
    engine = AvatarsimEngine()
    engine.load(scene, Settings(), DT)
    for _ in range(120):
        record = engine.advance(replace(scene.first_sample, positions=np.array([[0.3, 0.0, 0.0]])), DT)
        assert record.counts["resyncs"] == 0 and record.shown.positions[1, 0] < 0.0


def test_an_avatar_at_rest_or_on_its_way_is_not_stuck() -> None:
    scene = Scene("s", (panel(x=5.0),), PAIR, start=APART)
    engine = AvatarsimEngine()
    engine.load(scene, Settings(), DT)
    far = replace(APART, positions=np.array([[-9.0, 0.0, 0.0], [0.4, 0.0, 0.0]]))
    for _ in range(60):
        record = engine.advance(far, DT)
        assert record.counts["resyncs"] == 0
    assert link_error(scene, record, far) < 1e-9


def test_forgetting_leaves_no_memory_of_pairs() -> None:
    found = little(Scene("s", (panel(),), PAIR, start=APART))
    pairs = found.memory.pairs
    pairs.marks[LISTED], pairs.active[0, 1], pairs.axis[0, 1], found.memory.goal.closeness.press[0] = 1, True, 1.0, 0.1
    forget(found.memory)
    assert pairs.marks[LISTED] == 0 and not pairs.active.any() and not pairs.axis.any()
    assert not found.memory.goal.closeness.press.any()


def test_in_the_frame_of_the_jump_nobody_is_called_trapped() -> None:
    """The hands are where their users are: what was measured before the jump is of no account."""
    scene, engine = Scene("s", tube(), PAIR, start=APART), AvatarsimEngine()
    engine.load(scene, Settings(), DT)
    records = [engine.advance(SWAPPED, DT) for _ in range(SETTINGS.stuck_frames + 30)]
    [jump] = [k for k, record in enumerate(records) if record.counts["resyncs"]]
    assert link_error(scene, records[jump], SWAPPED) < 1e-9 and records[jump].counts["trapped"] == 0
    assert all(record.counts["trapped"] == 0 and record.counts["led"] == 0 for record in records[jump:])

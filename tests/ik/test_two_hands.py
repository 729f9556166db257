"""Two avatars in one scene: hands that cannot pass each other wait, and nobody waits for what holds another."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.scene.body import Body, fixed
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.simulator import AvatarsimEngine
from reference.judge import Judge
from tests.ik.test_trapped import limbed, pocket
from tests.stability.hostile import DT
from tests.worlds.little_worlds import hand
from tests.worlds.ride import ride


def tube() -> tuple[Body, ...]:
    """Four slabs around the x axis, inner width 0.12 m: two hands of 0.1 m cannot pass each other inside."""

    def slab(name: str, centre: Vector, size: Vector) -> Body:
        return fixed(name, (Piece(Box(size)),), "wood", centre)

    return (
        slab("left", (0.0, 0.11, 0.0), (4.0, 0.1, 0.32)),
        slab("right", (0.0, -0.11, 0.0), (4.0, 0.1, 0.32)),
        slab("over", (0.0, 0.0, 0.11), (4.0, 0.32, 0.1)),
        slab("under", (0.0, 0.0, -0.11), (4.0, 0.32, 0.1)),
    )


def test_two_hands_in_a_tube_wait_for_each_other_when_nothing_may_jump() -> None:
    pair = (hand(), hand(name="other"))
    home = rest(pair)
    apart = replace(home, positions=np.array([[-0.4, 0.0, 0.0], [0.4, 0.0, 0.0]]))
    go = ride(Scene("s", tube(), pair, start=apart), untie=0)
    for _ in range(60):
        go.frame(replace(home, positions=-apart.positions))
        assert go.place("hand")[0] < go.place("other")[0]
    for _ in range(20):
        go.frame(apart)
    assert go.error(apart) < 1e-9


def two_users(first: Vector, second: Vector, frames: int, **options: float) -> tuple[np.ndarray, int]:
    """Places (frames, 2, 3) of an avatar that begins in a dead end and of a hand far from it, whose users go to `first` and
    `second`; in how many frames somebody was trapped. Nothing overlaps in any."""
    pair = (limbed(), hand(name="other"))
    home = rest(pair)

    def users(a: Vector, b: Vector) -> TrackerSample:
        positions = home.positions.copy()
        positions[0], positions[2] = a, b
        return replace(home, positions=positions)

    far = fixed("far", (Piece(Box((0.2, 2.0, 2.0))),), "wood", (5.2, 0.0, 0.0))
    scene = Scene("s", (*pocket(), far), pair, start=users((-0.1, 0.0, 0.0), (5.0, 0.0, 0.0)))
    engine, judge, shown, trapped = AvatarsimEngine(), Judge(scene), [], 0
    engine.load(scene, Settings(options=options), DT)
    for _ in range(frames):
        record = engine.advance(users(first, second), DT)
        assert judge.overlaps(record.shown.positions, record.shown.orientations).deepest == 0.0
        shown.append(record.shown.positions[len(scene.bodies) :][[0, 2]])
        trapped += record.counts["trapped"]
    return np.array(shown), trapped


@pytest.mark.parametrize("second", [(5.0, 0.0, 0.0), (5.15, 0.0, 0.0), (5.2, 0.0, 0.0)])
def test_a_hand_that_presses_on_a_wall_keeps_no_other_in_its_trap(second: Vector) -> None:
    places, _ = two_users((0.3, 0.0, 0.0), second, 120)
    np.testing.assert_allclose(places[-1, 0], (0.3, 0.0, 0.0), atol=1e-6)


@pytest.mark.parametrize("leaps", [0, 7])
def test_nobody_is_led_along_the_way_that_is_sought_for_another(leaps: int) -> None:
    """The hand rests where its user rests, while a way out of the dead end is sought and gone."""
    places, _ = two_users((0.3, 0.0, 0.0), (5.0, 0.0, 0.0), 120, leap_search=leaps)
    assert np.abs(places[:, 1] - (5.0, 0.0, 0.0)).max() < 1e-9
    np.testing.assert_allclose(places[-1, 0], (0.3, 0.0, 0.0), atol=1e-6)


def test_who_waits_for_a_way_keeps_no_other_waiting() -> None:
    """The one is trapped for good; the other follows its user, who is slow enough to count as resting."""
    pair = (limbed(), hand(name="other"))
    home = rest(pair)
    room = (*pocket(), fixed("door", (Piece(Box((0.02, 0.4, 0.4))),), "wood", (-0.29, 0.0, 0.0)))
    start = home.positions.copy()
    start[0], start[2] = (-0.1, 0.0, 0.0), (5.0, 0.0, 0.0)
    scene, engine = Scene("s", room, pair, start=replace(home, positions=start)), AvatarsimEngine()
    engine.load(scene, Settings(), DT)
    for k in range(240):
        positions = start.copy()
        positions[0], positions[2, 1] = (0.5, 0.0, 0.0), 0.005 * k
        record = engine.advance(replace(home, positions=positions), DT)
        assert np.abs(record.shown.positions[-1] - positions[2]).max() < 1e-9
    assert record.counts["trapped"] == 1 and record.shown.positions[len(room), 0] < 0.0

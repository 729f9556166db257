"""A tracker that leaps is followed in that frame: no farther than it leapt, round what stands between, and never through it."""

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.errors import InvalidInput
from avatarsim.posture.leap import MOST_STEPS
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import rest
from avatarsim.settings import PostureSettings
from avatarsim.simulator import AvatarsimEngine
from tests.posture.little_worlds import at, hand, panel
from tests.posture.ride import Ride, ride
from tests.posture.test_trapped import limbed, pocket, slab
from tests.stability.hostile import DT

SETTINGS = PostureSettings()
ANY_FRAME = SETTINGS.steps * SETTINGS.move_cap
"""[m] what a root goes in a frame in which nobody leaps, where nothing shoves it aside."""
STRAY = SETTINGS.steps * SETTINGS.stray_move
"""[m] what contacts may shove it aside in such a frame."""

WALL = slab("wall", (0.0, 0.0, 0.0), (0.01, 100.0, 100.0))
"""So large that nobody goes round it."""


def begin(avatar: Avatar, start: Vector, *bodies: Body, **options: object) -> Ride:
    """The avatar at `start`."""
    return ride(Scene("s", bodies, (avatar,), start=at(rest((avatar,)), start)), **options)


def way(go: Ride, to: Vector) -> float:
    """How far the root goes [m] in one frame with the tracker at `to`."""
    root = len(go.scene.bodies)
    before = go.record.shown.positions[root].copy()
    go.frame(at(go.scene.first_sample, to))
    return float(np.linalg.norm(go.record.shown.positions[root] - before))


@pytest.mark.parametrize("avatar", [hand(), limbed()])
@pytest.mark.parametrize("leap", [1.01 * ANY_FRAME, 3.0, 0.9 * MOST_STEPS * SETTINGS.move_cap])
def test_where_nothing_stands_the_avatar_is_with_its_user_in_the_frame_of_the_leap(avatar: Avatar, leap: float) -> None:
    go = begin(avatar, (0.0, 0.0, 0.0))
    to = (0.6 * leap, -0.8 * leap, 0.0)
    way(go, to)
    assert go.error(at(go.scene.first_sample, to)) < 1e-9
    assert go.record.counts["leaps"] == 1


def test_a_walk_is_no_leap() -> None:
    go = begin(hand(), (0.0, 0.0, 0.0))
    for k in range(1, 6):
        way(go, (0.99 * k * ANY_FRAME, 0.0, 0.0))
        assert go.record.counts["leaps"] == 0


@pytest.mark.parametrize("avatar", [hand(), limbed()])
@pytest.mark.parametrize("far", [0.5, 2.0, 1e3, 1e9, 1e300])
def test_a_wall_is_leapt_to_and_not_through(avatar: Avatar, far: float) -> None:
    go = begin(avatar, (-1.5, 0.0, 0.0), WALL)
    way(go, (far, 0.0, 0.0))
    # what is too far for a distance in floating point is no place to go to
    assert -0.3 < go.record.shown.positions[len(go.scene.bodies)][0] < 0.0 or far == 1e300
    for _ in range(20):
        way(go, (far, 0.0, 0.0))
        assert go.record.shown.positions[len(go.scene.bodies)][0] < 0.0


def test_who_was_held_elsewhere_goes_no_farther_than_the_user_leaps() -> None:
    go = begin(limbed(), (-1.5, 0.0, 0.0), WALL)
    for k in range(40):
        way(go, (-1.5 + 0.25 * k, 0.0, 0.0))
    assert go.record.shown.positions[len(go.scene.bodies)][0] < 0.0
    # the user is 8 m beyond the wall, and then at a place before it that is free, 9 m from here
    assert way(go, (-0.5, 9.0, 0.0)) <= 9.0 + ANY_FRAME + STRAY
    assert way(go, (-0.5, 5.0, 0.0)) <= 4.0 + ANY_FRAME + STRAY


def test_a_way_round_is_found_in_the_frame_of_the_leap_if_the_settings_say_so() -> None:
    behind = (3.0, 0.0, 0.0)
    at_once = begin(limbed(), (-0.1, 0.0, 0.0), *pocket(), search_work=40, leap_search=99)
    way(at_once, behind)
    later = begin(limbed(), (-0.1, 0.0, 0.0), *pocket(), search_work=40, leap_search=0)
    way(later, behind)
    sample = at(later.scene.first_sample, behind)
    assert at_once.record.counts["led"] > 0 and at_once.error(sample) < 0.01
    assert later.record.counts["led"] == 0 and later.error(sample) > 1.0
    for _ in range(60):
        way(later, behind)
    assert later.error(sample) < 1e-3


def test_a_new_leap_ends_the_way_to_where_the_tracker_was() -> None:
    go = begin(limbed(), (-0.1, 0.0, 0.0), *pocket(), slab("far", (0.0, 0.0, -3.0), (9.0, 9.0, 0.1)))
    for _ in range(5):
        way(go, (0.5, 0.0, 0.0))
    home = (-2.0, 0.0, 0.0)
    for _ in range(20):
        way(go, home)
    assert go.error(at(go.scene.first_sample, home)) < 1e-6


@pytest.mark.parametrize("value", [-1, 0.5, float("nan"), "soon"])
def test_bad_searches_are_refused(value: object) -> None:
    scene = Scene("s", (panel(),), (hand(),), start=at(rest((hand(),)), (-0.3, 0.0, 0.0)))
    with pytest.raises(InvalidInput, match="leap_search"):
        AvatarsimEngine().load(scene, Settings(options={"leap_search": value}), DT)

"""A tracker that leaps is followed in that frame: no farther than it leapt, round what stands between, and never through it."""

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.errors import InvalidInput
from avatarsim.posture.leap import MOST_STEPS
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.mass import solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Capsule, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.settings import PostureSettings
from avatarsim.simulator import AvatarsimEngine
from tests.ik.test_trapped import limbed, pocket, slab
from tests.stability.hostile import DT
from tests.worlds.little_worlds import at, hand, panel
from tests.worlds.ride import Ride, ride

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


@pytest.mark.parametrize("far", [60.0, 200.0])
def test_who_is_on_the_way_to_a_user_at_rest_is_not_taken_along_by_the_leap_of_another(far: float) -> None:
    one, other = hand(name="one"), hand(name="other")
    start = at(rest((one, other)), (0.0, 5.0, 0.0))
    go = ride(Scene("s", (slab("far", (0.0, 0.0, -9.0), (9.0, 9.0, 0.1)),), (one, other), start=start), leap_search=0)
    second = len(go.scene.bodies) + 1
    away = start.positions.copy()
    away[1, 0] = far
    go.frame(TrackerSample(0.0, away, start.rotations, start.angles))
    assert go.record.shown.positions[second, 0] == pytest.approx(MOST_STEPS * SETTINGS.move_cap + ANY_FRAME)
    for k in range(3):
        before = go.record.shown.positions[second].copy()
        away[0, 1] += 8.0
        go.frame(TrackerSample(0.0, away.copy(), start.rotations, start.angles))
        assert go.record.counts["leaps"] == 1 and go.record.shown.positions[second - 1, 1] == pytest.approx(5.0 + 8.0 * (k + 1))
        assert np.linalg.norm(go.record.shown.positions[second] - before) <= ANY_FRAME + 1e-9


@pytest.mark.parametrize("turned", [0.0, 0.4])
@pytest.mark.parametrize("search_work", [0, SETTINGS.search_work])
def test_a_limb_that_was_held_does_not_whip_when_its_user_leaps(turned: float, search_work: int) -> None:
    arm = (Piece(Capsule(0.02, 0.5), (0.35, 0.0, 0.0)),)
    joint = Hinges((Hinge((0.0, 0.0, 1.0), -2.9, 2.9),))
    ball = (Piece(Sphere(0.05)),)
    links = (
        Link("root", None, Free(), ball, solid(ball, 1.0)), Link("arm", "root", joint, arm, solid(arm, 0.1)),
    )
    avatar = Avatar("armed", links, ("arm",))
    sides = tuple(slab(f"y{y}", (20.0, 0.12 * y, 0.0), (41.0, 0.02, 40.0)) for y in (1.0, -1.0))
    go = begin(avatar, (0.0, 0.0, 0.0), *sides, around=0, search_work=search_work, untie=0)
    sample = go.scene.first_sample
    for angle in np.linspace(0.0, 2.4, 30):
        sample = TrackerSample(0.0, sample.positions, sample.rotations, np.array([angle]))
        go.frame(sample)
    held = float(go.record.angles[0])
    assert 2.4 - held > 1.1
    there = at(TrackerSample(0.0, sample.positions, sample.rotations, np.array([2.4 + turned])), (-3.0, 0.0, 0.0))
    go.frame(there)
    assert go.record.shown.positions[len(go.scene.bodies)] == pytest.approx((-3.0, 0.0, 0.0))
    # a quarter turn beyond the user's own
    assert go.record.angles[0] - held < turned + 0.5 * np.pi
    for _ in range(3):
        go.frame(there)
    assert go.error(there) < 1e-6


@pytest.mark.parametrize(("deep", "seed"), [(0.4, 15), (0.6, 15)])
def test_nobody_is_shown_halfway_along_a_way_that_is_too_long_for_the_frame_in_which_it_is_found(deep: float, seed: int) -> None:
    wide, thin = 0.32, 0.01
    tube = (
        slab("end", (0.0, 0.0, 0.0), (0.002, wide, wide)),
        *(slab(f"y{y}", (-0.5 * deep, 0.15 * y, 0.0), (deep, thin, wide)) for y in (1.0, -1.0)),
        *(slab(f"z{z}", (-0.5 * deep, 0.0, 0.15 * z), (deep, wide, thin)) for z in (1.0, -1.0)),
    )
    ball = (Piece(Sphere(0.02)),)
    joint = Hinges((Hinge((0.0, 0.0, 1.0), -1.0, 1.0),))
    links = (
        Link("root", None, Free(), ball, solid(ball, 1.0)),
        Link("tip", "root", joint, ball, solid(ball, 0.1), anchor=(0.0, 0.05, 0.0)),
    )
    avatar = Avatar("small", links, ("tip",))
    scene = Scene("s", tube, (avatar,), start=at(rest((avatar,)), (-0.1, 0.0, 0.0)))
    go, led = ride(scene, seed=seed), 0
    for k in range(150):
        before = go.record.shown
        way(go, (min(-0.1 + 0.01 * k, 0.03), 0.0, 0.0))
        led += go.record.counts["led"]
        root, shown = len(tube), go.record.shown
        assert np.linalg.norm(shown.positions[root] - before.positions[root]) < 0.4
        cosine = abs(float(shown.orientations[root] @ before.orientations[root]))
        assert 2.0 * np.arccos(min(cosine, 1.0)) < 0.5 * np.pi
    assert led > SETTINGS.steps and go.error(at(scene.first_sample, (0.03, 0.0, 0.0))) < 1e-6


@pytest.mark.parametrize("value", [-1, 0.5, float("nan"), "soon"])
def test_bad_searches_are_refused(value: object) -> None:
    scene = Scene("s", (panel(),), (hand(),), start=at(rest((hand(),)), (-0.3, 0.0, 0.0)))
    with pytest.raises(InvalidInput, match="leap_search"):
        AvatarsimEngine().load(scene, Settings(options={"leap_search": value}), DT)

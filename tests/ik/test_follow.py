"""Following the tracker, judged by poses alone: no overlap and no excess in any frame, and back when the way is free."""

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.model.world import build
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, fixed, solid
from avatarsim.scene.joint import Free, Hinge, Hinges, Rigid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import TrackerSample, link_poses
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation
from scenarios import catalog
from tests.stability.hostile import DT, hinged_avatar, link_error
from tests.worlds.little_worlds import X, Y, at, hand_scene, panel, piece
from tests.worlds.loaded import loaded
from tests.worlds.ride import ride

CUBE = np.array([[x, y, z] for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (-0.1, 0.1)])


def arm() -> Avatar:
    """A fixed shoulder and three capsules, hinged about z and y: a planar arm that can also lift."""
    mass = solid(piece(), 1.0)
    lean = tuple(float(v) for v in rotation.from_axis_angle(Y, 0.5 * np.pi))
    hinges = Hinges((Hinge(X, -2.5, 2.5), Hinge(Y, -1.0, 1.0)))
    return Avatar(
        "arm",
        (
            Link("shoulder", None, Rigid(), (Piece(Sphere(0.05)),), mass, orientation=lean),
            Link("upper", "shoulder", hinges, piece(), mass),
            Link("fore", "upper", hinges, piece(), mass, anchor=(0.0, 0.0, 0.4)),
            Link("palm", "fore", hinges, piece(0.1), mass, anchor=(0.0, 0.0, 0.4)),
        ),
    )


WALL = fixed("wall", (Piece(Box((2.0, 0.1, 2.0))),), "wood", (0.6, 0.35, 0.0))


def test_an_arm_that_sweeps_into_a_wall_stops_at_it_slides_and_comes_back() -> None:
    go = ride(Scene("s", (WALL,), (arm(),)))
    home = go.scene.first_sample
    for k in range(60):
        angle = 1.6 * np.sin(np.pi * k / 60)
        go.frame(replace(home, angles=np.array([-angle, 0.3 * np.sin(0.2 * k), 0.0, 0.0, 0.0, 0.0])))
        if k == 30:
            # it rests against the wall, not short of it
            assert go.judge.overlaps(go.record.shown.positions, go.record.shown.orientations, 0.01).gap < 1e-3
            assert go.error(replace(home, angles=np.array([-angle, 0, 0, 0, 0, 0]))) > 0.1
    for _ in range(15):
        go.frame(home)
    assert go.error(home) < 1e-9


def test_who_is_far_beyond_limits_is_shown_nearer_than_joint_by_joint_and_comes_back() -> None:
    go = ride(Scene("s", (), (hinged_avatar(),)))
    home = go.scene.first_sample
    far = replace(home, angles=home.angles + 2.5)
    for _ in range(60):
        go.frame(far)
    skeleton = build(go.scene)
    inside = np.clip(far.angles, *skeleton.skeleton.limits[skeleton.hinges].T)
    raw, clipped = (link_poses(go.scene.avatars, replace(far, angles=angles))[0] for angles in (far.angles, inside))
    spread = [np.sqrt((np.linalg.norm(at - raw, axis=-1) ** 2).mean()) for at in (go.record.shown.positions, clipped)]
    assert spread[0] < 0.9 * spread[1]
    for _ in range(30):
        go.frame(home)
    assert go.error(home) < 1e-2


def test_a_hand_that_comes_free_in_a_corner_does_not_jump() -> None:
    """The fourth seed: fingers wedged between two walls come free; the hand jumped by 18 mm where joints went their own way."""
    scenario = catalog.get("hand_in_corner").as_run(full=False)
    scene = scenario.build()
    motion, engine = scenario.motion(scene, 4), AvatarsimEngine()
    engine.load(scene, Settings(), scenario.dt)
    samples = [motion(k) for k in range(scenario.frames)]
    shown = np.array([engine.advance(sample, scenario.dt).shown.positions[len(scene.bodies)] for sample in samples])
    user = np.array([sample.positions[0] for sample in samples])
    ways = [np.linalg.norm(np.diff(path, axis=0), axis=1) for path in (shown, user)]
    assert np.linalg.norm(user - shown, axis=1).max() > 0.01
    assert (ways[0] - ways[1]).max() < 0.01


@pytest.mark.parametrize(
    "shape",
    [Sphere(0.05), Box((0.1, 0.08, 0.06)), Capsule(0.03, 0.1), ellipsoid_hull((0.05, 0.04, 0.08)), Ellipsoid((0.05, 0.04, 0.08))],
)
def test_a_hand_punched_through_a_panel_stays_on_its_side(shape: object) -> None:
    """A tracker at 30 m/s and more; the hand waits at the panel and goes home when the tracker does."""
    go = ride(hand_scene((-0.5, 0.0, 0.0), panel(), shape=(Piece(shape),)))
    home = go.scene.first_sample
    for k in range(60):
        go.frame(at(home, (-0.5 + 0.5 * (k % 20), 0.1, 0.0)))
        assert go.place("hand")[0] < 0.0
    for _ in range(10):
        go.frame(home)
    assert go.error(home) < 1e-9


@pytest.mark.parametrize("gap", [0.0, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-3])
@pytest.mark.parametrize("shape", [Sphere(0.1), Box((0.2, 0.2, 0.2)), Capsule(0.05, 0.1), ConvexHull(CUBE)])
def test_a_body_that_starts_at_rest_on_the_floor_can_leave_it(gap: float, shape: object) -> None:
    """A start that is accepted as free must not be a trap, also when it touches to rounding."""
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 1.0))),), "wood", (0.0, 0.0, -0.5))
    scene = hand_scene((0.0, 0.0, 0.1 + gap), floor, shape=(Piece(shape),))
    engine = loaded(scene)
    above = at(scene.first_sample, (0.3, 0.0, 0.5))
    for _ in range(10):
        record = engine.advance(above, DT)
    assert link_error(scene, record, above) < 1e-9


@pytest.mark.parametrize("sink", [0.0, 0.002, 0.1])
def test_a_body_that_starts_at_rest_on_the_floor_can_slide_on_it(sink: float) -> None:
    """The tracker moves sideways and never up: what touches exactly has to find its own way off the floor."""
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 1.0))),), "wood", (0.0, 0.0, -0.5))
    scene = hand_scene((0.0, 0.0, 0.1), floor, shape=(Piece(Box((0.2, 0.2, 0.2))),))
    go = ride(scene)
    for _ in range(30):
        go.frame(at(scene.first_sample, (0.3, 0.1, 0.1 - sink)))
    assert go.place("hand") == pytest.approx([0.3, 0.1, 0.1], abs=0.01)


def test_a_wedge_with_a_trembling_tracker() -> None:
    """A hull pressed into a V-shaped groove stays apart from both sides for hundreds of frames."""

    def side(sign: float) -> Body:
        turn = rotation.from_axis_angle(Y, sign * 0.35)
        place = rotation.rotate(turn, (sign * 0.5, 0.0, 0.9))
        w, x, y, z = (float(v) for v in turn)
        return fixed(f"side{sign:+.0f}", (Piece(Box((1.0, 2.0, 2.0))),), "wood", tuple(float(v) for v in place), (w, x, y, z))

    go = ride(hand_scene((0.0, 0.0, 1.0), side(1.0), side(-1.0), shape=(Piece(ellipsoid_hull((0.1, 0.15, 0.1))),)))
    rng, deep = np.random.default_rng(1), at(go.scene.first_sample, (0.0, 0.0, -0.5))
    for _ in range(250):
        turn = rotation.normalised(np.array([[1.0, 0.0, 0.0, 0.0]]) + 0.02 * rng.normal(size=(1, 4)))
        go.frame(replace(deep, positions=deep.positions + 0.02 * rng.normal(size=(1, 3)), rotations=turn))
    assert go.judge.overlaps(go.record.shown.positions, go.record.shown.orientations, 0.01).gap < 1e-3
    for _ in range(20):
        go.frame(go.scene.first_sample)
    assert go.error(go.scene.first_sample) < 1e-9


def ghost_tip() -> Avatar:
    """A ball and, hinged to it, a tip without pieces: a marker."""
    shape = (Piece(Sphere(0.1)),)
    mass = solid(shape, 1.0)
    return Avatar("a", (Link("ball", None, Free(), shape, mass), Link("tip", "ball", Hinges((Hinge(X),)), (), mass)))


@pytest.mark.filterwarnings("default")
def test_a_link_without_pieces_does_not_glue_the_avatar_to_the_floor() -> None:
    """It slides along the floor below which the tracker is; a weight of 0 or nan would hold it where it landed."""
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 1.0))),), "wood", (0.0, 0.0, -0.65))
    go = ride(Scene("s", (floor,), (ghost_tip(),)))
    for k in range(60):
        go.frame(at(go.scene.first_sample, (0.01 * min(k, 29), 0.0, -0.3)))
    assert go.record.shown.positions[1] == pytest.approx([0.29, 0.0, -0.05], abs=0.02)


def far(x: float) -> Callable[[TrackerSample], TrackerSample]:
    """The root at x."""
    return lambda home: at(home, (x, 0.0, 0.0))


@pytest.mark.parametrize("places", [(1e9, -1e9), (1e150, -1e150), (1.7e308, -1.7e308)])
def test_a_tracker_at_the_end_of_the_number_range_does_no_harm(places: Iterable[float]) -> None:
    """The samples are finite, so they are valid; the avatar need not arrive, but it must stay a pose and come home."""
    scene = hand_scene((0.0, 0.0, 0.0))
    engine = loaded(scene)
    for x in places:
        for _ in range(25):
            record = engine.advance(far(x)(scene.first_sample), DT)
            assert np.isfinite(record.shown.positions).all()
    for _ in range(25):
        record = engine.advance(scene.first_sample, DT)
    assert link_error(scene, record, scene.first_sample) < 1e-6

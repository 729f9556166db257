"""Following the tracker, judged by poses alone: no overlap and no excess in any frame, and back when the way is free."""

import subprocess
import sys
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
from reference.judging.judge import Judge
from scenarios import catalog
from tests.stability.hostile import DT, hinged_avatar, humanoid_trial, link_error
from tests.worlds.little_worlds import X, Y, at, hand_scene, mixed_avatar, panel, piece, random_sample
from tests.worlds.ride import ride

ROOT = [sys.executable, "-c"]
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


def test_free_motion_is_followed_within_the_frame() -> None:
    go = ride(Scene("s", (WALL,), (arm(),)))
    home = go.scene.first_sample
    for k in range(40):
        sample = replace(home, angles=np.array([0.5, 0.3, -0.4, 0.2, 0.1, 0.3]) * np.sin(0.1 * k))
        if sample.angles[0] >= 0.0:
            go.frame(sample)
            assert go.error(sample) < 1e-9


def arms_through_chest(k: int, home: TrackerSample) -> TrackerSample:
    """Both arms of the sixteen hulls go through the chest and each other, to and fro."""
    angles = home.angles.copy()
    share = np.sin(0.15 * k)
    # hinges: chest 3, neck 3, head 3, then left upper arm 3, forearm 2, hand 2
    angles[9:12] = (-2.0 * share, 1.2 * share, 0.5)
    angles[12] = -2.0 * abs(share)
    left = 9 + 7 + 7
    angles[left : left + 3] = (2.0 * share, 1.2 * share, -0.5)
    angles[left + 3] = -2.0 * abs(share)
    return replace(home, angles=angles)


def test_arms_folded_through_the_chest() -> None:
    avatar = hinged_avatar()
    go = ride(Scene("s", (fixed("floor", (Piece(Box((9.0, 9.0, 0.2))),), "wood", (0.0, 0.0, -2.0)),), (avatar,)))
    home, hostile = go.scene.first_sample, 0
    raw = Judge(go.scene)
    for k in range(90):
        sample = arms_through_chest(k, home)
        links, turns = link_poses((avatar,), sample)
        positions, orientations = go.record.shown.positions.copy(), go.record.shown.orientations.copy()
        positions[1:], orientations[1:] = links, turns
        hostile += raw.overlaps(positions, orientations).deepest > 1e-3
        go.frame(sample)
    assert hostile > 30
    for _ in range(60):
        go.frame(home)
    assert go.error(home) < 0.01


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


def test_teleports_into_and_behind_furniture() -> None:
    table = fixed(
        "table", (Piece(Box((1.0, 0.6, 0.05))), Piece(Box((0.05, 0.05, 0.7)), (0.4, 0.2, -0.35))), "wood", (0.6, 0.0, 0.0)
    )
    go = ride(hand_scene((-0.5, 0.0, 0.3), table, panel(0.01, 1.3), shape=(Piece(ellipsoid_hull((0.1, 0.05, 0.03))),)))
    home, rng = go.scene.first_sample, np.random.default_rng(2)
    for k in range(90):
        if k % 10 == 0:
            inside = rng.uniform((0.2, -0.3, -0.02), (1.0, 0.3, 0.02)) if k % 20 else rng.uniform(-1.5, 1.5, 3)
            turn = rotation.normalised(rng.normal(size=(1, 4)))
        go.frame(replace(at(home, tuple(inside)), rotations=turn))
    for _ in range(90):
        go.frame(home)
    assert go.error(home) < 1e-6


@pytest.mark.parametrize("gap", [0.0, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-3])
@pytest.mark.parametrize("shape", [Sphere(0.1), Box((0.2, 0.2, 0.2)), Capsule(0.05, 0.1), ConvexHull(CUBE)])
def test_a_body_that_starts_at_rest_on_the_floor_can_leave_it(gap: float, shape: object) -> None:
    """A start that is accepted as free must not be a trap, also when it touches to rounding."""
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 1.0))),), "wood", (0.0, 0.0, -0.5))
    scene = hand_scene((0.0, 0.0, 0.1 + gap), floor, shape=(Piece(shape),))
    engine = AvatarsimEngine()
    engine.load(scene, Settings(), DT)
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


@pytest.mark.parametrize("seed", range(12))
def test_hinges_obey_their_limits_to_the_last_bit(seed: int) -> None:
    rng = np.random.default_rng(seed)
    limits, mass = (-float(rng.uniform(0.01, 0.3)), float(rng.uniform(0.01, 0.3))), solid(piece(), 1.0)
    limb = Link("limb", "root", Hinges((Hinge(X, *limits),)), piece(), mass, anchor=(0, 0, 0.4))
    scene = Scene("s", (panel(x=-5.0),), (Avatar("a", (Link("root", None, Free(), piece(), mass), limb)),))
    engine = AvatarsimEngine()
    engine.load(scene, Settings(), DT)
    for _ in range(100):
        angle = rng.uniform(-0.5, 0.5)
        record = engine.advance(replace(scene.first_sample, angles=np.array([angle])), DT)
        assert limits[0] <= record.angles[0] <= limits[1]


def test_the_humanoid_obeys_swing_and_twist_under_wild_rotations() -> None:
    case = humanoid_trial()
    go, rng = ride(case.scene), np.random.default_rng(4)
    balls = [k for k, link in enumerate(case.scene.links) if link.parent is not None]
    for k in range(80):
        if k % 8 == 0:
            rotations = case.home.rotations.copy()
            rotations[balls] = rotation.normalised(rng.normal(size=(len(balls), 4)))
        go.frame(replace(case.home, rotations=rotations, angles=rng.uniform(-4.0, 4.0, len(case.home.angles))))
    for _ in range(60):
        go.frame(case.home)
    assert go.error(case.home) < 0.01


def test_a_ball_whose_link_is_turned_at_rest_obeys_limits_in_its_parents_frame() -> None:
    scene = Scene("s", (), (mixed_avatar(),))
    assert scene.links[1].orientation != scene.links[0].orientation
    go = ride(scene)
    for seed in range(20):
        for _ in range(8):
            go.frame(random_sample(scene.avatars, seed))


def far(x: float) -> Callable[[TrackerSample], TrackerSample]:
    """The root at x."""
    return lambda home: at(home, (x, 0.0, 0.0))


@pytest.mark.parametrize("places", [(1e9, -1e9), (1e150, -1e150), (1.7e308, -1.7e308)])
def test_a_tracker_at_the_end_of_the_number_range_does_no_harm(places: Iterable[float]) -> None:
    """The samples are finite, so they are valid; the avatar need not arrive, but it must stay a pose and come home."""
    scene = hand_scene((0.0, 0.0, 0.0))
    engine = AvatarsimEngine()
    engine.load(scene, Settings(), DT)
    for x in places:
        for _ in range(25):
            record = engine.advance(far(x)(scene.first_sample), DT)
            assert np.isfinite(record.shown.positions).all()
    for _ in range(25):
        record = engine.advance(scene.first_sample, DT)
    assert link_error(scene, record, scene.first_sample) < 1e-6


CHILD = """
from tests.stability.hostile_run import run
print(run("hinged", seed=9, frames=40, away=20, home=10, judge_every=1000).hashes[-1])
"""


def test_two_processes_agree_to_the_last_bit() -> None:
    hashes = {subprocess.run([*ROOT, CHILD], capture_output=True, text=True, check=True).stdout.strip() for _ in range(2)}
    assert len(hashes) == 1 and len(hashes.pop()) == 16

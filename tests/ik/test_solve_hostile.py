"""Frames where it is hard: jumps into bodies, squeezes, walls between avatar and target; and resting avatars rest."""

from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from avatarsim.engine import Settings
from avatarsim.model.world import build
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, fixed, solid
from avatarsim.scene.joint import Free, Hinge, Hinges, Rigid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import TrackerSample, link_poses, link_poses_each, rest
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation
from runfiles.visible_motion import reversals, shaking
from scenarios import catalog, unseen
from tests.ik.scenes import walled_hinged
from tests.stability.hostile import DT, TRIALS, hinged_avatar, hostile_motion, link_error, one_return, outside_room
from tests.worlds.little_worlds import X, Y, at, block, hand, hand_scene, panel, piece, turned
from tests.worlds.loaded import loaded
from tests.worlds.ride import Ride, ride


@pytest.mark.parametrize("dt", [1 / 30, 1 / 60, 1 / 90, 1 / 240])
@pytest.mark.parametrize("name", TRIALS)
def test_hostile_motion_at_any_frame_rate(name: str, dt: float) -> None:
    """Teleports into furniture, targets beyond limits, tangles and swings; nothing leaves the room or is no number."""
    trial = TRIALS[name]()
    go = ride(trial.scene)
    for _, sample in islice(hostile_motion(trial, 7, 24, 12), 180):
        shown = go.frame(sample, dt).shown
        assert np.isfinite(shown.positions).all() and np.isfinite(shown.orientations).all()
        assert outside_room(trial.scene, go.record) <= 0.0


@pytest.mark.parametrize("seed", range(3))
def test_half_turns_of_everything_at_once(seed: int) -> None:
    """There the tangent error jumps from one side to the other."""
    scene, rng = walled_hinged(), np.random.default_rng(seed)
    go, start = ride(scene), scene.first_sample
    for k in range(60):
        axis = rng.normal(size=3) if k % 2 else np.array([0.0, 0.0, 1.0])
        half = rotation.from_axis_angle(axis / np.linalg.norm(axis), np.pi * (1.0 + 1e-9 * (k % 3 - 1)))
        turned = rotation.multiply(start.rotations, half)
        go.frame(at(replace(start, rotations=turned), (0.0, 0.0, 1.2)))
    for _ in range(200):
        go.frame(start)
    assert go.error(start) < 1e-6


def pressed(scene: Scene, **options: Any) -> tuple[Ride, TrackerSample]:
    """Return sixteen hulls that were led half a metre into a wall, and the target that rests there from now on."""
    go, start = ride(scene, **options), scene.first_sample
    sample = start
    for k in range(60):
        sample = at(start, (0.012 * k, 0.01 * np.sin(k / 5.0), 1.1 - 0.001 * k))
        go.frame(sample)
    return go, sample


def motions(go: Ride, sample: TrackerSample, frames: int) -> np.ndarray:
    """Return the way of the farthest link [m] in each of so many frames."""
    found, before = [], go.record.shown.positions
    for _ in range(frames):
        shown = go.frame(sample).shown.positions
        found.append(float(np.abs(shown - before).max()))
        before = shown
    return np.array(found)


def test_the_constrained_minimum_is_a_fixed_point() -> None:
    """With a settle time of eleven days nothing but the minimum itself brings an avatar to rest."""
    moved = motions(*pressed(walled_hinged(), settle_time=1e6), 900)
    assert moved[120] < 1e-4 and moved[400] < 1e-5 and moved[-1] < 1e-7
    waves = np.abs(np.diff(moved[30:])) > moved[30:-1]
    assert not waves.any(), "it comes to rest and does not go to and fro"


def test_before_a_target_that_rests_an_avatar_rests() -> None:
    go, sample = pressed(walled_hinged())
    moved = motions(go, sample, 700)
    assert moved[240:].sum() < 5e-3 and (moved[-60:] < 1e-7).all()
    home = at(sample, (0.0, 0.0, 1.1))
    for _ in range(60):
        go.frame(home)
    assert go.error(home) < 1e-9, "and comes away when its target does"


@pytest.mark.parametrize("far", [2.0, 50.0])
def test_behind_a_wall_the_pose_is_kept_in_the_angles_of_joints(far: float) -> None:
    """However far beyond a wall the target is, and though arms and legs could stretch after it; without friction, which holds the
    body at an angle where it was when the target came to rest."""
    scene = walled_hinged()
    scene = replace(scene, narrow=("friction",))
    limits = [(h.lower, h.upper) for link in scene.links if isinstance(link.joint, Hinges) for h in link.joint.hinges]
    low, high = np.array(limits).T
    go, start = ride(scene, around=0), scene.first_sample
    wanted = np.clip(start.angles + 0.3 * np.clip(np.random.default_rng(1).normal(size=len(low)), -1.0, 1.0), low, high)
    for k in range(240):
        share = min(1.0, k / 120)
        sample = at(replace(start, angles=start.angles + share * (wanted - start.angles)), (far * share, 0.0, 1.1))
        record = go.frame(sample)
    off = np.abs(record.angles - wanted)
    assert np.degrees(off.max()) < 25.0 and np.degrees(off.mean()) < 6.0
    turn = Rotation.from_quat(record.shown.orientations[len(scene.bodies)], scalar_first=True).magnitude()
    assert np.degrees(turn) < 10.0
    # the obstacle is reported: it waits, or a path is sought meanwhile
    assert sum(record.statuses.get(name, 0) for name in ("waiting", "planning")) == 1


def plates(apart: float) -> tuple[Scene, TrackerSample]:
    """Return a box of a decimetre between two plates, and where it begins."""
    box = hand((Piece(Box((0.2, 0.16, 0.1))),))
    away, size = 0.1 + 0.5 * apart, (2.0, 2.0, 0.2)
    both = block("under", (0.0, 0.0, -away), size), block("over", (0.0, 0.0, away), size)
    return Scene("plates", both, (box,), start=rest((box,))), rest((box,))


@pytest.mark.parametrize("apart", [0.2, 0.1003, 0.1001, 0.10002, 0.100001])
def test_a_box_squeezed_between_two_plates_comes_free(apart: float) -> None:
    scene, home = plates(apart)
    go, rng = ride(scene), np.random.default_rng(0)
    for k in range(60):
        target = at(replace(home, rotations=rotation.normalised(rng.normal(size=(1, 4)))), (0.01 * k, 0.0, 0.3 * np.sin(k)))
        go.frame(target)
    for _ in range(90):
        go.frame(at(home, (0.5, 0.0, 0.0)))
    assert go.place("hand") == pytest.approx((0.5, 0.0, 0.0), abs=1e-6)


def test_waiting_is_said_as_long_as_it_comes_no_nearer() -> None:
    scene, home = plates(0.2)
    go = ride(scene)
    said = ["waiting" in go.frame(at(home, (0.0, 0.0, 0.3))).statuses for _ in range(60)]
    assert not any(said[:5]) and all(said[30:])
    assert "waiting" not in go.frame(home).statuses
    go = ride(scene)
    near = ["waiting" in go.frame(at(home, (0.0, 0.0, 0.09))).statuses for _ in range(60)]
    assert not any(near), "4 cm behind a plate is near"


@pytest.mark.parametrize(("seed", "frames"), [(85, 13), (35, 13), (55, 37)])
def test_a_palm_whose_target_leaps_out_of_the_room_stays_inside(seed: int, frames: int) -> None:
    trial = TRIALS["two"]()
    go = ride(trial.scene, seed)
    for _, sample in islice(one_return(trial, seed, 60, 0), frames):
        assert outside_room(trial.scene, go.frame(sample)) <= 0.0


@pytest.mark.parametrize("begins", ["loaded", "restored"])
def test_no_leap_into_an_avatar_whose_island_is_solved_later(begins: str) -> None:
    """Seed 264: in the very first frame the arm of one jumps to where the other, which touches nothing, still is."""
    trial = TRIALS["two"]()
    go = ride(trial.scene, 264)
    samples = [sample for _, sample in islice(one_return(trial, 264, 60, 0), 12)]
    for sample in samples if begins == "loaded" else ():
        go.frame(sample)
    for k, sample in enumerate(samples if begins == "restored" else ()):
        other = ride(trial.scene, 264)
        other.engine.restore(go.engine.snapshot())
        shown = go.frame(sample), other.frame(sample)
        assert shown[0].state_hash() == shown[1].state_hash(), k


CUBE = np.array([[x, y, z] for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (-0.1, 0.1)])


def arm() -> Avatar:
    """Return a fixed shoulder and three capsules, hinged about z and y: a planar arm that can also lift."""
    mass = solid(piece(), 1.0)
    lean = turned(Y, 0.5 * np.pi)
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


WALL, FLOOR = block("wall", (0.6, 0.35, 0.0), (2.0, 0.1, 2.0)), block("floor", (0.0, 0.0, -0.5), (4.0, 4.0, 1.0))


def test_an_arm_that_sweeps_into_a_wall_stops_and_comes_back() -> None:
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


def test_far_beyond_limits_the_whole_posture_is_brought_near() -> None:
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
    motion = scenario.motion(scene, 4)
    samples = [motion(k) for k in range(scenario.frames)]
    hand, user = shown(scene, samples, scenario.dt)[1:, 0], np.array([sample.positions[0] for sample in samples])
    ways = [np.linalg.norm(np.diff(path, axis=0), axis=1) for path in (hand, user)]
    assert np.linalg.norm(user - hand, axis=1).max() > 0.01
    assert (ways[0] - ways[1]).max() < 0.01


@pytest.mark.parametrize(
    "shape",
    [Sphere(0.05), Box((0.1, 0.08, 0.06)), Capsule(0.03, 0.1), ellipsoid_hull((0.05, 0.04, 0.08)), Ellipsoid((0.05, 0.04, 0.08))],
)
def test_a_hand_punched_through_a_panel_stays_on_its_side(shape: Shape) -> None:
    """A tracker at 30 m/s and more; the hand waits at the panel and goes home when the tracker does."""
    go = ride(hand_scene((-0.5, 0.0, 0.0), panel(), shape=(Piece(shape),)))
    home = go.scene.first_sample
    for k in range(60):
        go.frame(at(home, (-0.5 + 0.5 * (k % 20), 0.1, 0.0)))
        assert go.place("hand")[0] < 0.0
    for _ in range(15):
        go.frame(home)
    assert go.error(home) < 1e-9


@pytest.mark.parametrize("gap", [0.0, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-3])
@pytest.mark.parametrize("shape", [Sphere(0.1), Box((0.2, 0.2, 0.2)), Capsule(0.05, 0.1), ConvexHull(CUBE)])
def test_a_body_that_starts_at_rest_on_the_floor_can_leave_it(gap: float, shape: Shape) -> None:
    """A start that is accepted as free must not be a trap, also when it touches to rounding."""
    scene = hand_scene((0.0, 0.0, 0.1 + gap), FLOOR, shape=(Piece(shape),))
    engine = loaded(scene)
    above = at(scene.first_sample, (0.3, 0.0, 0.5))
    for _ in range(10):
        record = engine.advance(above, DT)
    assert link_error(scene, record, above) < 1e-9


@pytest.mark.parametrize("sink", [0.0, 0.002, 0.1])
def test_a_body_that_starts_at_rest_on_the_floor_can_slide_on_it(sink: float) -> None:
    """The tracker moves sideways and never up: a body in exact contact has to find its own way off the floor."""
    scene = hand_scene((0.0, 0.0, 0.1), FLOOR, shape=(Piece(Box((0.2, 0.2, 0.2))),))
    go = ride(scene)
    for _ in range(30):
        go.frame(at(scene.first_sample, (0.3, 0.1, 0.1 - sink)))
    assert go.place("hand") == pytest.approx([0.3, 0.1, 0.1], abs=0.01)


def test_a_wedge_with_a_trembling_tracker() -> None:
    """A hull pressed into a V-shaped groove stays apart from both sides for hundreds of frames."""

    def side(sign: float) -> Body:
        turn = turned(Y, sign * 0.35)
        x, y, z = rotation.rotate(turn, (sign * 0.5, 0.0, 0.9)).tolist()
        return fixed(f"side{sign:+.0f}", (Piece(Box((1.0, 2.0, 2.0))),), "wood", (x, y, z), turn)

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
    """Return a ball and, hinged to it, a tip without pieces: a marker."""
    shape = (Piece(Sphere(0.1)),)
    mass = solid(shape, 1.0)
    return Avatar("a", (Link("ball", None, Free(), shape, mass), Link("tip", "ball", Hinges((Hinge(X),)), (), mass)))


@pytest.mark.filterwarnings("default")
def test_a_link_without_pieces_glues_nothing_to_the_floor() -> None:
    """It slides along the floor below which the tracker is; a weight of 0 or nan would hold it where it landed."""
    floor = block("floor", (0.0, 0.0, -0.65), (4.0, 4.0, 1.0))
    go = ride(Scene("s", (floor,), (ghost_tip(),), narrow=("friction",)))
    for k in range(60):
        go.frame(at(go.scene.first_sample, (0.01 * min(k, 29), 0.0, -0.3)))
    assert go.record.shown.positions[1] == pytest.approx([0.29, 0.0, -0.05], abs=0.02)


@pytest.mark.parametrize("far", [1e9, 1e150, 1.7e308])
def test_a_tracker_at_the_end_of_the_number_range_does_no_harm(far: float) -> None:
    """The samples are finite, so they are valid; the avatar need not arrive, but it must stay a pose and come home."""
    scene = hand_scene((0.0, 0.0, 0.0))
    engine = loaded(scene)
    for x in (far, -far):
        for _ in range(25):
            record = engine.advance(at(scene.first_sample, (x, 0.0, 0.0)), DT)
            assert np.isfinite(record.shown.positions).all()
    for _ in range(25):
        record = engine.advance(scene.first_sample, DT)
    assert link_error(scene, record, scene.first_sample) < 1e-6



def drawn_at_a_wall(seed: int) -> tuple[Scene, list[TrackerSample]]:
    """Return a scene with an endless wall within reach, and a motion drawn by the seed that leads beyond it."""
    scenario = unseen.get("unseen_wall").as_run(full=False)
    scene = scenario.build()
    motion = scenario.motion(scene, seed)
    return scene, [motion(k) for k in range(scenario.frames)]


def shown(scene: Scene, samples: list[TrackerSample], dt: float = DT) -> np.ndarray:
    """Return link origins (F+1, L, 3) of the states shown."""
    engine = AvatarsimEngine()
    records = [engine.load(scene, Settings(), dt), *(engine.advance(sample, dt) for sample in samples)]
    return np.array([record.shown.positions[len(scene.bodies) :] for record in records])


@pytest.mark.parametrize("frame", [320, 393, 460])
def test_limbs_at_a_wall_rest_when_the_user_does(frame: int) -> None:
    """Without the curvature of contact forces the arms went on to swing by 20 to 130 mm a frame."""
    scene, samples = drawn_at_a_wall(5)
    places = shown(scene, samples[:frame] + [samples[frame - 1]] * 90)
    user, _ = link_poses_each(scene.avatars, [samples[frame - 1]])
    assert np.linalg.norm(places[frame] - user[0], axis=-1).max() > 0.4, "something has to be in the way"
    ways = np.linalg.norm(np.diff(places[-60:], axis=0), axis=-1)
    assert ways.max() < 0.015 and ways[-10:].max() < 5e-3
    assert not shaking(reversals(places[-60:], np.repeat(user, 60, axis=0)), DT).any()


@pytest.mark.parametrize("slower", [1, 4])
def test_limbs_at_a_wall_do_not_shake_while_the_user_moves(slower: int) -> None:
    """Of six seconds, in most of which the user is beyond the wall, they shook in a third."""
    scene, samples = drawn_at_a_wall(5)
    roots = np.array([sample.positions[0] for sample in samples])
    part = samples[180:480]
    if slower > 1:
        # the same places, each held while the root goes a part of the way to the next
        part = [
            replace(sample, positions=sample.positions + np.eye(len(sample.positions))[:, :1] * (k / slower) * (after - before))
            for sample, before, after in zip(samples[180:255], roots[180:255], roots[181:256], strict=True)
            for k in range(slower)
        ]
    places = shown(scene, samples[:180] + part)
    user, _ = link_poses_each(scene.avatars, [samples[179], *part])
    assert np.mean(shaking(reversals(places[180:], user), DT)) < 0.03

"""PhysX's adapter: laws of contact and friction, joint limits, filtered pairs, and runs that repeat to the bit."""

from typing import Any

import numpy as np
import pytest

from avatarsim.engine import FrameRecord, Settings
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import ContactLaw, PairTable, fixed, simulated, solid
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, Rigid, Slide, SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from reference.collision_groups import BITS
from tests.agreement.runs import FRAME, depths, idle, limit_excess, played
from tests.agreement.scenes import (
    ball_on_slab,
    bodies_of_all_shapes,
    every_joint,
    hand_over_table,
    posture,
    pressed,
    rotation_of_z_to_x,
)

engine_module = pytest.importorskip("reference.in_physx.engine", exc_type=ImportError)

SINGLE = 1e-6
"""A few times the rounding of metres and quaternions in single precision."""
BALL = (Piece(Sphere(0.05)),)
TUNED = Settings("tuned")


def engine() -> Any:
    """Return a fresh engine."""
    return engine_module.PhysxEngine()


def held(joint: Hinges | Slide | Ball | Rigid) -> Avatar:
    """Return a floating hand with a limb on a joint."""
    palm, limb = (Piece(Box((0.1, 0.1, 0.1))),), (Piece(Capsule(0.03, 0.2), (0.2, 0.0, 0.0), rotation_of_z_to_x()),)
    return Avatar("arm", (
        Link("palm", None, Free(), palm, solid(palm, 1.0)),
        Link("limb", "palm", joint, limb, solid(limb, 1.0), anchor=(0.1, 0.0, 0.0)),
    ))


def sample(turn: np.ndarray, angles: list[float], time: float = 0.0) -> TrackerSample:
    """Return a sample of a still palm at 1 m and a limb at a rotation or at joint angles."""
    return TrackerSample(time, np.tile((0.0, 0.0, 1.0), (2, 1)), np.array([rotation.IDENTITY, turn]), np.array(angles))


def pulled(avatar: Avatar, turn: tuple[float, float, float], angles: list[float], frames: int = 60
           ) -> tuple[Scene, list[FrameRecord]]:
    """Return a run whose user turns the limb to the target in half the time and then holds it; targets are not clamped."""
    start = sample(np.array(rotation.IDENTITY), [0.0] * len(angles))
    scene = Scene("pulled", avatars=(avatar,), gravity=(0.0, 0.0, 0.0), start=start)
    shares = np.minimum(1.0, np.arange(1, frames + 1) / (0.5 * frames))
    samples = [
        sample(rotation.from_rotation_vector(s * np.array(turn)), [float(s * a) for a in angles], (k + 1) * FRAME)
        for k, s in enumerate(shares)
    ]
    return scene, played(engine(), scene, samples, Settings("tuned", {"clamp_targets": False}))


def of_limb(records: list[FrameRecord]) -> np.ndarray:
    """Return the rotation (w, x, y, z) of the limb in the palm's frame, at the end."""
    palm, limb = records[-1].shown.orientations
    turn: np.ndarray = rotation.multiply(rotation.conjugate(palm), limb)
    return turn


@pytest.mark.parametrize(("restitution", "frames"), [(0.5, 37), (1.0, 42)])
def test_a_ball_leaves_with_its_restitution(restitution: float, frames: int) -> None:
    """Frames end after the first apex and before the second impact."""
    table = PairTable({("ball", "floor"): ContactLaw(restitution, 0.0), ("ball", "ball"): ContactLaw(0.0, 0.0),
                       ("floor", "floor"): ContactLaw(0.0, 0.0)})
    floor = fixed("floor", (Piece(Box((2.0, 2.0, 0.1))),), "floor", (0.0, 0.0, -0.05))
    scene = Scene("bounce", (floor, simulated("ball", BALL, "ball", solid(BALL, 0.2), (0.0, 0.0, 0.55))), materials=table)
    records = played(engine(), scene, idle(scene, frames), Settings("tuned", record_inside=True))
    heights = np.array([snapshot.positions[1, 2] for record in records[1:] for snapshot in record.inside])
    lowest = int(heights.argmin())
    assert heights[lowest:].max() - 0.05 == pytest.approx(restitution**2 * 0.5, abs=2e-3)
    assert depths(scene, records).max() < SINGLE


@pytest.mark.parametrize(("angle", "slides"), [(26.0, False), (27.2, True)])
def test_a_box_slides_on_an_incline_above_the_angle_of_friction(angle: float, slides: bool) -> None:
    """With friction 0.5 it is 26.57 degrees; the incline is gravity turned."""
    table = PairTable({("box", "floor"): ContactLaw(0.0, 0.5), ("box", "box"): ContactLaw(0.0, 0.5),
                       ("floor", "floor"): ContactLaw(0.0, 0.5)})
    piece = (Piece(Box((0.2, 0.2, 0.1))),)
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 0.1))),), "floor", (0.0, 0.0, -0.05))
    slope, g = np.radians(angle), 9.81
    scene = Scene("incline", (floor, simulated("box", piece, "box", solid(piece, 1.0), (0.0, 0.0, 0.05))), materials=table,
                  gravity=(g * np.sin(slope), 0.0, -g * np.cos(slope)))
    moved = played(engine(), scene, idle(scene, 60), TUNED)[-1].shown.positions[1, 0]
    law = 0.5 * g * (np.sin(slope) - 0.5 * np.cos(slope)) if slides else 0.0
    assert moved == pytest.approx(law, abs=5e-4 + 0.02 * law)


def test_a_hinge_stops_at_its_limits() -> None:
    joint = Hinges((Hinge((0.0, 1.0, 0.0), -0.3, 0.5),))
    for asked, limit in ((1.2, 0.5), (-1.2, -0.3)):
        _, records = pulled(held(joint), (0.0, 0.0, 0.0), [asked])
        assert records[-1].angles[0] == pytest.approx(limit, abs=2e-3)


def test_a_slide_stops_at_its_limits_and_does_not_turn() -> None:
    _, records = pulled(held(Slide((0.6, 0.0, 0.8), -0.1, 0.2)), (0.0, 0.0, 0.0), [0.5])
    assert records[-1].angles[0] == pytest.approx(0.2, abs=1e-3)
    assert np.abs(of_limb(records)[1:]).max() < 1e-3


@pytest.mark.parametrize("diagonal", [0.0, 45.0, 90.0, 200.0])
def test_a_swing_cone_is_round(diagonal: float) -> None:
    """The limit is 40 degrees in any direction, also between the axes, where limits about two axes would be wider by a third."""
    limits = SwingTwist((1.0, 0.0, 0.0), (1.0, 0.0, 0.0), np.radians(40.0), (-0.4, 0.6))
    axis = 1.2 * np.array([0.0, np.cos(np.radians(diagonal)), np.sin(np.radians(diagonal))])
    scene, records = pulled(held(Ball(limits)), tuple(axis), [])
    limb = rotation.rotate(of_limb(records), (1.0, 0.0, 0.0))
    assert np.degrees(np.arccos(limb[0])) == pytest.approx(40.0, abs=0.3)
    assert limit_excess(scene, records).max() < 0.3


def test_twist_stops_at_its_limits() -> None:
    limits = SwingTwist((1.0, 0.0, 0.0), (1.0, 0.0, 0.0), np.radians(40.0), (-0.4, 0.6))
    scene, records = pulled(held(Ball(limits)), (1.5, 0.0, 0.0), [])
    assert 2.0 * np.arctan2(*of_limb(records)[[1, 0]]) == pytest.approx(0.6, abs=2e-3)
    assert limit_excess(scene, records).max() < 0.3


def test_a_posture_that_is_held_stays() -> None:
    """Every joint at once: the constraints of hinges, rigid links and links between hinges do not conflict."""
    avatar = every_joint()
    start = posture(avatar, 0)
    scene = Scene("held", avatars=(avatar,), start=start, gravity=(0.0, 0.0, 0.0), narrow=("self_contact", "limits"))
    samples = [TrackerSample(k * FRAME, start.positions, start.rotations, start.angles) for k in range(1, 31)]
    records = played(engine(), scene, samples, Settings("tuned", {"clamp_targets": False}))
    assert np.abs(records[-1].shown.positions - records[0].shown.positions).max() < 1e-4
    assert np.abs(records[-1].angles - start.angles).max() < 1e-4


def test_pairs_that_the_scene_lets_pass_do_not_meet() -> None:
    """One of two balls above a slab is excluded from contact with it and falls freely."""
    slab, other = ball_on_slab().bodies[0], (0.5, 0.0, 0.55)
    balls = [simulated(name, BALL, "wood", solid(BALL, 0.2), at) for name, at in (("stays", (0.0, 0.0, 0.55)), ("falls", other))]
    scene = Scene("pass", (slab, *balls), exclude=(("slab", "falls"),))
    shown = played(engine(), scene, idle(scene, 60), TUNED)[-1].shown
    assert shown.positions[1, 2] > 0.049
    assert shown.positions[2, 2] == pytest.approx(0.55 - 0.5 * 9.81, abs=0.02)


def test_refuses_scenes_of_too_many_groups_before_loading() -> None:
    names = [f"b{k}" for k in range(BITS + 4)]
    bodies = tuple(simulated(name, BALL, "wood", solid(BALL, 1.0), (0.2 * k, 0.0, 0.0)) for k, name in enumerate(names))
    draw = np.random.default_rng(1)
    pairs = tuple((names[k], names[j]) for k in range(len(names)) for j in range(k) if draw.uniform() < 0.5)
    scene = Scene("many", bodies, exclude=pairs)
    assert "scene" in engine().unsupported(scene)
    assert "scene" not in engine().unsupported(bodies_of_all_shapes())


@pytest.mark.parametrize("preset", ["default", "tuned"])
def test_a_run_repeats_to_the_bit_in_one_process(preset: str) -> None:
    """Between the two runs another scene runs with other settings, which are global to the process."""
    scene, other = hand_over_table(), ball_on_slab(gravity=1.0)
    samples = [pressed(k) for k in range(1, 41)]
    first = [record.state_hash() for record in played(engine(), scene, samples, Settings(preset))]
    played(engine(), other, idle(other, 3), Settings("default", {"tgs": False, "bounce_threshold": 1.0}))
    assert [record.state_hash() for record in played(engine(), scene, samples, Settings(preset))] == first


def test_features_without_a_counterpart_are_reported() -> None:
    egg = (Piece(Ellipsoid((0.1, 0.2, 0.3))),)
    assert "ellipsoids" in engine().unsupported(Scene("egg", (simulated("egg", egg, "wood", solid(egg, 1.0)),)))
    assert "shared centres" in engine().unsupported(Scene("all", avatars=(every_joint(),)))
    wide = held(Hinges((Hinge((0.0, 1.0, 0.0), -4.0, 4.0),)))
    assert "ranges of a turn or more" in engine().unsupported(Scene("wide", avatars=(wide,)))


@pytest.mark.parametrize("thickness", [0.1, 1e-3, 1e-6])
@pytest.mark.parametrize("size", [1.0, 1e-3])
def test_hulls_keep_their_vertices_however_thin_or_small(thickness: float, size: float) -> None:
    """By default the package merges vertices that are 0.7 mm apart."""
    corners = np.array(np.meshgrid(*3 * [[-1.0, 1.0]])).reshape(3, -1).T * (0.5, 0.3, thickness)
    points = size * (rotation.rotate(rotation.normalised(np.array((0.3, 0.5, -0.7, 0.2))), corners) + (0.1, 0.2, 0.3))
    piece = (Piece(ConvexHull(points)),)
    made = engine()
    made.load(Scene("hull", (fixed("hull", piece, "wood", (0.0, 0.0, 0.0)),)), TUNED, FRAME)
    [shape] = made._world.actors[0].collision_shapes
    pose = shape.local_pose
    found = rotation.rotate(rotation.normalised(np.array(pose.q)), np.array(shape.vertices) * shape.scale) + np.array(pose.p)
    assert len(found) == 8
    assert max(np.linalg.norm(found - point, axis=1).min() for point in points) < size * SINGLE


def test_hulls_that_the_package_thins_are_reported() -> None:
    for vertices, told in ((129, False), (200, True)):
        piece = (Piece(ellipsoid_hull((0.1, 0.2, 0.3), vertices)),)
        scene = Scene("egg", (simulated("egg", piece, "wood", solid(piece, 1.0)),))
        assert ("large hulls" in engine().unsupported(scene)) == told

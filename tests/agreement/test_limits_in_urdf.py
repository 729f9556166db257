"""Bullet's own limits of ball joints: active in an avatar loaded from a file, which else equals the one made by calls."""

from typing import Any

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.joint import Ball, Rigid, SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Shape, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.spatial import rotation
from scenarios import catalog
from scenarios.measure.posture.limits import swing_twist
from tests.agreement.rivals import PybulletEngine, needs_pybullet, pybullet
from tests.agreement.runs import idle, loaded, of_catalog, played, poses
from tests.agreement.scenes import every_joint, turned

pytestmark = needs_pybullet

TWIST = (-0.3, 0.7)
LIMBS: tuple[tuple[Shape, Vector], ...] = (
    (Capsule(0.03, 0.3), (0.0, 0.0, 1.0)), (Box((0.3, 0.1, 0.05)), (-1.0, 0.0, 0.0)), (Sphere(0.1), (0.6, 0.8, 0.0)),
)
FRAMES = 40


def arm(shape: Shape, axis: Vector, swing: float) -> Scene:
    """Return a limb along `axis` on a fixed post; no part has the position or orientation of its frame."""
    pieces, post = (Piece(shape, (0.1, 0.0, 0.05)),), (Piece(Sphere(0.05)),)
    ball = Ball(SwingTwist(axis, (0.6, 0.0, 0.8), swing, TWIST))
    links = (
        Link("post", None, Rigid(), post, solid(post, 5.0), anchor=(0.0, 0.0, 1.0), orientation=turned(5)),
        Link("limb", "post", ball, pieces, solid(pieces, 2.0), anchor=(0.2, 0.0, 0.1), orientation=turned(6)),
    )
    return Scene("arm", (), (Avatar("arm", links, ignore=(("post", "limb"),)),), gravity=(0.0, 0.0, 0.0))


def reached(scene: Scene, swing: float, twist: float, options: dict[str, object]) -> tuple[float, float]:
    """Return the swing and twist [rad] of the limb after its user has held other targets for some time."""
    link = scene.links[1]
    assert isinstance(link.joint, Ball) and link.joint.limits is not None
    limits = link.joint.limits
    across = np.cross(limits.centre, (0.0, 1.0, 0.0))
    asked = rotation.multiply(
        rotation.from_axis_angle(across, swing),
        rotation.multiply(rotation.between(limits.axis, limits.centre), rotation.from_axis_angle(limits.axis, twist)),
    )
    goal = rest(scene.avatars)
    goal.rotations[1] = rotation.multiply(rotation.conjugate(link.orientation), asked)
    samples = [TrackerSample((k + 1) / 60.0, goal.positions, goal.rotations, goal.angles) for k in range(FRAMES)]
    records = played(PybulletEngine(), scene, samples, Settings("default", {"ball_gain": 0.5, "ball_force": 20.0, **options}))
    turns = poses(records)[1][-1]
    found = swing_twist(limits, rotation.multiply(rotation.conjugate(turns[0]), turns[1]))
    return float(found[0]), float(found[1])


@pytest.mark.parametrize(("shape", "axis"), LIMBS, ids=[type(shape).__name__ for shape, _ in LIMBS])
@pytest.mark.parametrize(("asked", "wanted"), [((0.4, 0.6), (0.4, 0.6)), ((0.0, 1.5), (0.0, 0.7)), ((0.0, -1.0), (0.0, -0.3))])
def test_a_limb_stops_at_its_own_twist_on_either_side(shape: Shape, axis: Vector, asked: tuple[float, float],
                                                      wanted: tuple[float, float]) -> None:
    assert reached(arm(shape, axis, 0.6), *asked, {}) == pytest.approx(wanted, abs=0.02)


@pytest.mark.parametrize(("shape", "axis"), LIMBS, ids=[type(shape).__name__ for shape, _ in LIMBS])
def test_a_limb_stops_between_its_cone_and_the_pyramid_about_it(shape: Shape, axis: Vector) -> None:
    swing, _ = reached(arm(shape, axis, 0.6), 1.4, 0.2, {})
    assert 0.6 - 0.01 <= swing <= np.arccos(np.cos(0.6) ** 2) + 0.01
    assert reached(arm(shape, axis, 0.6), 1.4, 0.2, {"ball_limits": False})[0] > 1.2


def test_a_cone_wider_than_a_right_angle_does_not_throw_a_limb() -> None:
    assert reached(arm(*LIMBS[0], 2.0), 1.7, 0.2, {}) == pytest.approx((1.7, 0.2), abs=0.02)


def inertia(engine: Any, k: int) -> np.ndarray:
    """Return the mass [kg] and inertia [kg m^2] of a link in Bullet, along its own axes."""
    part = engine._world.parts[k]
    found = pybullet.getDynamicsInfo(part.body, part.link, physicsClientId=engine._client)
    axes = rotation.to_matrix(part.frame)
    return np.append(axes @ np.diag(found[2]) @ axes.T, found[0])


@pytest.mark.parametrize("preset", ["default", "tuned"])
@pytest.mark.parametrize("name", ["every_joint", "arms_lift"])
def test_a_file_and_calls_make_the_same_avatar(name: str, preset: str) -> None:
    scene = catalog.get(name).build() if name == "arms_lift" else Scene("all", (), (every_joint(),))
    by_file, by_calls = (loaded(PybulletEngine(), scene, Settings(preset, {"ball_limits": own})) for own in (True, False))
    for k in range(len(scene.bodies), len(scene.names)):
        assert np.allclose(inertia(by_file, k), inertia(by_calls, k), rtol=1e-12, atol=1e-15)
    shown = [engine._reading.snapshots([0.0], [engine._reading.raw()])[0] for engine in (by_file, by_calls)]
    assert np.allclose(shown[0].positions, shown[1].positions, atol=1e-12)
    assert np.allclose(np.abs(np.sum(shown[0].orientations * shown[1].orientations, axis=1)), 1.0, atol=1e-12)
    by_file.close()
    by_calls.close()


def test_both_move_alike_where_no_limit_is_near() -> None:
    settings = [Settings("tuned", {"ball_limits": own}) for own in (True, False)]
    runs = [poses(of_catalog(PybulletEngine(), "arms_lift", own, 20)[1]) for own in settings]
    assert np.abs(runs[0][0] - runs[1][0]).max() < 1e-5


def test_an_avatar_without_limited_balls_is_made_by_calls() -> None:
    scene = catalog.get("hand_over_table").build()
    settings = [Settings("tuned", {"ball_limits": own}) for own in (True, False)]
    runs = [poses(played(PybulletEngine(), scene, idle(scene, 5), own)) for own in settings]
    assert (runs[0][0] == runs[1][0]).all()

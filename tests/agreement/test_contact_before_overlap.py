"""PyBullet's contacts act before bodies meet, for any shape at any place in its body. Only then a limb pressed against a wall
stays outside. A shape in a compound, and a box against a box, have contacts only while they overlap.
"""

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.scene.avatar import Avatar, Link, rigid_avatar
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.joint import Ball
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from reference.judging.judge import Judge
from tests.agreement.rivals import PybulletEngine, needs_pybullet, pybullet
from tests.agreement.runs import FRAME, loaded
from tests.agreement.scenes import turned

GAP = 3e-4
"""Gap [m] to the wall: below Bullet's threshold of 2 % of a shape's size, for shapes of 0.1 m."""

HULL = ConvexHull(np.random.default_rng(3).normal(size=(20, 3)) * 0.1 + np.array([0.05, 0.0, 0.02]))
AT, TURN = (0.05, -0.02, 0.03), turned(11)
"""Position of the piece in its body: far from the frame."""
SHAPES = (Sphere(0.1), Capsule(0.05, 0.2), HULL, Ellipsoid((0.08, 0.1, 0.12)), Box((0.1, 0.2, 0.3)))
WALL = fixed("wall", (Piece(Box((1.0, 4.0, 4.0))),), "wood", (1.5, 0.0, 0.0))


def contacts(scene: Scene, options: dict[str, object]) -> int:
    """Return the number of contacts after one step without gravity; none of them moves a body."""
    engine = loaded(PybulletEngine(), scene, Settings("tuned", {"dt": FRAME, "processing_threshold": 1.0, **options}))
    pybullet.stepSimulation(physicsClientId=engine._client)
    found = len(pybullet.getContactPoints(physicsClientId=engine._client))
    engine.close()
    return found


def near_the_wall(shape: Shape, driven: bool, pieces: int = 1) -> Scene:
    """Return a body, or a one-link avatar, of one piece (or two equal ones), GAP before the wall."""
    parts = (Piece(shape, AT, TURN),) * pieces

    def placed(x: float) -> Scene:
        if not driven:
            body = simulated("thing", parts, "wood", solid(parts, 1.0), (x, 0.0, 0.0))
            return Scene("near", (WALL, body), gravity=(0.0, 0.0, 0.0))
        hand = rigid_avatar("thing", parts, solid(parts, 1.0))
        sample = rest((hand,))
        start = TrackerSample(0.0, np.array([[x, 0.0, 0.0]]), sample.rotations, sample.angles)
        return Scene("near", (WALL,), (hand,), start=start, gravity=(0.0, 0.0, 0.0))

    far = placed(0.0)
    where = np.array([[1.5, 0.0, 0.0], [0.0, 0.0, 0.0]])
    gap = Judge(far).overlaps(where, np.array([[1.0, 0.0, 0.0, 0.0]] * 2), reach=2.0).gap
    return placed(gap - GAP)


@needs_pybullet
@pytest.mark.parametrize("driven", [False, True], ids=["simulated", "driven"])
@pytest.mark.parametrize("shape", SHAPES, ids=[type(shape).__name__ for shape in SHAPES])
def test_one_piece_is_met_before_it_overlaps(shape: Shape, driven: bool) -> None:
    # a box that is not driven stays a box, and two boxes make no contact before they overlap
    met = driven or not isinstance(shape, Box)
    assert (contacts(near_the_wall(shape, driven), {}) > 0) is met


@needs_pybullet
@pytest.mark.parametrize("shape", SHAPES, ids=[type(shape).__name__ for shape in SHAPES])
def test_two_driven_pieces_are_met_once_each_before_overlap(shape: Shape) -> None:
    once = contacts(near_the_wall(shape, True), {})
    assert contacts(near_the_wall(shape, True, pieces=2), {}) == 2 * once > 0


@needs_pybullet
def test_a_limb_below_a_ball_joint_is_met_before_it_overlaps() -> None:
    """The capsule of a limb lies across its link's frame, with its centre next to the joint."""
    piece = Piece(Capsule(0.05, 0.2), (0.15, 0.0, 0.0), (float(np.sqrt(0.5)), 0.0, float(np.sqrt(0.5)), 0.0))
    limb = Link("limb", None, Ball(), (piece,), solid((piece,), 1.0), anchor=(1.0 - 0.3 - GAP, 0.0, 0.0))
    scene = Scene("limb", (WALL,), (Avatar("one", (limb,)),), gravity=(0.0, 0.0, 0.0))
    assert contacts(scene, {}) > 0

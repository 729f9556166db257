"""Projection of balls into their limits, against the arrays' definition of these and against the engine's own projection."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.assets.models.ball_limits import ball_excess
from avatarsim.live.drive.limits import inside, limits_of
from avatarsim.live.drive.turns import exp, norm, way
from avatarsim.live.stages import body, stage
from avatarsim.model.joint_limits import inside_cone
from avatarsim.model.skeleton import skeleton
from avatarsim.scene.joint import Ball, ReachCone, SwingTwist
from avatarsim.spatial import rotation

angle = st.floats(-3.1, 3.1)
BALLS = [link.joint for link in body()[0].links if isinstance(link.joint, Ball) and link.joint.limits is not None]

NAMES = [link.name for link in body()[0].links if isinstance(link.joint, Ball) and link.joint.limits is not None]
SKELETON = skeleton(stage("gallery").scene)


@given(st.sampled_from(BALLS), st.tuples(angle, angle, angle))
def test_what_comes_out_is_inside_and_what_is_inside_stays(joint: Ball, vector: tuple[float, float, float]) -> None:
    limits, turned = limits_of(joint, rotation.IDENTITY), exp(vector)
    found = inside(limits, turned)
    assert ball_excess(joint, np.array([found]))[0] <= 1e-9
    assert norm(way(inside(limits, found), found)) < 1e-6
    if ball_excess(joint, np.array([turned]))[0] == 0.0:
        assert norm(way(found, turned)) < 1e-6


@given(st.integers(0, len(BALLS) - 1), st.tuples(angle, angle, angle))
def test_it_is_where_the_engine_puts_it(number: int, vector: tuple[float, float, float]) -> None:
    scene = stage("gallery").scene
    joint = BALLS[number]
    link = next(k for k, one in enumerate(scene.links) if one.joint.__class__ is Ball and one.name == NAMES[number])
    limits, turned = limits_of(joint, rotation.IDENTITY), exp(vector)
    matrix = rotation.to_matrix(turned)
    engine = inside_cone(SKELETON, link, tuple(tuple(float(v) for v in matrix[:, c]) for c in range(3)))
    theirs = rotation.from_matrix(np.array(engine).T)
    # where the limb is as near to two edges, or the twist to both ends, either answer is right
    way_there = rotation.to_rotation_vector(rotation.multiply(theirs, rotation.conjugate(turned)))
    assert norm(way(turned, inside(limits, turned))) <= float(np.linalg.norm(way_there)) + 0.02


def test_a_ball_with_a_polygon_alone_keeps_its_limb_in_it() -> None:
    corners = np.array([(1.0, 1.0, 1.0), (-1.0, 1.0, 1.0), (-1.0, -1.0, 1.0), (1.0, -1.0, 1.0)])
    joint = Ball(cone=ReachCone(corners, (0.0, 0.0, 1.0)))
    limits = limits_of(joint, rotation.IDENTITY)
    limb = rotation.rotate(inside(limits, exp((2.0, 0.0, 0.0))), (0.0, 0.0, 1.0))
    assert limb[1] == pytest.approx(-np.sqrt(0.5), abs=1e-5)
    assert limb[2] == pytest.approx(np.sqrt(0.5), abs=1e-5)


def test_a_joint_without_room_is_put_where_it_must_be() -> None:
    joint = Ball(SwingTwist((0.0, 0.0, 1.0), (0.0, 0.0, 1.0), 0.0, (0.3, 0.3)))
    limits = limits_of(joint, rotation.IDENTITY)
    assert np.allclose(inside(limits, exp((0.4, 0.2, -0.5))), exp((0.0, 0.0, 0.3)), atol=1e-6)
    assert limits_of(Ball(), rotation.IDENTITY) is None

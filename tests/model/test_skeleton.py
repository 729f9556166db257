"""Links as arrays: degrees of freedom, limits, cones, which link moves which."""

import numpy as np
import pytest

from avatarsim.model.skeleton import BALL, FREE, HINGES, RIGID, UNLIMITED, hinge_dofs, skeleton
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, Rigid, SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Piece, Sphere
from tests.stability.hostile import hinged_avatar, walls

PIECES = (Piece(Sphere(0.1)),)
MASS = solid(PIECES, 1.0)
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
LIMITS = SwingTwist(Z, (0.6, 0.0, 0.8), 0.5, (-0.25, 0.75))


def mixed() -> Avatar:
    """root (free) - a (ball) - b (two hinges) - c (rigid); root - d (one hinge)."""
    return Avatar("m", (
        Link("root", None, Free(), PIECES, MASS),
        Link("a", "root", Ball(LIMITS), PIECES, MASS, anchor=(0.0, 0.0, 1.0)),
        Link("b", "a", Hinges((Hinge(X, -1.0, 0.5), Hinge(Y, -2.0, 2.0))), PIECES, MASS),
        Link("c", "b", Rigid(), PIECES, MASS),
        Link("d", "root", Hinges((Hinge(Z, 0.0, 1.0),)), PIECES, MASS),
    ))


SKEL = skeleton(Scene("s", avatars=(mixed(),)))


def test_degrees_follow_the_joints() -> None:
    assert SKEL.kind.tolist() == [FREE, BALL, HINGES, RIGID, HINGES]
    assert SKEL.first_dof.tolist() == [0, 6, 9, 11, 11, 12]
    assert SKEL.parent.tolist() == [-1, 0, 1, 2, 0]
    assert SKEL.axis[9:].tolist() == [list(X), list(Y), list(Z)]
    assert SKEL.limits[9:].tolist() == [[-1.0, 0.5], [-2.0, 2.0], [0.0, 1.0]]
    assert (SKEL.limits[:9] == [-UNLIMITED, UNLIMITED]).all()
    assert hinge_dofs(SKEL).tolist() == [9, 10, 11]
    assert SKEL.anchor[1].tolist() == [0.0, 0.0, 1.0]


    # ancestors move a link, and nobody else does
    assert [np.flatnonzero(row).tolist() for row in SKEL.related] == [[0], [0, 1], [0, 1, 2], [0, 1, 2, 3], [0, 4]]


def test_limits_of_a_ball_are_kept_with_what_their_tests_need() -> None:
    balls = SKEL.balls
    assert balls.is_limited.tolist() == [False, True, False, False, False]
    assert balls.axis[1].tolist() == list(Z) and balls.centre[1] == pytest.approx([0.6, 0.0, 0.8])
    assert (balls.swing_cosine[1], balls.swing_sine[1]) == (np.cos(0.5), np.sin(0.5)) and balls.twist[1].tolist() == [-0.25, 0.75]
    assert balls.untwist[1] @ LIMITS.centre == pytest.approx(LIMITS.axis) and (balls.untwist[0] == np.eye(3)).all()
    assert balls.probe[1] @ balls.centre[1] == pytest.approx(0.0, abs=1e-15)
    assert np.linalg.norm(balls.probe[1]) == pytest.approx(1.0)
    assert balls.untwisted[1] == pytest.approx(balls.untwist[1] @ balls.probe[1])
    assert balls.twist_low[1] == pytest.approx([np.cos(-0.25), np.sin(-0.25)])
    assert balls.twist_high[1] == pytest.approx([np.cos(0.75), np.sin(0.75)])


def test_without_the_effect_nothing_is_limited() -> None:
    skel = skeleton(Scene("s", avatars=(mixed(),), narrow=("limits",)))
    assert (np.abs(skel.limits) == UNLIMITED).all() and not skel.balls.is_limited.any()


def test_two_avatars_come_one_after_the_other() -> None:
    skel = skeleton(Scene("s", walls(), (mixed(), hinged_avatar())))
    assert skel.first == 6
    assert skel.parent[5] == -1 and skel.parent[6] == 5 and skel.first_dof[-1] == 12 + 43
    assert not skel.related[5:, :5].any() and not skel.related[:5, 5:].any()
    assert len(hinge_dofs(skel)) == 3 + 37

"""Links as arrays: degrees of freedom, limits, cones, which link moves which."""

import numpy as np
import pytest

from avatarsim.model.skeleton import BALL, FREE, HINGES, RIGID, UNLIMITED, hinge_dofs, skeleton, twist_told
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


def test_a_cone_is_kept_as_cosines_sines_and_a_normal() -> None:
    assert SKEL.cone[1, :10] == pytest.approx([*Z, 0.6, 0.0, 0.8, np.cos(0.5), np.sin(0.5), -0.25, 0.75])
    assert SKEL.untwist[1] @ LIMITS.centre == pytest.approx(LIMITS.axis)
    assert (SKEL.cone[[0, 2, 3, 4], 6] == -2.0).all() and (SKEL.untwist[0] == np.eye(3)).all()
    aside, untwisted = SKEL.cone[1, 10:13], SKEL.cone[1, 13:16]
    assert aside @ SKEL.cone[1, 3:6] == pytest.approx(0.0, abs=1e-15) and aside @ aside == pytest.approx(1.0)
    assert untwisted == pytest.approx(SKEL.untwist[1] @ aside)
    assert SKEL.cone[1, 16:] == pytest.approx([np.cos(-0.25), np.sin(-0.25), np.cos(0.75), np.sin(0.75)])
    assert twist_told(np.array(Z), np.eye(3), -4.0, 1.0)[6:] == [0.0] * 4, "an end beyond half a turn has no sine of its own"


def test_without_the_effect_nothing_is_limited() -> None:
    skel = skeleton(Scene("s", avatars=(mixed(),), narrow=("limits",)))
    assert (np.abs(skel.limits) == UNLIMITED).all() and (skel.cone[:, 6] == -2.0).all()


def test_two_avatars_come_one_after_the_other() -> None:
    skel = skeleton(Scene("s", walls(), (mixed(), hinged_avatar())))
    assert skel.first == 6
    assert skel.parent[5] == -1 and skel.parent[6] == 5 and skel.first_dof[-1] == 12 + 43
    assert not skel.related[5:, :5].any() and not skel.related[:5, 5:].any()
    assert len(hinge_dofs(skel)) == 3 + 37

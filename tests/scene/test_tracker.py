"""Tracker samples: refused when they do not fit, and turned into poses by plain forward kinematics."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from avatarsim.errors import InvalidSample
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, Joint, Rigid
from avatarsim.scene.shape import Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, _sound, between, checked, link_poses, rest
from avatarsim.spatial import rotation
from tests.stability.hostile import hinged_avatar
from tests.worlds.little_worlds import random_sample

BALL = (Piece(Sphere(0.1)),)
MASS = solid(BALL, 1.0)
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
UP = (0.0, 0.0, 1.0)


def link(name: str, parent: str | None, joint: Joint, lean: float = 0.0) -> Link:
    """Return a ball one metre above its parent, its rest orientation turned about x."""
    w, x, y, z = (float(v) for v in rotation.from_axis_angle(X, lean))
    return Link(name, parent, joint, BALL, MASS, anchor=UP, orientation=(w, x, y, z))


def tree() -> Avatar:
    """Return every kind of joint: a free root, a ball, two hinges, a rigid tip, and a second branch."""
    return Avatar("tree", (
        link("root", None, Free()),
        link("ball", "root", Ball(), 0.3),
        link("hinged", "ball", Hinges((Hinge(X), Hinge(Y))), -0.7),
        link("tip", "hinged", Rigid(), 0.2),
        link("branch", "root", Hinges((Hinge(Z, 0.5, 1.0),))),
    ))


def test_rest_obeys_hinge_limits_and_is_a_valid_sample() -> None:
    sample = checked(rest((tree(), hinged_avatar())), (tree(), hinged_avatar()))
    assert sample.angles[:3] == pytest.approx([0.0, 0.0, 0.5])
    assert sample.angles.shape == (3 + 37,)


@pytest.mark.parametrize(("turned", "quick"), [(1.0, True), (1.0 + 4e-7, True), (1.0 + 8e-7, False), (1.0 - 8e-7, False)])
def test_the_thorough_check_decides_where_the_quick_one_cannot(turned: float, quick: bool) -> None:
    sample = random_sample((tree(),), 5)
    sample = replace(sample, rotations=turned * sample.rotations)
    assert _sound(sample, 5, 3) == quick
    assert checked(sample, (tree(),)) is sample
    for other in (replace(sample, time=0), replace(sample, angles=sample.angles.tolist())):
        made = checked(other, (tree(),))
        assert not _sound(other, 5, 3) and made.angles.tolist() == sample.angles.tolist() and type(made.time) is float


@pytest.mark.parametrize(("change", "part"), [
    ({"time": math.nan}, "tracker time"), ({"positions": np.zeros((4, 3))}, "(4, 3)"), ({"angles": np.zeros(2)}, "(2,)"),
    ({"positions": np.full((5, 3), math.nan)}, "tracker positions"),
    ({"angles": np.array([0.0, math.inf, 0.0])}, "tracker angles"),
    ({"rotations": np.tile([2.0, 0.0, 0.0, 0.0], (5, 1))}, "tracker rotation of link 0 is [2.0, 0.0, 0.0, 0.0]"),
    ({"rotations": np.zeros((5, 4))}, "length 1"), ({"rotations": np.ones((5, 3))}, "(5, 3)"),
    ({"rotations": np.full((5, 4), math.nan)}, "tracker rotations"),
])
def test_bad_samples_say_what_is_wrong(change: dict[str, Any], part: str) -> None:
    with pytest.raises(InvalidSample) as error:
        checked(replace(rest((tree(),)), **change), (tree(),))
    assert part in str(error.value)


@given(st.integers(0, 10_000))
def test_poses_agree_with_scipys_homogeneous_transforms(seed: int) -> None:
    """Chains of 4 x 4 matrices, written out joint by joint."""
    avatar = tree()
    sample = random_sample((avatar,), seed)

    def pose(turn: Rotation, place: Any) -> np.ndarray:
        m = np.eye(4)
        m[:3, :3], m[:3, 3] = turn.as_matrix(), place
        return m

    def joint(lean: float, turn: Rotation) -> np.ndarray:
        return pose(Rotation.from_rotvec([lean, 0, 0]) * turn, UP)

    turns = Rotation.from_quat(sample.rotations, scalar_first=True)
    a = sample.angles
    root = pose(turns[0], sample.positions[0])
    ball = root @ joint(0.3, turns[1])
    hinged = ball @ joint(-0.7, Rotation.from_euler("XY", a[:2]))
    tip = hinged @ joint(0.2, Rotation.identity())
    branch = root @ joint(0.0, Rotation.from_euler("Z", a[2]))
    positions, orientations = link_poses((avatar,), sample)
    wanted = np.array([root, ball, hinged, tip, branch])
    assert positions == pytest.approx(wanted[:, :3, 3], abs=1e-12)
    assert rotation.to_matrix(orientations) == pytest.approx(wanted[:, :3, :3], abs=1e-12)


def test_two_avatars_do_not_mix() -> None:
    first, second = tree(), hinged_avatar()
    both = random_sample((first, second), 3)
    n, h = len(first.links), first.hinge_count
    alone = TrackerSample(0.0, both.positions[n:], both.rotations[n:], both.angles[h:])
    assert link_poses((first, second), both)[0][n:] == pytest.approx(link_poses((second,), alone)[0])


def test_a_root_that_is_not_free_is_anchored_to_the_world() -> None:
    post = Avatar("post", (link("base", None, Hinges((Hinge(Z),)), 0.4),))
    sample = replace(rest((post,)), positions=np.full((1, 3), 7.0), angles=np.array([0.9]))
    positions, orientations = link_poses((post,), sample)
    assert positions[0] == pytest.approx(UP)
    wanted = Rotation.from_rotvec([0.4, 0, 0]) * Rotation.from_rotvec([0, 0, 0.9])
    assert rotation.to_matrix(orientations[0]) == pytest.approx(wanted.as_matrix())


def test_no_avatars_have_no_poses() -> None:
    assert link_poses((), rest(()))[0].shape == (0, 3)


@given(share=st.floats(0.0, 1.0), turn=st.floats(-3.0, 3.0), flip=st.sampled_from([-1.0, 1.0]))
def test_between_samples_links_turn_evenly_and_move_straight(share: float, turn: float, flip: float) -> None:
    start = TrackerSample(1.0, np.zeros((1, 3)), np.array([rotation.IDENTITY]), np.array([0.5]))
    end = TrackerSample(3.0, np.array([[1.0, -2.0, 4.0]]), flip * rotation.from_axis_angle(Z, turn)[None], np.array([-0.5]))
    found = between(start, end, share)
    assert found.time == pytest.approx(1.0 + 2.0 * share) and found.angles == pytest.approx([0.5 - share])
    assert found.positions[0] == pytest.approx([share, -2.0 * share, 4.0 * share])
    assert rotation.to_matrix(found.rotations[0]) == pytest.approx(rotation.to_matrix(rotation.from_axis_angle(Z, share * turn)))
    assert np.linalg.norm(found.rotations[0]) == pytest.approx(1.0, abs=1e-15)

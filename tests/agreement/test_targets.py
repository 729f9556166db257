"""Targets of the engines: one motion for all, equal to the plain kinematics at every instant."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.scene.joint import Ball
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, link_poses
from avatarsim.spatial import rotation
from reference.targets import Followed, Targets
from scenarios.measure.posture.limits import swing_twist
from tests.agreement.scenes import LIMITS, every_joint, posture

SCENE = Scene("targets", avatars=(every_joint(),), start=posture(every_joint(), 0))


@given(st.integers(0, 10**6), st.floats(0.0, 1.0))
def test_interpolated_postures_have_the_plain_kinematics(seed: int, fraction: float) -> None:
    start, end = posture(SCENE.avatars[0], seed), posture(SCENE.avatars[0], seed + 1)
    targets = Targets(SCENE, clamp=False)
    goals = targets.between(targets.within_limits(start), targets.within_limits(end), np.array([fraction, 1.0]))
    middle = TrackerSample(
        0.0, start.positions + fraction * (end.positions - start.positions),
        rotation.slerp(start.rotations, end.rotations, np.full(5, fraction)),
        start.angles + fraction * (end.angles - start.angles),
    )
    positions, orientations = link_poses(SCENE.avatars, middle)
    assert np.abs(goals.positions[0] - positions).max() <= 1e-12
    apart = rotation.to_rotation_vector(rotation.multiply(rotation.conjugate(orientations), goals.orientations[0]))
    assert np.abs(apart).max() <= 1e-12
    # the last step of a frame is the sample itself
    assert np.abs(goals.positions[1] - link_poses(SCENE.avatars, end)[0]).max() <= 1e-12
    assert np.abs(goals.angles[1] - end.angles).max() <= 1e-15


@given(st.integers(0, 10**6))
def test_clamps_samples_to_limits_and_leaves_free_ones(seed: int) -> None:
    draw = np.random.default_rng(seed)
    avatar = SCENE.avatars[0]
    wild = TrackerSample(
        0.0, np.zeros((5, 3)), rotation.normalised(draw.normal(size=(5, 4))), draw.uniform(-4.0, 4.0, avatar.hinge_count)
    )
    kept = Targets(SCENE, clamp=True).within_limits(wild)
    link = avatar.links[2]
    assert isinstance(link.joint, Ball)
    swing, twist = swing_twist(LIMITS, rotation.multiply(link.orientation, kept.rotations[2]))
    was_swing, was_twist = swing_twist(LIMITS, rotation.multiply(link.orientation, wild.rotations[2]))
    assert swing <= LIMITS.swing + 1e-9
    assert LIMITS.twist[0] - 1e-9 <= twist <= LIMITS.twist[1] + 1e-9
    if was_swing <= LIMITS.swing and LIMITS.twist[0] <= was_twist <= LIMITS.twist[1]:
        assert np.abs(kept.rotations[2] - wild.rotations[2]).max() <= 1e-12
    # the parts within limits stay unchanged
    assert swing == pytest.approx(min(was_swing, LIMITS.swing), abs=1e-7)
    assert twist == pytest.approx(min(max(was_twist, LIMITS.twist[0]), LIMITS.twist[1]), abs=1e-7)
    # the order of tracker angles is that of the links: "one", then the three of "three"
    assert abs(kept.angles[0]) <= 2.0 and abs(kept.angles[3]) <= 1.0
    assert kept.angles[1] == wild.angles[1]


def test_poses_ahead_go_on_as_the_motion_came() -> None:
    """A steady motion with a lead of two steps gives the position two steps later."""
    start = posture(SCENE.avatars[0], 0)
    spin = rotation.from_axis_angle((0.0, 0.0, 1.0), 0.1)
    end = TrackerSample(
        0.0, start.positions + np.array([0.1, 0.0, 0.0]),
        np.vstack([rotation.multiply(spin, start.rotations[0]), start.rotations[1:]]), start.angles,
    )
    targets = Targets(SCENE, clamp=False)
    goals = targets.between(start, end, np.array([0.0, 1.0]))
    positions, orientations = targets.ahead(goals, 2.0)
    assert np.abs(positions[0, 0] - start.positions[0] - [0.3, 0.0, 0.0]).max() <= 1e-12
    wanted = rotation.multiply(rotation.from_axis_angle((0.0, 0.0, 1.0), 0.3), start.rotations[0])
    assert np.abs(np.abs(orientations[0, 0] @ wanted) - 1.0) <= 1e-12


def test_nobody_is_led_beyond_a_limit() -> None:
    """The root moves and a hinge turns past its limit: the root continues, the hinge stops; within limits nothing changes."""
    targets = Targets(SCENE, clamp=True)
    start, end, far = (targets.within_limits(posture(SCENE.avatars[0], 0)) for _ in range(3))
    end.positions[0] += (0.1, 0.0, 0.0)
    far.positions[0] += (0.3, 0.0, 0.0)
    start.angles[0], end.angles[0], far.angles[0] = 1.7, 1.9, 2.0
    goals = targets.between(start, end, np.array([0.0, 0.5, 1.0]))
    positions, orientations = targets.ahead(goals, 4.0, stop=True)
    there, turned = link_poses(SCENE.avatars, far)
    assert np.abs(np.abs(np.sum(orientations[1] * turned, axis=1)) - 1.0).max() <= 1e-12
    # the link below the hinge continues straight: only the change due to the limit is reverted
    assert np.abs(positions[1, :3] - there[:3]).max() <= 1e-12
    free = targets.ahead(goals, 4.0)
    assert np.abs(free[1][1, 1] - orientations[1, 1]).max() > 0.1
    near = targets.between(start, end, np.array([0.0, 0.1, 0.2]))
    for stopped, unstopped in zip(targets.ahead(near, 1.0, stop=True), targets.ahead(near, 1.0), strict=True):
        assert (stopped == unstopped).all()


@given(st.integers(0, 10**6), st.floats(0.0, 9.0))
def test_turns_go_on_as_the_plain_interpolation_does(seed: int, share: float) -> None:
    rng = np.random.default_rng(seed)
    turns = rotation.normalised(rng.normal(size=(1, 6, 4)))
    # no step of a frame turns a joint by half a circle, where both directions would be right
    for _ in range(3):
        step = rotation.from_rotation_vector(0.1 * rng.normal(size=(1, 6, 3)))
        turns = np.concatenate([turns, rotation.multiply(turns[-1:], step)])
    links, left, right = [4, 0, 5], rotation.normalised(rng.normal(size=(3, 4))), rotation.normalised(rng.normal(size=(3, 4)))
    plain = rotation.slerp(turns[:-1, links], turns[1:, links], np.asarray(share))
    expected = rotation.multiply(left, rotation.multiply(plain, right))
    found = Followed(links, left, right).aimed(turns, share)
    np.testing.assert_allclose(found, expected, atol=1e-13)
    assert Followed([], [], []).aimed(turns, share).shape == (3, 0, 4)

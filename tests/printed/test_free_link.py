"""One link moved out of an obstacle: the general case and the nearly parallel link; links are posed as the avatar is."""

import numpy as np
import pytest

from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.status import CANCELLING, CONVERGED, NOT_FINITE
from avatarsim.model.geometry import Poses, place
from avatarsim.model.skeleton import forward
from avatarsim.paper.ccd_ik import NO_GOAL, REACHED, free_link, link_contacts, pose_link
from avatarsim.paper.state import chains_of
from avatarsim.scene.body import fixed
from avatarsim.scene.joint import Ball
from avatarsim.scene.shape import Box, Piece
from avatarsim.settings import PaperSettings
from avatarsim.spatial import rotation
from tests.worlds.arms import RADIUS, arm, ball_hand, limited_ball, planar, three_axes, world_of

pytestmark = [pytest.mark.nojit]

LENGTHS, DEPTH = (0.4, 0.3, 0.2), 0.02
WALL_FROM = 0.25
"""y [m] beyond which the wall fills everything."""
SETTINGS = PaperSettings(tolerance=1e-7, sweeps=2000)


class Caught:
    """Return an arm of three links, the last one in a wall at an angle to its surface, and the call that frees it."""

    def __init__(self, joints, slope, walls=None):
        walls = walls or (Piece(Box((4.0, 1.0, 4.0)), (0.0, WALL_FROM + 0.5, 0.0)),)
        self.world = world_of((arm(LENGTHS, joints),), (fixed("wall", walls, "wood", (0.0, 0.0, 50.0)),))
        geo, skel = self.world.geometry, self.world.skeleton
        # elbow bent so that the wrist is at the wall; hand along it
        wrist = WALL_FROM - RADIUS + DEPTH
        turns = [0.9, 0.0, 0.0]
        turns[1] = np.arcsin((wrist - 0.4 * np.sin(0.9)) / 0.3) - 0.9
        turns[2] = slope - turns[0] - turns[1]
        for link in range(3):
            self.world.posture.turn[link] = rotation.to_matrix(rotation.from_axis_angle((0.0, 0.0, 1.0), turns[link]))
            if len(self.world.posture.angle) == 3:
                self.world.posture.angle[link] = turns[link]
        self.axes, self.none = np.zeros((len(self.world.posture.angle), 3)), np.zeros(len(self.world.posture.angle))
        self.world.poses.position[0] = 0.0
        place(geo, self.world.poses, 0)
        self.show()
        self.chains = chains_of(self.world.scene.avatars, geo, skel)
        self.points, self.scratch = np.zeros((256, 3)), make_scratch()
        self.heading = self.world.poses.rotation[3].copy()

    def show(self):
        forward(self.world.geometry, self.world.skeleton, self.world.posture, self.none, self.world.poses, self.axes)

    def contacts(self):
        return link_contacts(self.world.geometry, self.world.poses, 3, self.points, self.scratch)[:2]

    def free(self, settings=SETTINGS):
        status, count = self.contacts()
        assert status == CONVERGED and count > 0
        found = free_link(
            self.world.skeleton, self.chains.link, 0, 2, tuple(self.chains.limb[2]), self.points, count, settings,
            self.world.posture, self.world.poses, self.axes, self.scratch,
        )
        self.show()
        return found

    def depth(self):
        """Return the depth [m] of the hand's capsule in the wall, from its two ends."""
        return float(self.world.poses.boxes[3, 4] - WALL_FROM)


FREE_BALLS = [Ball(), Ball(), Ball()]
WIDE = planar(*[(-6.0, 6.0)] * 3)


@pytest.mark.parametrize("joints", [FREE_BALLS, WIDE], ids=["balls", "hinges"])
def test_a_nearly_parallel_link_is_moved_and_not_turned(joints):
    caught = Caught(joints, 0.05)
    inside, start = caught.depth(), caught.world.poses.position[3].copy()
    status, outcome, _, parallel, bent = caught.free()
    assert (status, outcome, parallel, bent) == (CONVERGED, REACHED, True, False)
    assert caught.depth() == pytest.approx(-SETTINGS.stand_off, abs=1e-6)
    np.testing.assert_allclose(caught.world.poses.rotation[3], caught.heading, atol=1e-6)
    np.testing.assert_allclose(caught.world.poses.position[3] - start, [0.0, -inside - SETTINGS.stand_off, 0.0], atol=1e-6)


def test_without_the_special_case_the_same_link_turns():
    caught = Caught(WIDE, 0.05)
    assert not caught.free(SETTINGS._replace(parallel=0.0))[3]
    assert np.abs(caught.world.poses.rotation[3] - caught.heading).max() > 0.01


def test_a_steep_link_is_freed_by_goals_for_its_end_effector():
    """One goal puts the mean contact at the position of eq. 3; parts that the turn moved into the wall need further goals."""
    caught, goals = Caught(WIDE, 0.6), 0
    inside = caught.depth()
    while caught.contacts()[1] > 0 and goals < PaperSettings().rounds:
        status, outcome, _, _, _ = caught.free()
        assert (status, outcome) == (CONVERGED, REACHED)
        goals += 1
    assert inside > 0.1
    assert caught.depth() <= 0.0
    assert goals > 1


def test_cancelling_normals_leave_the_arm_alone():
    plates = tuple(Piece(Box((4.0, 1.0, 4.0)), (0.0, 0.24 + side * (0.5 + RADIUS - DEPTH), 0.0)) for side in (-1.0, 1.0))
    caught = Caught(WIDE, 0.0, plates)
    before = caught.world.posture.angle.copy()
    assert caught.free()[:2] == (CANCELLING, NO_GOAL)
    assert (caught.world.posture.angle == before).all()


def test_a_link_that_is_no_number_has_no_contacts():
    caught = Caught(WIDE, 0.0)
    caught.world.poses.vertices[caught.world.geometry.shapes.start[3] :] = np.nan
    assert caught.contacts() == (NOT_FINITE, 0)


def test_it_agrees_with_the_kinematics_for_every_kind_of_joint():
    lengths = (0.4, 0.3, 0.2)
    avatars = (ball_hand(0.1), arm(lengths, [limited_ball(), three_axes(2.0), planar((-1.0, 2.0))[0]], at=(2.0, 1.0, 0.5)))
    world = world_of(avatars)
    skel, rng = world.skeleton, np.random.default_rng(2)
    nd = int(skel.first_dof[-1])
    whole, single = np.zeros((nd, 3)), np.zeros((nd, 3))
    other = Poses(*(array.copy() for array in world.poses))
    for _ in range(20):
        world.posture.root[0] = rng.normal(size=3)
        world.posture.angle[:] = rng.uniform(-1.0, 1.0, nd)
        world.posture.turn[:] = rotation.to_matrix(rotation.normalised(rng.normal(size=(len(skel.kind), 4))))
        forward(world.geometry, skel, world.posture, np.zeros(nd), world.poses, whole)
        for link in range(len(skel.kind)):
            pose_link(skel, world.posture, link, other, single)
        np.testing.assert_allclose(other.position, world.poses.position, atol=1e-14)
        np.testing.assert_allclose(other.rotation, world.poses.rotation, atol=1e-14)
        # a free root's own degrees of freedom are not joints
        np.testing.assert_allclose(single[6:], whole[6:], atol=1e-14)

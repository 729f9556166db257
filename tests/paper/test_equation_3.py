"""Eq. 3, goal_i = ee_i +- PD_gi: plus if the link is A of its pair, minus if it is B."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.status import CONVERGED
from avatarsim.model.world import build
from avatarsim.paper.ccd_ik import end_effector, goal_of, link_contacts
from avatarsim.paper.push_apart import global_penetration_depth
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import fixed, solid
from avatarsim.scene.joint import Rigid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere

pytestmark = [pytest.mark.nojit]

CENTRE, RADIUS = 0.1, 0.3


def test_the_sign_says_who_is_a():
    assert goal_of((1.0, 2.0, 3.0), (0.5, 0.0, -1.0), True) == (1.5, 2.0, 2.0)
    assert goal_of((1.0, 2.0, 3.0), (0.5, 0.0, -1.0), False) == (0.5, 2.0, 4.0)


def ball_on_floor():
    """A link, a sphere of radius 0.3 around (0, 0, 0.1), deep in a floor z < 0 and under a second link, a box at z > 0.35."""
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 2.0)), (0.0, 0.0, -1.0)),), "wood")
    ball, lid = Piece(Sphere(RADIUS), (0.0, 0.0, CENTRE)), Piece(Box((1.0, 1.0, 0.5)), (0.0, 0.0, 0.6))
    links = [Link(name, parent, Rigid(), (piece,), solid((piece,), 1.0)) for name, parent, piece in
             [("post", None, Piece(Sphere(0.01), (3.0, 3.0, 3.0))), ("ball", "post", ball), ("lid", "post", lid)]]
    return build(Scene("deep", (floor,), (Avatar("robot", tuple(links)),)))


@pytest.mark.parametrize("body", [2, 3], ids=["link is B of one pair and A of the other", "link is B"])
def test_the_goal_lies_on_the_outside_of_the_obstacle(body):
    world, points, scratch = ball_on_floor(), np.zeros((256, 3)), make_scratch()
    if body == 2:
        # away from the lid: only the floor is left
        world = build(replace(world.scene, exclude=(("robot/ball", "robot/lid"),)))
    status, count, queries = link_contacts(world.geometry, world.poses, body, points, scratch)
    assert (status, count, queries) == (CONVERGED, 1, 1)
    outcome, depth = global_penetration_depth(scratch.depth, scratch.direction, count)
    assert outcome == CONVERGED
    goal = goal_of(end_effector(points, count), depth, True)
    if body == 2:
        # lowest point of the ball, up to the floor
        assert points[0] == pytest.approx([0.0, 0.0, CENTRE - RADIUS], abs=1e-9)
        assert goal == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    else:
        # lower side of the lid, up to the top of the ball
        assert points[0, 2] == pytest.approx(0.35, abs=1e-9)
        assert goal[2] == pytest.approx(CENTRE + RADIUS, abs=1e-9)


def test_a_link_between_two_bodies_has_both_contacts():
    world, points, scratch = ball_on_floor(), np.zeros((256, 3)), make_scratch()
    status, count, _ = link_contacts(world.geometry, world.poses, 2, points, scratch)
    assert (status, count) == (CONVERGED, 2)
    np.testing.assert_allclose(scratch.depth[:2], [0.2, 0.05], atol=1e-9)
    np.testing.assert_allclose(scratch.direction[:2], [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]], atol=1e-9)

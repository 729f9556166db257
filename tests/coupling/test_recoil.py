"""Offsets of links as angles of joints, against finite differences and the links' own poses."""

import numpy as np
import pytest

from avatarsim.coupling.reaction import MOST_TURN, middle, recoil
from avatarsim.model.skeleton import displace, forward
from avatarsim.model.world import World, build
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, Joint
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece

BONE = (Piece(Box((0.04, 0.04, 0.3)), (0.0, 0.0, 0.15)),)
ABOUT_X = Hinges((Hinge((1.0, 0.0, 0.0), -2.0, 2.0),))


def arm(root: Joint, elbow: Joint = ABOUT_X) -> World:
    """A trunk, an upper arm on a ball and a forearm, each 0.3 m long and along z."""
    mass = solid(BONE, 1.0)
    links = (
        Link("trunk", None, root, BONE, mass),
        Link("upper", "trunk", Ball(), BONE, mass, anchor=(0.0, 0.0, 0.3)),
        Link("fore", "upper", elbow, BONE, mass, anchor=(0.0, 0.0, 0.3)),
    )
    return build(Scene("arm", (), (Avatar("arm", links, ignore=(("trunk", "upper"), ("upper", "fore"))),)))


def yielded(world: World, offsets: dict[int, tuple[float, float, float]], bend: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """(way (nd), displacement of the links' middles (nl, 3)) for offsets of some links, from an elbow bent by `bend` [rad]."""
    skel, degrees = world.skeleton, int(world.skeleton.first_dof[-1])
    world.posture.angle[:] = bend
    axes, way, offset, links = np.zeros((degrees, 3)), np.zeros(degrees), np.zeros((3, 3)), len(skel.kind)
    forward(world.geometry, skel, world.posture, np.zeros(degrees), world.poses, axes)
    before = np.array([middle(world.poses, skel.first + k) for k in range(links)])
    for link, x in offsets.items():
        offset[link] = x
    weights = np.ones(degrees)
    weights[: 3 if skel.kind[0] == 3 else 0] = 0.001
    assert recoil(skel, world.posture, world.poses, axes, offset, weights, way) == bool(set(offsets) - {0} or skel.kind[0] != 3)
    displace(skel, world.posture, way)
    forward(world.geometry, skel, world.posture, np.zeros(degrees), world.poses, axes)
    return way, np.array([middle(world.poses, skel.first + k) for k in range(links)]) - before


@pytest.mark.nojit
@pytest.mark.parametrize("offset", [(1e-5, 0.0, 0.0), (0.0, -1e-5, 0.0), (1e-5, 2e-5, -1e-5)])
def test_a_hit_link_moves_by_its_offset(offset: tuple[float, float, float]) -> None:
    """To first order; the box around a link that turns changes with the turn, hence a percent."""
    _, moved = yielded(arm(Free()), {2: offset}, 1.0)
    np.testing.assert_allclose(moved[2], offset, atol=0.2 * np.linalg.norm(offset))


@pytest.mark.nojit
def test_what_joints_can_give_the_root_does_not() -> None:
    way, moved = yielded(arm(Free()), {2: (0.0, 1e-4, 0.0)}, 1.0)
    assert np.abs(way[:3]).max() < 0.1e-4
    assert np.abs(moved[0]).max() < 0.1e-4


@pytest.mark.nojit
def test_what_no_joint_can_give_the_root_gives_and_only_translates() -> None:
    """A straight arm pushed along itself."""
    way, moved = yielded(arm(Free()), {2: (0.0, 0.0, -1e-3)})
    np.testing.assert_allclose(way[:3], [0.0, 0.0, -1e-3], atol=1e-8)
    np.testing.assert_allclose(moved, np.tile([0.0, 0.0, -1e-3], (3, 1)), atol=1e-6)
    assert not way[3:6].any()


@pytest.mark.nojit
def test_a_joint_stops_at_its_limit() -> None:
    short = Hinges((Hinge((1.0, 0.0, 0.0), -0.1, 0.05),))
    world = arm(Ball(), short)
    yielded(world, {2: (0.0, -0.5, 0.0)})
    assert world.posture.angle[world.skeleton.first_dof[2]] == pytest.approx(0.05)


@pytest.mark.nojit
def test_a_long_way_is_cut() -> None:
    way, _ = yielded(arm(Ball()), {2: (3.0, 5.0, -1.0)})
    assert np.abs(way).max() <= MOST_TURN


@pytest.mark.nojit
def test_two_links_of_one_arm_are_not_added_up() -> None:
    """Both hit by the same: the arm gives once."""
    _, alone = yielded(arm(Free()), {1: (0.0, 1e-4, 0.0)}, 1.0)
    _, both = yielded(arm(Free()), {1: (0.0, 1e-4, 0.0), 2: (0.0, 1e-4, 0.0)}, 1.0)
    assert both[1, 1] == pytest.approx(alone[1, 1], rel=0.5)
    assert both[2, 1] == pytest.approx(1e-4, rel=0.5)


@pytest.mark.nojit
def test_offsets_of_a_free_root_bend_nothing() -> None:
    way, _ = yielded(arm(Free()), {0: (0.1, 0.2, 0.3)})
    assert not way.any()

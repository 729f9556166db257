"""Chains of an avatar, and the seeded order in which they are processed."""

import numpy as np
import pytest

from avatarsim.paper.state import chains_of, shuffle
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.joint import Ball, Free
from avatarsim.scene.shape import Piece, Sphere
from avatarsim.spatial.random import seeded
from tests.worlds.arms import arm, ball_hand, planar, world_of

pytestmark = [pytest.mark.nojit]

DOT = Piece(Sphere(0.05))


def body(chains=()):
    """A trunk of two links with two arms (upper, fore), a neck, and a tail on the pelvis."""
    parents = {
        "pelvis": None, "chest": "pelvis", "neck": "chest", "l0": "chest", "l1": "l0", "r0": "chest", "r1": "r0",
        "tail": "pelvis",
    }
    links = [
        Link(name, parent, Ball() if parent else Free(), (DOT,), solid((DOT,), 1.0), anchor=(0.3 * k, 0.0, 0.0))
        for k, (name, parent) in enumerate(parents.items())
    ]
    return Avatar("body", tuple(links), chains, tuple((a, b) for a in parents for b in parents if a < b))


def named_chains(avatars):
    world = world_of(avatars)
    chains = chains_of(avatars, world.geometry, world.skeleton)
    names = [link.name for avatar in avatars for link in avatar.links]
    found = [
        [names[link] for link in chains.link[chains.first[c] : chains.first[c + 1]]] for c in range(len(chains.first) - 1)
    ]
    return found, {names[link] for link in np.flatnonzero(chains.trunk)}, chains


def test_chains_end_where_the_trunk_begins():
    found, trunk, _ = named_chains((body(("l1", "r1", "neck")),))
    assert found == [["l0", "l1"], ["r0", "r1"], ["neck"], ["tail"]]
    assert trunk == {"pelvis", "chest"}


def test_without_names_every_leaf_ends_a_chain():
    found, trunk, _ = named_chains((body(),))
    assert sorted(found) == [["l0", "l1"], ["neck"], ["r0", "r1"], ["tail"]]
    assert trunk == {"pelvis", "chest"}


def test_one_link_is_all_trunk_and_an_anchored_arm_has_none():
    found, trunk, chains = named_chains((ball_hand(0.1), arm((0.3, 0.2), planar((-1.0, 1.0), (0.0, 2.0)), at=(3.0, 0.0, 0.0))))
    assert found == [["arm0", "arm1"]]
    assert trunk == {"hand"}
    assert chains.root.tolist() == [0, 1, 1]


def test_limbs_point_to_the_next_joint_or_through_the_tip():
    _, _, chains = named_chains((arm((0.3, 0.2), planar((-1.0, 1.0), (0.0, 2.0))),))
    np.testing.assert_allclose(chains.limb, [[0.3, 0.0, 0.0], [0.2, 0.0, 0.0]], atol=1e-15)


@pytest.mark.parametrize("n", [0, 1, 2, 5])
def test_an_order_is_a_permutation_and_all_are_equally_likely(n):
    state, order, seen = seeded(1), np.zeros(n, dtype=np.int64), dict[tuple[int, ...], int]()
    for _ in range(6000):
        shuffle(state, order)
        assert sorted(order.tolist()) == list(range(n))
        seen[tuple(order.tolist())] = seen.get(tuple(order.tolist()), 0) + 1
    expected = 6000 / len(seen)
    assert len(seen) == [1, 1, 2, 6, 24, 120][n]
    # chi-squared within six standard deviations
    assert sum((count - expected) ** 2 / expected for count in seen.values()) < len(seen) + 6 * np.sqrt(2 * len(seen))


def test_a_seed_of_any_size_is_a_valid_state():
    for seed in (0, -1, 2**31 - 2, 2**31 - 1, 2**70):
        assert 0 < seeded(seed)[0] < 2**31 - 1

"""The path through the tree of the search, and the short cuts in it, against lists."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.posture.way_memory import (
    CUT_FROM,
    CUT_TO,
    CUTS,
    LAST,
    LEAVES,
    LEAVES_USED,
    NODE,
    NODES_USED,
    WALKED,
    Way,
    add_leaf,
    add_node,
    get_node,
    make_way,
)
from avatarsim.posture.way_path import MOST_CUTS, SHORT, choose_cut, splice, trace
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import rest
from avatarsim.world.skeleton import Posture
from tests.posture.little_worlds import hand, little, mixed_avatar, panel

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


def fresh() -> tuple[Way, Posture]:
    """An empty tree of a hand, and the posture that all its nodes get."""
    found = little(Scene("s", (panel(x=3.0),), (hand(),), start=rest((hand(),))))
    geo, skel, posture, poses = found.parts
    return make_way(geo, skel, posture, poses, found.memory, 0), posture


def path(way: Way) -> list[int]:
    """The nodes of the path."""
    return way.path[: way.state[LAST] + 1].tolist()


@given(st.lists(st.integers(0, 10**6), min_size=1, max_size=60), st.data())
def test_the_path_leads_from_the_root_to_the_present_node(parents: list[int], data: st.DataObject) -> None:
    way, posture = fresh()
    add_node(posture, -1, way)
    known = [-1]
    for k, parent in enumerate(parents):
        known.append(parent % (k + 1))
        add_node(posture, known[-1], way)
    node = data.draw(st.integers(0, len(parents)))
    way.state[NODE] = node
    trace(way)
    wanted = [node]
    while known[wanted[0]] >= 0:
        wanted.insert(0, known[wanted[0]])
    assert path(way) == wanted


@given(st.integers(0, 40), st.integers(1, 60), st.integers(0, 40), st.integers(0, 30))
def test_a_short_cut_takes_the_place_of_what_it_spares(before: int, spared: int, after: int, walked: int) -> None:
    way, posture = fresh()
    length = before + spared + after + 1
    for k in range(length):
        add_node(posture, k - 1, way)
    trace(way)
    assert path(way) == list(range(length))
    way.state[CUT_FROM], way.state[CUT_TO], way.state[WALKED] = before, before + spared, walked
    way.state[NODE] = before
    for _ in range(walked):
        add_node(posture, int(way.state[NODE]), way)
    splice(way)
    cut = list(range(length, length + walked))
    assert path(way) == [*range(before + 1), *cut, *range(before + spared, length)]


def test_short_cuts_are_tried_only_where_they_spare_something_and_not_for_ever() -> None:
    way, posture = fresh()
    for k in range(SHORT):
        add_node(posture, k - 1, way)
    trace(way)
    assert not choose_cut(way)
    for _ in range(20):
        add_node(posture, int(way.state[NODE]), way)
    trace(way)
    for k in range(MOST_CUTS):
        assert way.state[CUTS] == k and choose_cut(way)
        assert 0 <= way.state[CUT_FROM] and way.state[CUT_FROM] + SHORT <= way.state[CUT_TO] <= way.state[LAST]
    assert not choose_cut(way)


def test_no_short_cut_begins_that_the_tree_has_no_room_for() -> None:
    way, posture = fresh()
    for k in range(50):
        add_node(posture, k - 1, way)
    trace(way)
    way.state[NODES_USED] = len(way.before) - 20
    assert not choose_cut(way)


def test_a_node_gives_back_the_posture_that_it_got() -> None:
    avatar = mixed_avatar()
    found = little(Scene("s", (panel(x=9.0),), (avatar,), start=rest((avatar,))))
    geo, skel, posture, poses = found.parts
    way, rng = make_way(geo, skel, posture, poses, found.memory, 0), np.random.default_rng(1)
    given_postures = [Posture(*(rng.normal(size=array.shape) for array in posture)) for _ in range(3)]
    for each in given_postures:
        add_node(each, -1, way)
    for k, each in enumerate(given_postures):
        get_node(way, k, way.posture)
        assert all(np.array_equal(a, b) for a, b in zip(way.posture, each, strict=True))


def test_leaves_that_do_not_fit_are_not_kept() -> None:
    way, posture = fresh()
    for k in range(LEAVES + 3):
        add_node(posture, -1, way)
        add_leaf(float(k), way)
    assert way.state[LEAVES_USED] == LEAVES and way.leaves.tolist() == list(range(LEAVES)) and way.leaf_merit[-1] == LEAVES - 1

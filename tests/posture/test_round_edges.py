"""Round which edge a link is drawn, how fast, and that a foot hung up on a door frame gets past it."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.posture.round_edges import HANGS, LESS, MORE, WORTH, nearest_edge, round_edges
from avatarsim.posture.step import list_pair
from avatarsim.posture.workspace import FRAME, NEARBY
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import fixed
from avatarsim.scene.joint import Rigid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from scenarios import catalog
from tests.posture.little_worlds import Little, little, mixed_avatar
from tests.posture.ride import ride

FINE = 1e-3
"""Step [m] of the slow search."""

MIXED = mixed_avatar()
FAR, DEEP = 1.0, 0.3
"""[m] how far an origin pulls ever harder in these worlds; how far the user's link is beyond the face of a wall."""

STUCK, PAST = 198, 200
"""Frames of the clip between which a foot that hangs on the door frame and is not drawn round it is 0.3 m from the user's, link
origins 0.08 m."""


def slow_edge(link: np.ndarray, box: np.ndarray, here: np.ndarray, there: np.ndarray) -> tuple[int, float]:
    """Push the link's box out of the way in small steps, each way along each axis along which the boxes are not yet apart."""

    def apart(moved: np.ndarray) -> np.ndarray:
        return np.asarray((moved[:3] >= box[3:]) | (moved[3:] <= box[:3]))

    far, found, least = float(np.linalg.norm(there - here)), (-1, 0.0), WORTH * float(np.linalg.norm(there - here))
    if apart(link).sum() != 1:
        return found
    for axis in np.flatnonzero(~apart(link)).tolist():
        for sign in (-1.0, 1.0):
            way = 0.0
            while not apart(link + np.tile(sign * way * np.eye(3)[axis], 2))[axis]:
                way += FINE
            place = here[axis] + sign * way
            left = sign * (place - there[axis])
            if way < far and 0.0 < left < least:
                found, least = (axis, place), left
    return found


@pytest.mark.nojit
def test_the_edge_is_the_one_that_small_steps_find() -> None:
    rng, found, none = np.random.default_rng(3), 0, 0
    for _ in range(300):
        here, size = rng.uniform(-1.0, 1.0, 3), rng.uniform(0.05, 0.2, 3)
        link = np.concatenate([here - size, here + rng.uniform(0.05, 0.2, 3)])
        low = rng.uniform(-0.6, 0.0, 3)
        box = np.concatenate([low, low + rng.uniform(0.1, 1.5, 3)])
        there = here + rng.normal(0.0, 0.3, 3)
        axis, place = nearest_edge(np.array([link, box]), 0, 1, tuple(here), tuple(there), float(np.linalg.norm(there - here)))
        wanted, near = slow_edge(link, box, here, there)
        if wanted != axis:
            # a step of the slow search decides between two edges that are as good, or whether one is just worth it
            left = [abs(p - there[k]) for k, p in ((axis, place), (wanted, near)) if k >= 0]
            assert min(abs(left[0] - v) for v in (*left[1:], WORTH * np.linalg.norm(there - here))) < 2.0 * FINE
        elif axis >= 0:
            assert place == pytest.approx(near, abs=2.0 * FINE)
            found += 1
        else:
            none += 1
    assert found > 20 and none > 20


def stiffened() -> Avatar:
    """The same avatar without joints."""
    found = mixed_avatar()
    return replace(found, links=tuple(replace(link, joint=Rigid()) if link.parent else link for link in found.links))


def hung(edge: float, avatar: Avatar = MIXED) -> Little:
    """Link 1 is listed as in touch with a wall across x, whose edge is `edge` [m] beyond its middle along y; body 1 is far."""
    low, high = np.split(little(Scene("s", (), (avatar,))).world.poses.hulls[1], 2)
    centre = (float(high[0]) + 0.051, float(0.5 * (low[1] + high[1])) + edge - 1.0, float(low[2]))
    wall, other = (Piece(Box((0.1, 2.0, 4.0))),), (Piece(Box((0.2, 0.2, 0.2))),)
    found = little(Scene("s", (fixed("wall", wall, "wood", centre), fixed("other", other, "wood", (50.0, 0.0, 0.0))), (avatar,)))
    geometry, skel, _, poses = found.parts
    c = found.memory.goal.closeness
    c.far[0], c.here[:] = FAR, poses.position[skel.first :]
    list_pair(int(geometry.first_shape[skel.first + 1]), 0, int(geometry.first_shape[skel.first]), found.memory)
    return found


def drawn(found: Little, frame: float) -> np.ndarray:
    """How far origins are put aside (nl, 3) [m] in a frame in which the user's link 1 is DEEP beyond the wall's face."""
    geometry, skel, _, poses = found.parts
    c = found.memory.goal.closeness
    there = c.here.copy()
    there[1, 0] += DEEP
    c.there[:], found.memory.flags[FRAME] = there, frame
    round_edges(geometry, skel, poses, found.memory)
    return np.asarray(c.there - there)


@pytest.mark.nojit
def test_a_link_is_drawn_aside_ever_farther_up_to_a_limit_and_no_other_one() -> None:
    found, last = hung(0.05), 0.0
    for frame in range(1, 60):
        aside = drawn(found, float(frame))
        assert not aside[[0, 2, 3, 4]].any() and not aside[1, [0, 2]].any()
        assert last < aside[1, 1] <= last + MORE * FAR + 1e-12 or aside[1, 1] == last > DEEP
        last = float(aside[1, 1])
    assert DEEP < last < DEEP + WORTH * DEEP


@pytest.mark.nojit
def test_who_need_not_go_round_any_more_is_let_go_frame_by_frame() -> None:
    found = hung(0.05)
    for frame in range(1, 5):
        assert drawn(found, float(frame))[1, 1] == pytest.approx(frame * MORE * FAR)
    assert drawn(found, 40.0)[1, 1] == pytest.approx(MORE * FAR), "begun anew after frames without contact"
    found.world.poses.hulls[0] -= 9.0
    found.memory.goal.closeness.around[1, 1] = 1.7 * LESS * FAR
    assert drawn(found, 41.0)[1, 1] == pytest.approx(0.7 * LESS * FAR)
    assert not drawn(found, 42.0).any()


@pytest.mark.nojit
@pytest.mark.parametrize("what", ["far from an edge", "at the user's", "elsewhere", "taken", "without joints"])
def test_nobody_is_drawn_round_what_is_not_worth_it(what: str) -> None:
    found = hung(0.3 if what == "far from an edge" else 0.05, stiffened() if what == "without joints" else MIXED)
    pairs = found.memory.pairs
    if what == "at the user's":
        found.memory.goal.closeness.far[0] = 1.01 * DEEP / HANGS
    if what == "elsewhere":
        found.memory.goal.closeness.far[0] = 0.99 * DEEP
    if what == "taken":
        found.world.poses.hulls[1] = (-9.0, -9.0, -9.0, 9.0, 9.0, 9.0)
        pairs.near[0], pairs.marks[NEARBY] = 1, 1
    assert not drawn(found, 1.0).any()


def test_a_foot_that_hangs_on_a_door_frame_gets_past_it() -> None:
    """The user swings a foot through the frame of a door, where it stays in the wall for half a second."""
    scenario = catalog.get("mocap_spin")
    scene = scenario.build()
    driven, motion, far = ride(scene), scenario.motion(scene, 0), []
    for frame in range(PAST):
        sample = motion(frame)
        driven.frame(sample)
        far.append(driven.error(sample))
    assert max(far[STUCK:]) < 0.05

"""Bodies that are no links are taken over into the trial where they have moved, and nowhere else."""

import numpy as np
import pytest

from avatarsim.ik.broad_phase import notice_bodies
from avatarsim.model.geometry import place
from avatarsim.scene.scene import Scene
from tests.ik.scenes import block
from tests.ik.solvers import Solver, solver_of
from tests.worlds.little_worlds import hand

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
NOT_KNOWN = np.zeros(0, dtype=np.int64)


def noticed(found: Solver, moving: np.ndarray) -> bool:
    """Whether any body had moved."""
    return bool(notice_bodies(found.world.geometry, found.world.skeleton, found.world.poses, moving, found.working))


def shift(found: Solver, body: int) -> None:
    """Move a body."""
    found.world.poses.position[body] += (0.0, 0.25, 0.0)
    place(found.world.geometry, found.world.poses, body)


def same(found: Solver) -> list[bool]:
    """Of both bodies whether the trial has them where they are, shapes and boxes too."""
    geo, poses, s = found.world.geometry, found.world.poses, found.working
    told = []
    for b in range(2):
        pieces = slice(geo.first_shape[b], geo.first_shape[b + 1])
        vertices = slice(geo.shapes.start[pieces.start], geo.shapes.start[pieces.stop])
        pairs = (
            (s.trial.position[b], poses.position[b]), (s.trial.vertices[vertices], poses.vertices[vertices]),
            (s.swept[pieces], poses.boxes[pieces]), (s.swept_links[b], poses.hulls[b]),
        )
        told.append(all((one == other).all() for one, other in pairs))
    return told


def test_what_has_moved_is_taken_over_once_and_what_is_not_named_is_not_looked_at() -> None:
    bodies = block("one", (2.0, 0.0, 0.0), (1.0, 1.0, 1.0)), block("other", (4.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    found = solver_of(Scene("s", bodies, (hand(),)))
    assert not noticed(found, NOT_KNOWN)
    shift(found, 0)
    shift(found, 1)
    assert same(found) == [False, False]
    assert noticed(found, np.array([0, 1, 0])) and same(found) == [False, True]
    assert not noticed(found, np.array([0, 1, 1])) and same(found) == [False, True]
    assert noticed(found, NOT_KNOWN) and same(found) == [True, True]
    assert not noticed(found, NOT_KNOWN)
    found.world.poses.rotation[0] = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    assert noticed(found, NOT_KNOWN), "a turn alone is a move"

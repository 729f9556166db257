"""Islands against connected components; swept boxes and near bodies against all pairs; bodies that moved are noticed."""


import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.ik.broad_phase import boxes_meet, forget_near, form_islands, list_near_bodies, notice_bodies, sweep_boxes
from avatarsim.ik.kinematics import try_step
from avatarsim.model.geometry import place
from avatarsim.scene.scene import Scene
from tests.ik.solvers import Solver, random_posture, solver_of
from tests.worlds.little_worlds import block, hand, mixed_avatar

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
HANDS = Scene("hands", (block("b", (50.0, 0.0, 0.0), (1.0, 1.0, 1.0)),), tuple(hand(name=f"h{k}") for k in range(9)))
FOUND = solver_of(HANDS)
BODIES = tuple(block(f"b{k}", (float(k % 5) - 2.0, float(k // 5) - 2.0, 0.4), (0.1, 0.1, 0.1)) for k in range(25))
AMONG = solver_of(Scene("among", BODIES, (mixed_avatar(),)))


def components(count: int, edges: set[tuple[int, int]]) -> list[int]:
    """Return the least member of each one's component."""
    of = list(range(count))
    for _ in range(count):
        for a, b in edges:
            of[a] = of[b] = min(of[a], of[b])
    return of


@given(st.sets(st.tuples(st.integers(0, 8), st.integers(-1, 8)), max_size=12))
def test_islands_are_the_connected_components_of_what_touches(edges: set[tuple[int, int]]) -> None:
    """-1 is the block, which many may touch without being of one island."""
    geo, skel, t = FOUND.world.geometry, FOUND.world.skeleton, FOUND.state.touching
    first, pairs = int(geo.first_shape[skel.first]), sorted(edge for edge in edges if edge[0] != edge[1])
    t.used[0] = len(pairs)
    t.pair[: len(pairs)] = np.array([(first + a, first + b if b >= 0 else 0) for a, b in pairs]).reshape(-1, 2)
    form_islands(FOUND.rig, FOUND.state, FOUND.working)
    wanted = components(9, {(a, b) for a, b in pairs if b >= 0})
    assert FOUND.state.tracking.island.tolist() == wanted
    members = FOUND.working.members.tolist()
    assert sorted(members) == list(range(9)) and members == sorted(range(9), key=lambda one: (wanted[one], one))


def moved(found: Solver, seed: int, far: float) -> None:
    """The first avatar at a random posture near the origin, and its trial a random step away."""
    rng, posture = np.random.default_rng(seed), random_posture(found, seed)
    posture.root[0] = rng.uniform(-2.0, 2.0, 3)
    found.take(posture)
    found.working.step[:] = rng.normal(0.0, far, len(found.working.step))
    try_step(found.rig, 0, posture, found.working)
    sweep_boxes(found.rig, 0, found.world.poses, 1e-3, found.working)


@given(st.integers(0, 10**6), st.floats(0.0, 0.5))
def test_swept_boxes_hold_both_ends_of_every_vertex(seed: int, far: float) -> None:
    moved(AMONG, seed, far)
    geo, skel, s = AMONG.world.geometry, AMONG.world.skeleton, AMONG.working
    for body in range(skel.first, len(geo.first_shape) - 1):
        for piece in range(geo.first_shape[body], geo.first_shape[body + 1]):
            for poses in (AMONG.world.poses, s.trial):
                vertices = poses.vertices[geo.shapes.start[piece] : geo.shapes.start[piece + 1]]
                margin = geo.shapes.radius[piece] + 1e-3 - 1e-12
                for box in (s.swept[piece], s.swept_links[body], s.swept_avatars[0]):
                    assert (vertices - margin >= box[:3]).all() and (vertices + margin <= box[3:]).all()


@given(st.lists(st.tuples(st.integers(0, 10**6), st.floats(0.0, 0.5), st.booleans()), min_size=1, max_size=5))
def test_the_list_of_near_bodies_misses_none_in_reach(steps: list[tuple[int, float, bool]]) -> None:
    """Listed once, it serves until the avatar leaves the box that it was made for or a body moves."""
    s, state, skel = AMONG.working, AMONG.state, AMONG.world.skeleton
    forget_near(state)
    s.swept_links[: skel.first] = AMONG.world.poses.hulls[: skel.first]
    for seed, far, forgets in steps:
        moved(AMONG, seed, far)
        if forgets:
            forget_near(state)
        list_near_bodies(skel, 0, state, s)
        listed = state.near[0, : state.near_count[0]].tolist()
        assert listed == sorted(set(listed))
        for b in range(skel.first):
            if any(boxes_meet(s.swept_links, b, link) for link in range(skel.first, len(s.swept_links))):
                assert b in listed


NOT_KNOWN = np.zeros(0, dtype=np.int64)


def noticed(found: Solver, moving: np.ndarray) -> bool:
    """Return whether any body had moved."""
    return bool(notice_bodies(found.world.geometry, found.world.skeleton, found.world.poses, moving, found.working))


def shift(found: Solver, body: int) -> None:
    """Move a body."""
    found.world.poses.position[body] += (0.0, 0.25, 0.0)
    place(found.world.geometry, found.world.poses, body)


def same(found: Solver) -> list[bool]:
    """Return for both bodies whether the trial has them where they are, shapes and boxes too."""
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


def test_moved_bodies_are_taken_over_once_if_named() -> None:
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

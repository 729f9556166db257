"""Sweep and prune and its grid against brute-force twins, bit for bit."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.collision.broad_phase import all_pairs, forget, insert, remove, sweep_and_prune
from avatarsim.collision.grid import (
    LOOK,
    LOOKED,
    boxes_meet,
    cells_around,
    link,
    make_sweep_memory,
    partners,
)
from avatarsim.collision.status import CONVERGED, NOT_FINITE, OUT_OF_ROOM
from avatarsim.model.geometry import OPEN, pair_filter

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


def random_boxes(rng, count, kind="cube"):
    """On a coarse grid, so that boxes often touch exactly; as dense at any count."""
    edge = max(2.0, 2.0 * count ** (1 / 3))
    stretch = {"cube": (1, 1, 1), "plane": (3, 3, 0.1), "line": (9, 0.1, 0.1), "mixed": (1, 1, 1), "point": (0, 0, 0)}[kind]
    low = rng.integers(0, int(2 * edge), (count, 3)) * 0.5 * np.array(stretch)
    size = rng.integers(0, 4, (count, 3)) * 0.25
    if kind == "mixed":
        size *= 10.0 ** rng.integers(-7, 2, (count, 1))
        size[: count // 20] *= 1000.0
    return np.hstack([low, low + size])


def some_filter(rng, count):
    family = np.where(rng.random(count) < 0.3, rng.integers(0, 3, count), OPEN)
    return pair_filter(family, [(int(a), int(b)) for a, b in rng.integers(0, count, (count // 2, 2)) if a != b])


def both(boxes, wanted, memory, cap=4000):
    """Return the pairs that both find, which must be the same to the last bit."""
    found, dumb = np.full((cap, 2), -1), np.full((cap, 2), -1)
    answer = sweep_and_prune(boxes, wanted, memory, found)
    assert answer == all_pairs(boxes, wanted, dumb)
    assert (found == dumb).all()
    return answer


@given(
    st.integers(0, 10**6), st.integers(0, 25) | st.integers(60, 90), st.sampled_from(["cube", "plane", "line", "mixed", "point"]),
    st.sampled_from([0.0, 1.0, 1e9, -(2.0**41)]),
)
@settings(deadline=None, max_examples=40)
def test_finds_the_pairs_of_the_dumb_twin_frame_after_frame(seed, count, kind, offset):
    rng = np.random.default_rng(seed)
    boxes = random_boxes(rng, count, kind) + offset
    wanted, memory = some_filter(rng, count) if count else pair_filter([]), make_sweep_memory(count, 6000)
    steady = rng.integers(-1, 2, (count, 3)) * 0.125
    for _ in range(6):
        both(boxes, wanted, memory)
        moves = rng.random((count, 1)) < 0.5
        boxes += np.tile(np.where(moves, steady, 0.0) + rng.integers(-1, 2, (count, 3)) * 0.5 * (rng.random() < 0.3), 2)
        if rng.random() < 0.2:
            boxes[:, 3:] += 0.25


def test_bodies_that_keep_to_their_boxes_are_not_searched_for():
    """A body that moves steadily leaves its fat box once in a while, one that rests never does."""
    rng = np.random.default_rng(4)
    boxes, memory = random_boxes(rng, 80) * 10.0, make_sweep_memory(80, 4000)
    boxes[:, 3:] += 1.0
    searched = np.zeros(80, int)
    for _ in range(200):
        both(boxes, pair_filter([OPEN] * 80), memory)
        searched += memory.born == memory.sweep[0]
        boxes[:40] += 0.001
    assert (searched[40:] == 1).all()
    assert (searched[:40] >= 2).all() and (searched[:40] < 10).all()


def test_a_changed_filter_is_heeded_once_the_body_is_forgotten():
    boxes = np.tile([0.0, 0, 0, 1, 1, 1], (3, 1))
    wanted, memory = pair_filter([0, 0, OPEN]), make_sweep_memory(3, 9)
    assert both(boxes, wanted, memory) == (CONVERGED, 2)
    wanted.family[0] = OPEN
    forget(memory, 0)
    assert both(boxes, wanted, memory) == (CONVERGED, 3)


@pytest.mark.parametrize("count", [5, 70])
def test_too_many_pairs_is_a_status_that_tells_how_many(count):
    boxes, true = np.tile([0.0, 0, 0, 1, 1, 1], (count, 1)), count * (count - 1) // 2
    wanted = pair_filter([OPEN] * count)
    for room in (3, true - 1, true):
        memory, pairs = make_sweep_memory(count, room), np.full((room, 2), -1)
        for _ in range(2):
            assert sweep_and_prune(boxes, wanted, memory, pairs) == (CONVERGED if room == true else OUT_OF_ROOM, true)
            assert (0 <= pairs[:, 0]).all() and (pairs[:, 0] < pairs[:, 1]).all() and len(np.unique(pairs, axis=0)) == room
        # and once there is room again it goes on as if nothing had been
        apart = boxes + np.arange(count)[:, None] * 2.0
        assert sweep_and_prune(apart, wanted, memory, pairs) == (CONVERGED, 0)


def test_candidates_without_room_are_no_pairs_without_room():
    """Boxes that move side by side have more candidates than pairs."""
    rng = np.random.default_rng(5)
    low = np.stack(np.meshgrid(*[np.arange(5) * 1.05] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    boxes, memory = np.hstack([low, low + 1.0]), make_sweep_memory(125, 8)
    boxes[0, 3:] += 0.2
    for _ in range(5):
        assert both(boxes, pair_filter([OPEN] * 125), memory, 8) == (CONVERGED, 7)
        boxes += np.tile(rng.choice([-0.004, 0.004], 3), 2)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("sweeps", [0, 1, 3])
def test_a_bound_that_is_not_finite_is_a_status(bad, sweeps):
    good = np.tile([0.0, 0, 0, 1, 1, 1], (3, 1))
    wanted = pair_filter([OPEN] * 3)
    for column in range(6):
        memory, pairs, boxes = make_sweep_memory(3, 9), np.full((9, 2), -1), good.copy()
        for k in range(sweeps):
            boxes = good + 0.01 * k
            both(boxes, wanted, memory)
        broken = boxes.copy()
        broken[1, column] = bad
        assert sweep_and_prune(broken, wanted, memory, pairs) == (NOT_FINITE, 0)
        assert (pairs == -1).all()
        assert both(boxes, wanted, memory) == (CONVERGED, 3)


@pytest.mark.parametrize(("seed", "cap"), [(0, 20), (1, 100), (2, 100)])
def test_bodies_come_and_go_while_it_runs(seed, cap):
    """A random walk of inserting, removing and moving, with places used again, against the twin over those that are there."""
    rng = np.random.default_rng(seed)
    memory, there = make_sweep_memory(cap, 5000, present=False), np.zeros(cap, bool)
    wanted, boxes = some_filter(rng, cap), np.full((cap, 6), np.nan)
    seen = 0
    for _ in range(60):
        for b in rng.integers(0, cap, cap // 4):
            if there[b] and rng.random() < 0.4:
                remove(memory, b)
                boxes[b] = np.nan if rng.random() < 0.5 else 0.0
                there[b] = False
            elif not there[b]:
                insert(memory, b)
                boxes[b] = random_boxes(rng, cap // 4)[0]
                there[b] = True
        for b in np.flatnonzero(there & (rng.random(cap) < 0.3)):
            boxes[b] += np.tile(rng.normal(size=3) * rng.choice([1e-3, 1.0]), 2)
        found, dumb = np.zeros((5000, 2), np.int64), np.zeros((5000, 2), np.int64)
        here = boxes.copy()
        # nothing meets a box that is upside down and nowhere
        here[~there] = [1e300, 1e300, 1e300, -1e300, -1e300, -1e300]
        count = all_pairs(here, wanted, dumb)[1]
        assert sweep_and_prune(boxes, wanted, memory, found) == (CONVERGED, count)
        assert (found == dumb).all()
        seen += count
    assert seen > 10


def test_inserting_twice_and_removing_twice_is_as_once():
    boxes, wanted, memory = np.tile([0.0, 0, 0, 1, 1, 1], (3, 1)), pair_filter([OPEN] * 3), make_sweep_memory(3, 9, present=False)
    pairs = np.zeros((9, 2), np.int64)
    for b in (0, 2, 2):
        insert(memory, b)
    assert sweep_and_prune(boxes, wanted, memory, pairs) == (CONVERGED, 1) and pairs[0].tolist() == [0, 2]
    insert(memory, 2)
    remove(memory, 0)
    remove(memory, 0)
    assert sweep_and_prune(boxes, wanted, memory, pairs) == (CONVERGED, 0)


def test_a_few_huge_boxes_among_many_small_ones():
    """One that spans more cells than are looked into at once, and some beyond all cells, one after the other."""
    low = np.stack(np.meshgrid(*[np.arange(7) * 1.5] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    boxes, wanted = np.hstack([low, low + 1.0]), pair_filter([OPEN] * 343)
    boxes[7] = [-1.0, -1.0, 2.2, 8.0, 9.0, 9.2]
    boxes[11:13] = [[-(2.0**41), -1.0, 2.2, 2.0**41, 4.0, 2.4], [0.0, 0.0, -(2.0**42), 0.5, 3.0, 2.0**42]]
    memory = make_sweep_memory(343, 4000)
    assert both(boxes, wanted, memory)[1] > 150
    for b in (7, 11, 12, 100):
        forget(memory, b)
        both(boxes, wanted, memory)


def test_a_fast_crowd_does_not_run_out_of_room_again_and_again():
    """Boxes to and fro in lockstep, with room for a candidate each: their room to move grows until it is full, and no further."""
    rng = np.random.default_rng(0)
    rest = np.stack(np.meshgrid(*[np.arange(4.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3) + rng.uniform(-0.2, 0.2, (64, 3))
    rest = np.hstack([rest, rest + rng.uniform(0.1, 0.3, (64, 3))])
    way = rng.normal(size=(64, 3))
    way *= 0.1 / np.linalg.norm(way, axis=1, keepdims=True)
    wanted, memory, searched, without = pair_filter([OPEN] * 64), make_sweep_memory(64, 64), 0, 0
    for k in range(400):
        both(rest + np.tile(way * np.sin(0.17 * k), 2), wanted, memory, 64)
        searched += int((memory.born == memory.sweep[0]).sum())
        without += not memory.known.any()
    assert without <= 4
    assert searched < 0.08 * 400 * 64




@pytest.mark.parametrize(("length", "portions"), [(2.0, 1), (4.0, 2), (6.1, 3), (7.2, 4)])
@pytest.mark.parametrize("corner", [0.0, -3.0, 1.2])
def test_a_large_box_finds_everybody_once(length: float, portions: int, corner: float) -> None:
    """Cells of one level are 2 m long here: one that is long takes so many portions at least."""
    rng, count = np.random.default_rng(7), 1000
    low = np.stack(np.meshgrid(*[np.arange(10.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3) + corner
    low += rng.uniform(0.0, 0.3, (count, 3))
    boxes = np.hstack([low, low + rng.uniform(0.3, 0.6, (count, 1))])
    boxes[0] = [corner + 1.0] * 3 + [corner + 1.0 + length] * 3
    memory = make_sweep_memory(count, count)
    memory.fat[:] = boxes
    for b in range(count):
        link(memory, b)
    memory.known[1:] = True
    cells = cells_around(boxes, memory, 0)
    assert LOOK * cells < count and (portions - 1) * (LOOKED - 1) <= cells
    found = partners(boxes, pair_filter([OPEN] * count), memory, 0, 0)
    assert sorted(memory.fresh[:found].tolist()) == [k for k in range(1, count) if boxes_meet(boxes, 0, k)]
    assert found > 0


def test_boxes_that_touch_meet_and_nan_meets_all() -> None:
    """Bodies that comparisons cannot separate from others are not apart."""
    boxes = np.array([[0.0, 0, 0, 1, 1, 1], [1.0, 1, 1, 2, 2, 2], [0.0, 0, 0, 0, 0, 0], [0.5, 0.5, np.nextafter(1, 2), 1, 1, 2]])
    for i, j, meet in ((0, 1, True), (0, 2, True), (1, 2, False), (0, 3, False), (1, 3, True)):
        assert boxes_meet(boxes, i, j) == boxes_meet(boxes, j, i) == meet
    boxes[0] = np.nan
    assert boxes_meet(boxes, 0, 1) and boxes_meet(boxes, 1, 0)

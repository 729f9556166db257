"""The search through cells finds what trying all finds, and each once, however many portions the cells are looked into."""

import numpy as np
import pytest

from avatarsim.collision.grid import LOOK, LOOKED, boxes_meet, cells_around, link, make_sweep_memory, partners
from avatarsim.model.geometry import OPEN, pair_filter

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


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


def test_boxes_that_touch_meet_and_one_that_is_no_number_meets_all() -> None:
    """Bodies that cannot be told apart from others are not apart."""
    boxes = np.array([[0.0, 0, 0, 1, 1, 1], [1.0, 1, 1, 2, 2, 2], [0.0, 0, 0, 0, 0, 0], [0.5, 0.5, np.nextafter(1, 2), 1, 1, 2]])
    for i, j, meet in ((0, 1, True), (0, 2, True), (1, 2, False), (0, 3, False), (1, 3, True)):
        assert boxes_meet(boxes, i, j) == boxes_meet(boxes, j, i) == meet
    boxes[0] = np.nan
    assert boxes_meet(boxes, 0, 1) and boxes_meet(boxes, 1, 0)

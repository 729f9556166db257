"""Frames of moving boxes with and without the sweep; the difference is what it costs."""

from collections.abc import Iterator
from time import process_time
from typing import Final

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.sweep import all_pairs, forget, sweep_and_prune
from avatarsim.collide.sweep_memory import SweepMemory, make_sweep_memory
from avatarsim.kernel import kernel
from avatarsim.world.pair_filter import PairFilter
from reference.broad_phase.layouts import Field
from reference.broad_phase.one_axis import one_axis
from reference.broad_phase.rows import Row

Array = NDArray[np.float64]
Index = NDArray[np.int64]

PAIRS_ROOM: Final = 16
"""Room for near pairs; there are five."""

CANDIDATES_PER_OBJECT: Final = 1
"""Room for candidates: objects a metre apart have a tenth of one each."""

NOTHING, SWEEP, AFRESH, ONE_AXIS, ALL_PAIRS = range(5)
"""What is done in a frame after the boxes have moved; AFRESH: the sweep without memory of the frame before."""

KERNELS: Final = {"sweep and prune": SWEEP, "without coherence": AFRESH, "one axis": ONE_AXIS, "all pairs": ALL_PAIRS}

MOST_OBJECTS: Final = {"sweep and prune": 10**9, "without coherence": 10**9, "one axis": 6000, "all pairs": 2000}
"""Beyond these a frame takes longer than anybody waits for."""


@kernel
def frames(
    what: int, count: int, boxes: Array, rest: Array, moving: Index, speed: Array, swing: float, wanted: PairFilter,
    memory: SweepMemory, order: Index, pairs: Index,
) -> int:
    """So many frames; every moving box swings about its ``rest``. Returns the number of pairs found in the last one."""
    found = 0
    for _ in range(count):
        for m in range(moving.shape[0]):
            b = moving[m]
            for k in range(3):
                speed[m, k] -= swing * swing * (boxes[b, k] - rest[b, k])
                boxes[b, k] += speed[m, k]
                boxes[b, k + 3] += speed[m, k]
        if what == AFRESH:
            for b in range(boxes.shape[0]):
                forget(memory, b)
        if what == SWEEP or what == AFRESH:
            found = sweep_and_prune(boxes, wanted, memory, pairs)[1]
        elif what == ONE_AXIS:
            found = one_axis(boxes, wanted, order, pairs)
        elif what == ALL_PAIRS:
            found = all_pairs(boxes, wanted, pairs)[1]
    return found


def measure(field: Field, layout: str, motion: str, name: str, warm: int, samples: int, work: int) -> Row:
    """Microseconds per object and frame: the median over ``samples`` runs of ``work`` objects in all, after ``warm`` frames.

    Time of this process only, so that other programs on the machine count less.
    """
    count = len(field.boxes)
    boxes, speed, order = field.boxes.copy(), field.speed.copy(), np.arange(count)
    memory = make_sweep_memory(count, PAIRS_ROOM + CANDIDATES_PER_OBJECT * count)
    pairs, twin = np.zeros((PAIRS_ROOM, 2), np.int64), np.zeros((PAIRS_ROOM, 2), np.int64)
    runs = max(1, work // count)

    def run(what: int, many: int) -> float:
        begun = process_time()
        frames(what, many, boxes, field.boxes, field.moving, speed, field.swing, field.wanted, memory, order, pairs)
        return process_time() - begun

    what = KERNELS[name]
    run(NOTHING, 1)
    run(what, warm)
    both = [(run(what, runs), run(NOTHING, runs) if len(field.moving) else 0.0) for _ in range(samples)]
    run(what, 1)
    many = all_pairs(boxes, field.wanted, twin)[1]
    same = sorted(map(tuple, pairs[:many].tolist())) == sorted(map(tuple, twin[:many].tolist()))
    spent = float(np.median([one for one, _ in both]) - np.median([other for _, other in both]))
    kept: Iterator[NDArray[np.generic]] = iter((*memory, *field.wanted) if what in (SWEEP, AFRESH) else (order,))
    held = sum(array.nbytes for array in kept) + (count * count if what == ONE_AXIS else 0)
    return Row(layout, motion, count, name, 1e6 * spent / runs / count, held / count, int(many), bool(same))



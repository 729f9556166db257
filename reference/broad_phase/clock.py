"""Frames of moving boxes with and without the sweep; the difference is what it costs."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from time import process_time
from typing import Final

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.broad_phase import all_pairs, forget, sweep_and_prune
from avatarsim.collision.grid import SweepMemory, make_sweep_memory
from avatarsim.jit.by_reference import refer
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import PairFilter
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

SLOWER: Final = 3
"""All but the sweep get so many times less work, and so many frames to warm up."""

MOST_OBJECTS: Final = {"sweep and prune": 10**9, "without coherence": 10**9, "one axis": 6000, "all pairs": 2000}
"""Beyond these a frame takes longer than a measurement can wait for."""


@kernel
def frames(
    what: int, count: int, boxes: Array, rest: Array, moving: Index, speed: Array, swing: float, wanted: PairFilter,
    memory: SweepMemory, order: Index, pairs: Index,
) -> int:
    """So many frames; every moving box swings about its ``rest``. Returns the number of pairs found in the last one."""
    # as the engine hands them on; by value they would be copied in every frame
    wanted, memory = refer(wanted), refer(memory)
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


@dataclass(frozen=True)
class Course:
    """One field that is swept, and its double that only moves: the sweep must miss no frame while moving alone is timed."""

    field: Field
    what: int
    memory: SweepMemory
    order: Index
    pairs: Index
    swept: tuple[Array, Array]
    moved: tuple[Array, Array]

    def seconds(self, what: int, count: int) -> float:
        """Time of this process that so many frames take."""
        here = self.field
        boxes, speed = self.moved if what == NOTHING else self.swept
        begun = process_time()
        frames(what, count, boxes, here.boxes, here.moving, speed, here.swing, here.wanted, self.memory, self.order, self.pairs)
        return process_time() - begun


def course(field: Field, what: int) -> Course:
    """A field at rest, with fresh memory."""
    count = len(field.boxes)
    memory = make_sweep_memory(count, PAIRS_ROOM + CANDIDATES_PER_OBJECT * count)
    pairs = np.zeros((PAIRS_ROOM, 2), np.int64)
    swept, moved = (field.boxes.copy(), field.speed.copy()), (field.boxes.copy(), field.speed.copy())
    return Course(field, what, memory, np.arange(count), pairs, swept, moved)


def frames_of(field: Field, what: int, work: int) -> int:
    """Frames in a sample: ``work`` objects in all, for the sweep in whole swings, so that any number of objects does the same."""
    if what != SWEEP:
        return max(1, work // SLOWER // len(field.boxes))
    swing = swing_of(field)
    return -(-max(1, work // len(field.boxes)) // swing) * swing


def swing_of(field: Field) -> int:
    """Frames of one swing to and fro; 1 if nothing moves."""
    return round(2.0 * np.pi / field.swing) if field.swing > 0.0 else 1


def measure(fields: Sequence[Field], layout: str, motion: str, name: str, warm: int, samples: int, work: int) -> list[Row]:
    """Microseconds per object and frame for fields of one kind that differ in their number of objects.

    A figure is the median over ``samples``, after ``warm`` frames and at least a swing, less the median of moving alone. Fields
    take turns, so that other programs on the machine slow down all of them alike; time of this process only, so that they count
    less. ``work``: objects times frames in a sample, at least; less for slow kernels, which have little to warm up besides.
    """
    what = KERNELS[name]
    courses = [course(field, what) for field in fields]
    many = [frames_of(field, what, work) for field in fields]
    for one in courses:
        one.seconds(NOTHING, 1)
        one.seconds(what, max(warm, swing_of(one.field)) if what == SWEEP else SLOWER)
    spent: list[list[tuple[float, float]]] = [[] for _ in courses]
    for _ in range(samples):
        for one, count, times in zip(courses, many, spent, strict=True):
            times.append((one.seconds(one.what, count), one.seconds(NOTHING, count) if len(one.field.moving) else 0.0))
    return [_row(one, layout, motion, name, count, times) for one, count, times in zip(courses, many, spent, strict=True)]


def _row(one: Course, layout: str, motion: str, name: str, frames: int, times: Sequence[tuple[float, float]]) -> Row:
    one.seconds(one.what, 1)
    twin, count = np.zeros((PAIRS_ROOM, 2), np.int64), len(one.field.boxes)
    many = all_pairs(one.swept[0], one.field.wanted, twin)[1]
    same = sorted(map(tuple, one.pairs[:many].tolist())) == sorted(map(tuple, twin[:many].tolist()))
    spent = float(np.median([swept for swept, _ in times]) - np.median([moved for _, moved in times]))
    kept: Iterator[NDArray[np.generic]] = iter(
        (*one.memory, *one.field.wanted) if one.what in (SWEEP, AFRESH) else (one.order,)
    )
    held = sum(array.nbytes for array in kept) + (count * count if one.what == ONE_AXIS else 0)
    return Row(layout, motion, count, name, 1e6 * spent / frames / count, held / count, int(many), bool(same))

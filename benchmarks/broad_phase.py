"""Time per object of the engine's sweep and of a sweep along one axis: any number of objects, the same number of near pairs.

Frames of moving boxes are timed with and without the sweep; the difference is the time of the sweep.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from time import process_time
from typing import Final

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.broad_phase import all_pairs, boxes_meet, sweep_and_prune
from avatarsim.collision.grid import SweepMemory, make_sweep_memory
from avatarsim.jit.by_reference import refer
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import PairFilter, may_meet
from benchmarks.broad_fields import LAYOUTS, MOTIONS, Field, field
from benchmarks.output import print_pivot, write_rows
from benchmarks.timing import take_turns

Array = NDArray[np.float64]
Index = NDArray[np.int64]

SIZES: Final = (20, 60, 200, 600, 2000, 6000, 20000)
PAIRS_ROOM: Final = 16
"""Room for near pairs; there are five."""
NOTHING, SWEEP, ONE_AXIS = range(3)
"""Work of a frame after the boxes have moved."""
KERNELS: Final = {"sweep and prune": SWEEP, "one axis": ONE_AXIS}
MAX_OBJECTS: Final = {SWEEP: 10**9, ONE_AXIS: 6000}
"""Beyond these a frame takes too long for a measurement."""
FULL, QUICK = (400, 9, 200_000), (3, 1, 100)
"""Warm-up frames, samples, and objects times frames in a sample."""
SLOWER: Final = 3
"""The sweep along one axis gets so many times less work, and so many frames to warm up."""


@dataclass(frozen=True)
class Row:
    """Time per object and frame [us], near pairs, and whether the same pairs were found as by comparing all with all."""

    layout: str
    motion: str
    objects: int
    kernel: str
    us_per_object_p50: float
    near_pairs: int
    found_all: bool


@kernel
def widest_axis(boxes: Array) -> int:
    """Return the axis along which box centres vary most."""
    best, widest = 0, -1.0
    for axis in range(3):
        total, squares, base = 0.0, 0.0, boxes[0, axis] + boxes[0, axis + 3]
        for i in range(boxes.shape[0]):
            centre = boxes[i, axis] + boxes[i, axis + 3] - base
            total += centre
            squares += centre * centre
        spread = squares - total * total / boxes.shape[0]
        if spread > widest:
            best, widest = axis, spread
    return best


@kernel
def one_axis(boxes: Array, wanted: PairFilter, order_out: Index, pairs_out: Index) -> int:
    """Return the plain sweep: number of pairs that meet; ``order_out`` (n) is a permutation that stays from call to call."""
    axis, count = widest_axis(boxes), 0
    for k in range(1, order_out.shape[0]):
        box, at = order_out[k], k
        while at > 0 and boxes[order_out[at - 1], axis] > boxes[box, axis]:
            order_out[at] = order_out[at - 1]
            at -= 1
        order_out[at] = box
    for k in range(order_out.shape[0]):
        box = order_out[k]
        for after in range(k + 1, order_out.shape[0]):
            other = order_out[after]
            if boxes[other, axis] > boxes[box, axis + 3]:
                break
            if boxes_meet(boxes, box, other) and may_meet(wanted, box, other):
                if count < pairs_out.shape[0]:
                    pairs_out[count, 0], pairs_out[count, 1] = min(box, other), max(box, other)
                count += 1
    return count


@kernel
def frames(
    what: int, count: int, boxes: Array, rest: Array, moving: Index, speed: Array, swing: float, wanted: PairFilter,
    memory: SweepMemory, order: Index, pairs: Index,
) -> int:
    """So many frames; every moving box swings about its ``rest``. Returns the number of pairs found in the last one."""
    # as the engine passes them; by value they would be copied in every frame
    wanted, memory = refer(wanted), refer(memory)
    pair_count = 0
    for _ in range(count):
        for m in range(moving.shape[0]):
            b = moving[m]
            for k in range(3):
                speed[m, k] -= swing * swing * (boxes[b, k] - rest[b, k])
                boxes[b, k] += speed[m, k]
                boxes[b, k + 3] += speed[m, k]
        if what == SWEEP:
            pair_count = sweep_and_prune(boxes, wanted, memory, pairs)[1]
        elif what == ONE_AXIS:
            pair_count = one_axis(boxes, wanted, order, pairs)
    return pair_count


class Course:
    """A field that is swept, and a copy that only moves: the sweep must miss no frame while moving alone is timed."""

    def __init__(self, field: Field, what: int, work: int) -> None:
        count = len(field.boxes)
        self.field, self.what, self.order = field, what, np.arange(count)
        self.memory = make_sweep_memory(count, PAIRS_ROOM + count)
        self.pairs = np.zeros((PAIRS_ROOM, 2), np.int64)
        self.swept, self.moved = ((field.boxes.copy(), field.speed.copy()) for _ in range(2))
        # `work` objects in all, for the sweep in whole swings, so that any number of objects does the same
        swings = -(-max(1, work // count) // field.period)
        self.frames = swings * field.period if what == SWEEP else max(1, work // SLOWER // count)

    def seconds(self, what: int, count: int) -> float:
        """Return the time of this process that so many frames take."""
        here = self.field
        boxes, speed = self.moved if what == NOTHING else self.swept
        begun = process_time()
        frames(what, count, boxes, here.boxes, here.moving, speed, here.swing, here.wanted, self.memory, self.order, self.pairs)
        return process_time() - begun

    def sample(self) -> tuple[float, float]:
        """Return seconds with and without the sweep."""
        moved = self.seconds(NOTHING, self.frames) if len(self.field.moving) else 0.0
        return self.seconds(self.what, self.frames), moved

    def near(self) -> tuple[int, bool]:
        """Return the number of near pairs after one more frame, and whether all were found."""
        self.seconds(self.what, 1)
        everything = np.zeros((PAIRS_ROOM, 2), np.int64)
        count = int(all_pairs(self.swept[0], self.field.wanted, everything)[1])
        return count, sorted(self.pairs[:count].tolist()) == sorted(everything[:count].tolist())


def measure(layout: str, motion: str, name: str, sizes: Sequence[int], plan: tuple[int, int, int]) -> list[Row]:
    """Return microseconds per object and frame for fields that differ in their number of objects.

    A figure is the median over the samples, after warm-up frames and at least a swing, less the median of moving alone. Time of
    this process only, so that other programs count less.
    """
    what, (warm, samples, work) = KERNELS[name], plan
    courses = {size: Course(field(layout, motion, size), what, work) for size in sizes if size <= MAX_OBJECTS[what]}
    for one in courses.values():
        one.seconds(NOTHING, 1)
        one.seconds(what, max(warm, one.field.period) if what == SWEEP else SLOWER)
    times = take_turns({size: partial(Course.sample, one) for size, one in courses.items()}, samples)
    rows = []
    for size, one in courses.items():
        swept, moved = np.median(times[size], axis=0)
        rows.append(Row(layout, motion, size, name, 1e6 * float(swept - moved) / one.frames / size, *one.near()))
    return rows


def run(arguments: argparse.Namespace, folder: Path) -> int:
    """Measure, write, print. 1: near pairs were missed."""
    plan, sizes = (QUICK, SIZES[:3]) if arguments.quick else (FULL, SIZES)
    rows: list[Row] = []
    for layout in LAYOUTS:
        for motion in MOTIONS:
            for name in KERNELS if motion == "all slow" else list(KERNELS)[:1]:
                rows += measure(layout, motion, name, sizes, plan)
            print(f"broad phase  {layout}, {motion}", file=sys.stderr, flush=True)
    print_pivot("us per object and frame", rows, ("layout", "motion", "kernel"), "objects", "us_per_object_p50")
    write_rows(folder / "broad_phase.csv", rows, Row)
    return 0 if all(row.found_all for row in rows) else 1

"""Frames of many worlds in one kernel call, world after world, as Gym-style vectorised simulators batch their environments.

A call of a kernel from Python costs more than a small scene's frame, and two threads that hand Python's global lock to and fro
with every frame are no faster than one. So the arenas of many worlds are named by their addresses, and their frames are passed
without that lock. Each world's stages are those of `frame.Frames.frame`, by the same kernels in the same order: the same bits.
"""

from enum import IntEnum

import numpy as np

from avatarsim.jit.arena import opened, words_at
from avatarsim.jit.kernel import entry_kernel
from avatarsim.jit.layout import Array, Index
from avatarsim.lower_loop import NOTHING_RECEIVED, IkLoop, track
from avatarsim.model.world import Target, World
from avatarsim.rigid.step import SimulatedLoop, UpperParts, advance_opened


class Job(IntEnum):
    """Columns of a row of jobs: one world's frame."""

    WORLD = 0
    """Address of the arena of the world; its words are counted in the next column, as of all arenas."""
    TARGET = 2
    """The same of the target."""
    LOWER = 4
    """The same of the lower loop; no words: the world has no avatar."""
    UPPER = 6
    """The same of the upper loop; no words: the world has no loose bodies that move."""
    MOVING = 8
    """Address of the flags (nb) of bodies that moved in the last frame; how many there are is 0 before the first frame."""
    COUPLED = 10
    """1 if what the upper loop does to driven bodies goes back into the lower one."""
    STATUS = 11
    """Status of the upper loop, written by the kernel."""


WORLD, TARGET, LOWER, UPPER, MOVING, COUPLED, STATUS = map(int, Job)
"""The columns as kernels read them."""

COLUMNS = len(Job) + 5
"""Columns of a row: five addresses have a length behind them."""


@entry_kernel
def advance_worlds(jobs: Index, dt: float, nothing: Array) -> None:
    """One frame of ``dt`` [s] of each world in ``jobs`` (worlds, COLUMNS), whose target has been read; ``nothing`` (0, 3)."""
    for k in range(jobs.shape[0]):
        world = words_at(jobs[k, WORLD], jobs[k, WORLD + 1])
        target, lower = words_at(jobs[k, TARGET], jobs[k, TARGET + 1]), words_at(jobs[k, LOWER], jobs[k, LOWER + 1])
        if lower.shape[0] > 0:
            track(world, target, lower, dt, False, nothing, words_at(jobs[k, MOVING], jobs[k, MOVING + 1]))
        upper = words_at(jobs[k, UPPER], jobs[k, UPPER + 1])
        if upper.shape[0] > 0:
            jobs[k, STATUS] = advance_opened(world, upper, dt)
            if jobs[k, COUPLED] == 1:
                memory = opened(upper, UpperParts).memory
                track(world, target, lower, 0.0, True, memory.received, memory.moving)


def job_of(world: World, target: Target | None, lower: IkLoop | None, upper: SimulatedLoop | None, moving: Index) -> Index:
    """The row (COLUMNS) of a world whose parts these are, as of its first frame; valid as long as they are."""
    row = np.zeros(COLUMNS, dtype=np.int64)
    parts: tuple[World | Target | IkLoop | SimulatedLoop | None, ...] = world, target, lower, upper
    for column, part in zip((WORLD, TARGET, LOWER, UPPER), parts, strict=True):
        if part is not None:
            row[column : column + 2] = part.words.ctypes.data, len(part.words)
    row[MOVING] = moving.ctypes.data
    row[COUPLED] = int(lower is not None and upper is not None and world.scene.effects.coupling)
    return row


def advance_together(jobs: Index, dt: float) -> None:
    """`advance_worlds` as Python calls it."""
    advance_worlds(jobs, dt, NOTHING_RECEIVED)

"""Frames of many worlds in one kernel call, world after world, as Gym-style vectorised simulators batch their environments.

A call of a kernel from Python costs more than a small scene's frame, and two threads that hand Python's global lock to and fro
with every frame are no faster than one. So the arenas of many worlds are named by their addresses, and their frames are passed
without that lock. Each world's stages are those of `frame.Frames.frame`, by the same kernels in the same order: the same bits.
"""

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from avatarsim.jit.arena import pack, view_arena, words_at
from avatarsim.jit.kernel import entry_kernel, kernel
from avatarsim.jit.layout import Array, Index, IndexLine, Line, Vectors
from avatarsim.lower_loop import NOTHING_RECEIVED, STATUS_PLACES, IkLoop, IkParts, track
from avatarsim.model.conversion import write_shown
from avatarsim.model.world import Target, World, WorldParts, shown_poses
from avatarsim.rigid.step import SimulatedLoop, UpperParts, advance_opened


class Job(IntEnum):
    """Columns of a row of jobs: one world's frame."""

    WORLD = 0
    """Address of the arena of the world; its words are counted in the next column, as of all arenas."""
    TARGET = 2
    """Address of the arena of the target."""
    LOWER = 4
    """Address of the arena of the lower loop; no words: the world has no avatar."""
    UPPER = 6
    """Address of the arena of the upper loop; no words: the world has no loose bodies that move."""
    SHOWN = 8
    """Address of the arena of the shown state."""
    MOVING = 10
    """Address of the flags (nb) of bodies that moved in the last frame; their number is 0 before the first frame."""
    COUPLED = 12
    """1 if the effect of the upper loop on driven bodies goes back into the lower one."""
    STATUS = 13
    """Status of the upper loop, written by the kernel, as are the next two."""
    SAID = 14
    """1 if the lower loop has a status to report in the record."""
    FINITE = 15
    """1 if all shown numbers are finite."""


WORLD, TARGET, LOWER, UPPER, SHOWN, MOVING, COUPLED, STATUS, SAID, FINITE = map(int, Job)
"""The columns as kernels read them."""

COLUMNS = FINITE + 1
"""Columns of a row."""

SAID_AT = tuple(place for _, place in STATUS_PLACES)
"""Indices of the counts of a lower loop that a record shows as statuses."""


class Shown(NamedTuple):
    """Shown numbers and their sources: centres (nb, 3) of mass in body frames [m]; first, the first body that ever moves;
    positions (nb, 3) [m] and orientations (nb, 4) of body frames; angles (nh) [rad], and the degree of each."""

    centres: Vectors
    first: int
    positions: Vectors
    orientations: Vectors
    angles: Line
    hinges: IndexLine


@kernel
def show(world: Index, shown: Index) -> bool:
    """Write the shown state of a world; return False if a number of it is not finite."""
    w, own = view_arena(world, WorldParts), view_arena(shown, Shown)
    for k in range(own.hinges.shape[0]):
        own.angles[k] = w.posture.angle[own.hinges[k]]
    return write_shown(w.poses.position, w.poses.rotation, own.centres, own.first, own.positions, own.orientations)


@kernel
def has_said(lower: Index) -> bool:
    """Return True if a lower loop has counted anything that a record shows as a status."""
    counts = view_arena(lower, IkParts).working.counts
    for place in SAID_AT:
        if counts[place] != 0:
            return True
    return False


@entry_kernel
def advance_worlds(jobs: Index, dt: float, nothing: Array) -> None:
    """Pass a frame of ``dt`` [s] of each world in ``jobs`` (worlds, COLUMNS), whose target has been read; ``nothing`` (0, 3)."""
    for k in range(jobs.shape[0]):
        world = words_at(jobs[k, WORLD], jobs[k, WORLD + 1])
        target, lower = words_at(jobs[k, TARGET], jobs[k, TARGET + 1]), words_at(jobs[k, LOWER], jobs[k, LOWER + 1])
        if lower.shape[0] > 0:
            track(world, target, lower, dt, False, nothing, words_at(jobs[k, MOVING], jobs[k, MOVING + 1]))
        upper = words_at(jobs[k, UPPER], jobs[k, UPPER + 1])
        if upper.shape[0] > 0:
            jobs[k, STATUS] = advance_opened(world, upper, dt)
            if jobs[k, COUPLED] == 1:
                memory = view_arena(upper, UpperParts).memory
                track(world, target, lower, 0.0, True, memory.received, memory.moving)
        if lower.shape[0] > 0:
            jobs[k, SAID] = 1 if has_said(lower) else 0
        jobs[k, FINITE] = 1 if show(world, words_at(jobs[k, SHOWN], jobs[k, SHOWN + 1])) else 0


class Output:
    """Memory for the shown state of the frames of a world, when kernels write it."""

    def __init__(self, world: World) -> None:
        on = world.scene.effects
        # without simulated bodies only links move
        first = 0 if on.dynamics or on.coupling else world.skeleton.first
        angles = world.posture.angle[world.hinges]
        self.words, self.shown = pack(Shown(world.centres, first, *shown_poses(world), angles, world.hinges))


def job_of(
    world: World, target: Target | None, lower: IkLoop | None, upper: SimulatedLoop | None, output: Output, moving: Index
) -> Index:
    """Return the row (COLUMNS) of a world whose parts these are, as of its first frame; valid as long as they are."""
    row = np.zeros(COLUMNS, dtype=np.int64)
    parts: tuple[World | Target | IkLoop | SimulatedLoop | Output | None, ...] = world, target, lower, upper, output
    for column, part in zip((WORLD, TARGET, LOWER, UPPER, SHOWN), parts, strict=True):
        if part is not None:
            row[column : column + 2] = part.words.ctypes.data, len(part.words)
    row[MOVING] = moving.ctypes.data
    row[COUPLED] = int(lower is not None and upper is not None and world.scene.effects.coupling)
    return row


def advance_together(jobs: Index, dt: float) -> None:
    """Run `advance_worlds`, as Python calls it."""
    advance_worlds(jobs, dt, NOTHING_RECEIVED)

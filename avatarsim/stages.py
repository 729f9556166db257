"""The stages of a frame as kernels: one by one for one world, all in one call for many (`pass_frames`).

Many worlds are passed together as Gym-style vectorised simulators batch their environments: a call of a kernel from Python costs
more than a small scene's frame, and two threads that hand Python's global lock to and fro with every frame are no faster than
one. So the arenas of a world are named by their addresses in a row of jobs, and the kernels run without that lock. One world
calls a kernel per stage: a scene that needs one stage loads no machine code of the others.
"""

from collections.abc import Collection
from enum import IntEnum
from typing import ClassVar, NamedTuple

import numpy as np

from avatarsim.counters import Stage
from avatarsim.jit.arena import pack, view_arena, words_at
from avatarsim.jit.kernel import entry_kernel, kernel
from avatarsim.jit.layout import Index, IndexLine, Line, Vectors
from avatarsim.lower_loop import STATUS_PLACES, IkLoop, IkParts, resume_after_contacts, step_avatars
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
    """Address of the arena of the lower loop; no words: the world has no avatar, or one that moves by another method."""
    UPPER = 6
    """Address of the arena of the upper loop; no words: the world has no loose bodies that move."""
    SHOWN = 8
    """Address of the arena of the shown state."""
    MOVING = 10
    """Address of the flags (nb) of bodies that moved in the last frame; their number is 0 before the first frame."""
    STAGES = 12
    """Stages that the world needs, one bit each."""
    STATUS = 13
    """Status of the upper loop, written by the kernel, as are the next two."""
    HAS_STATUS = 14
    """1 if the lower loop has a status to report in the record."""
    FINITE = 15
    """1 if all shown numbers are finite."""


WORLD, TARGET, LOWER, UPPER, SHOWN, MOVING, STAGES, STATUS, HAS_STATUS, FINITE = map(int, Job)
"""The columns as kernels read them."""

COLUMNS = FINITE + 1
"""Columns of a row."""

POSTURE, MOTION, COUPLING = map(int, Stage)
"""The stages as kernels read them."""

STATUSES_AT = tuple(place for _, place in STATUS_PLACES)
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
def has_status(lower: Index) -> bool:
    """Return True if a lower loop has counted anything that a record shows as a status."""
    counts = view_arena(lower, IkParts).working.counts
    for place in STATUSES_AT:
        if counts[place] != 0:
            return True
    return False


@entry_kernel
def pass_posture(job_out: Index, dt: float) -> None:
    """Pass the stage POSTURE of one world."""
    target, lower = words_at(job_out[TARGET], job_out[TARGET + 1]), words_at(job_out[LOWER], job_out[LOWER + 1])
    step_avatars(words_at(job_out[WORLD], job_out[WORLD + 1]), target, lower, dt, words_at(job_out[MOVING], job_out[MOVING + 1]))


@entry_kernel
def pass_motion(job_out: Index, dt: float) -> None:
    """Pass the stage MOTION of one world."""
    upper = words_at(job_out[UPPER], job_out[UPPER + 1])
    job_out[STATUS] = advance_opened(words_at(job_out[WORLD], job_out[WORLD + 1]), upper, dt)


@entry_kernel
def pass_coupling(job_out: Index, dt: float) -> None:
    """Pass the stage COUPLING of one world."""
    target, lower = words_at(job_out[TARGET], job_out[TARGET + 1]), words_at(job_out[LOWER], job_out[LOWER + 1])
    memory = view_arena(words_at(job_out[UPPER], job_out[UPPER + 1]), UpperParts).memory
    resume_after_contacts(words_at(job_out[WORLD], job_out[WORLD + 1]), target, lower, memory.received, memory.moving)


@kernel
def pass_shown(job_out: Index) -> None:
    """Write the shown state of one world, and whether there is anything to report of it."""
    lower, shown = words_at(job_out[LOWER], job_out[LOWER + 1]), words_at(job_out[SHOWN], job_out[SHOWN + 1])
    job_out[HAS_STATUS] = 1 if lower.shape[0] > 0 and has_status(lower) else 0
    job_out[FINITE] = 1 if show(words_at(job_out[WORLD], job_out[WORLD + 1]), shown) else 0


STAGE_KERNELS = (pass_posture, pass_motion, pass_coupling)
"""The kernels of the stages, in order."""


@entry_kernel
def pass_frames(jobs: Index, dt: float) -> None:
    """Pass a frame of ``dt`` [s] of each world in ``jobs`` (worlds, COLUMNS), whose target has been read."""
    for k in range(jobs.shape[0]):
        # in the order of `Stage`, as for one world
        stages = jobs[k, STAGES]
        if stages & (1 << POSTURE):
            pass_posture(jobs[k], dt)
        if stages & (1 << MOTION):
            pass_motion(jobs[k], dt)
        if stages & (1 << COUPLING):
            pass_coupling(jobs[k], dt)
        pass_shown(jobs[k])


class Output:
    """Memory for the shown state of a world, which kernels write."""

    ASSIGNED: ClassVar[tuple[str, ...]] = ()
    WRITTEN: ClassVar[tuple[str, ...]] = ("words",)

    def __init__(self, world: World) -> None:
        on = world.scene.effects
        # without simulated bodies only links move
        first = 0 if on.dynamics or on.coupling else world.skeleton.first
        angles = world.posture.angle[world.hinges]
        self.words, self.shown = pack(Shown(world.centres, first, *shown_poses(world), angles, world.hinges))

    def retained_state(self) -> tuple[()]:
        """Return nothing: the shown state follows from that of the world."""
        return ()


def make_job(
    world: World, target: Target | None, lower: IkLoop | None, upper: SimulatedLoop | None, output: Output, moving: Index,
    stages: Collection[Stage],
) -> Index:
    """Return the job (COLUMNS) of a world whose parts these are, as of its first frame; valid as long as the parts are."""
    job = np.zeros(COLUMNS, dtype=np.int64)
    parts: tuple[World | Target | IkLoop | SimulatedLoop | Output | None, ...] = world, target, lower, upper, output
    for column, part in zip((WORLD, TARGET, LOWER, UPPER, SHOWN), parts, strict=True):
        if part is not None:
            job[column : column + 2] = part.words.ctypes.data, len(part.words)
    job[MOVING] = moving.ctypes.data
    job[STAGES] = sum(1 << stage for stage in stages)
    return job

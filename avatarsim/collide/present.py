"""Insertion and removal of bodies in the broad phase, in constant time: slots of fixed arrays are taken and freed."""

from math import inf

from avatarsim.collide.cells import unlink
from avatarsim.collide.sweep_memory import PRESENT, STALE, SweepMemory
from avatarsim.jit.kernel import kernel


@kernel
def forget(memory: SweepMemory, b: int) -> None:
    """Drop the fat box of body b, so that the next broad phase searches its pairs anew: its pair filter has changed."""
    for k in range(3):
        memory.fat[b, k], memory.fat[b, 3 + k] = inf, -inf


@kernel
def insert(memory: SweepMemory, b: int) -> None:
    """Mark slot b as taken from the next broad phase on; no effect if it is already."""
    if memory.body[PRESENT, b] == 0:
        memory.body[PRESENT, b] = 1
        forget(memory, b)


@kernel
def remove(memory: SweepMemory, b: int) -> None:
    """Mark slot b as free from the next broad phase on, so that its box is not read; no effect if it is already."""
    if memory.body[PRESENT, b] == 1:
        unlink(memory, b)
        memory.body[PRESENT, b], memory.known[b] = 0, False
        memory.used[STALE] = 1
        forget(memory, b)

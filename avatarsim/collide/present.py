"""Bodies that come and go while sweep and prune runs: places of fixed arrays that are taken and freed, in constant time."""

from math import inf

from avatarsim.collide.cells import unlink
from avatarsim.collide.sweep_memory import PRESENT, STALE, SweepMemory
from avatarsim.jit.kernel import kernel


@kernel
def forget(memory: SweepMemory, b: int) -> None:
    """Let the next sweep look for the pairs of body b anew, because the pair filter has changed for it."""
    for k in range(3):
        memory.fat[b, k], memory.fat[b, 3 + k] = inf, -inf


@kernel
def insert(memory: SweepMemory, b: int) -> None:
    """From the next sweep on place b holds a body; nothing happens if it does already."""
    if memory.body[PRESENT, b] == 0:
        memory.body[PRESENT, b] = 1
        forget(memory, b)


@kernel
def remove(memory: SweepMemory, b: int) -> None:
    """From the next sweep on place b holds nobody and its box is not read; nothing happens if it does not already."""
    if memory.body[PRESENT, b] == 1:
        unlink(memory, b)
        memory.body[PRESENT, b], memory.known[b] = 0, False
        memory.used[STALE] = 1
        forget(memory, b)

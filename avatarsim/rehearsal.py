"""Warm-up at load: the scene's own first frame is run and undone, so that its kernels are loaded and the caches are warm.

numba brings a kernel into memory when it is first called: 40 ms to half a second in a process whose kernels are compiled, half a
minute in one whose are not. Which kernels a frame calls from Python depends on the scene's effects, the method and the settings;
the frame itself knows. Those that it calls only sometimes are called at load by the loop that holds them.

A frame that is undone by copying everything back leaves the processor's caches full of the copies: megabytes, most of them room
that the scene never uses. The next frame then waits for memory, 10 to 40 us, several times a small scene's frame. So
the words that such a frame changed are found, and some more are run of which only these are undone: they end with the data of a
frame, and its code, in the caches, and with Python's own code for it specialised.
"""

from collections.abc import Iterator, Sequence
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from avatarsim.counters import WORD

REHEARSALS = 10
"""Frames run and undone before the first: Python (3.11 to 3.13) specialises a function for its arguments once it has been called
eight times, and two more run the result. With 1, a small scene's first frame takes half as long again."""

ENOUGH = 0.02
"""Time [s] of rehearsing after which no further one is begun: longer frames do not feel cold caches, and `load` would wait."""


class Part(Protocol):
    """An object that takes part in a frame, and names the data that a frame changes. Its dictionary is not read: Python would
    make one, and read each attribute through it from then on, which costs every later frame a twentieth."""

    ASSIGNED: ClassVar[tuple[str, ...]]
    """Names of attributes that a frame assigns to."""
    WRITTEN: ClassVar[tuple[str, ...]]
    """Names of attributes whose arrays a frame writes into: arrays, or nested tuples of them."""

    def retained_state(self) -> tuple[object, ...]:
        """Return arrays, in nested named tuples, that pass from frame to frame: the content of a snapshot, but for those that
        are marked otherwise (`avatarsim.jit.kept`). Views of those above, or they."""


class Undo:
    """State of `parts` when it is made: the same objects in their attributes, the same bits in their arrays. Called, it makes
    them that again. Views are left to the arrays that they show, which must be among those."""

    def __init__(self, parts: Sequence[Part]) -> None:
        self._attributes = [(part, name, getattr(part, name)) for part in parts for name in part.ASSIGNED]
        arrays = [_words(array) for part in parts for name in part.WRITTEN for array in _owned(getattr(part, name))]
        self._all = [(words, words.copy()) for words in arrays]
        self._changed: list[tuple[NDArray[np.generic], NDArray[np.intp], NDArray[np.generic]]] | None = None

    def keep_what_changed(self) -> None:
        """Restore only the words that differ now from here on: enough where the same frame is run again from the same state,
        since its kernels do the same to the bit, and so little that the caches keep the data of that frame."""
        self._changed = []
        for words, before in self._all:
            places = np.flatnonzero(words != before)
            self._changed.append((words, places, before[places]))
        self._all = []

    def __call__(self) -> None:
        """Restore the state."""
        for part, name, value in self._attributes:
            setattr(part, name, value)
        for words, before in self._all:
            words[...] = before
        for words, places, bits in self._changed or ():
            words[places] = bits


def _words(array: NDArray[np.generic]) -> NDArray[np.generic]:
    """Return the memory of an array that owns it, as whole numbers: they differ where bits do, also in NaNs."""
    if not array.flags.forc:
        raise ValueError("an array that a frame writes into must be one piece of memory, or what is brought back were a copy")
    flat = array.ravel(order="K").view(np.uint8)
    return flat.view(np.uint64) if flat.size % WORD == 0 else flat


def _owned(value: object) -> Iterator[NDArray[np.generic]]:
    """Return arrays in nested tuples that are no views of others."""
    if isinstance(value, np.ndarray):
        if value.base is None:
            yield value
    elif isinstance(value, tuple):
        for part in value:
            yield from _owned(part)

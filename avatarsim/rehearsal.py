"""A dress rehearsal: the scene's own frame path is run once and undone, so that nothing is left for the first frame to load.

numba brings a kernel into memory when it is first called: 40 ms to half a second in a process whose kernels are compiled, half a
minute in one whose are not. Which kernels a frame calls from Python depends on the scene's effects, the method and the settings;
the frame itself knows. Those that it calls only sometimes are called at load by the loop that holds them.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray


class Part(Protocol):
    """An object that takes part in a frame, and says of itself what a frame changes. It is not asked for its dictionary: Python
    would make one, and read each attribute through it from then on, which costs every later frame a twentieth."""

    ASSIGNED: ClassVar[tuple[str, ...]]
    """Names of attributes that a frame assigns to."""
    WRITTEN: ClassVar[tuple[str, ...]]
    """Names of attributes whose arrays a frame writes into: arrays, or nested tuples of them."""
    KEPT: ClassVar[tuple[str, ...]]
    """Names of attributes whose arrays frames hand on to one another: what a snapshot holds. Views of those above, or they."""
    WORKING: ClassVar[tuple[str, ...]]
    """Dotted names of arrays among those, and of tuples, that hold nothing from frame to frame, or nothing that changes."""

    def ranges(self) -> Mapping[str, tuple[int, int]]:
        """Least and largest value of whole numbers that are kept, by the end of their dotted name."""


@contextmanager
def undone(parts: Sequence[Part]) -> Iterator[None]:
    """At the end of the block `parts` are what they were: the same objects in their attributes, the same bits in their arrays.
    Views are left to the arrays that they show, which must be among those."""
    attributes = [(part, name, getattr(part, name)) for part in parts for name in part.ASSIGNED]
    arrays = [array for part in parts for name in part.WRITTEN for array in _owned(getattr(part, name))]
    before = [(array, array.copy()) for array in arrays]
    try:
        yield
    finally:
        for part, name, value in attributes:
            setattr(part, name, value)
        for array, bits in before:
            array[...] = bits


def _owned(value: object) -> Iterator[NDArray[np.generic]]:
    """Arrays in nested tuples that are no views of others."""
    if isinstance(value, np.ndarray):
        if value.base is None:
            yield value
    elif isinstance(value, tuple):
        for part in value:
            yield from _owned(part)

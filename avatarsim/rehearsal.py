"""A dress rehearsal: the scene's own frame path is run once and undone, so that nothing is left for the first frame to load.

numba brings a kernel into memory when it is first called: 40 ms to half a second in a process whose kernels are compiled, half a
minute in one whose are not. Which kernels a frame calls from Python depends on the scene's effects, the method and the settings;
the frame itself knows. Those that it calls only sometimes are called at load by the loop that holds them.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray


@contextmanager
def undone(parts: Sequence[object]) -> Iterator[None]:
    """At the end of the block all attributes of `parts` are what they were, and every array that an attribute holds, by itself or
    in nested tuples, has the bits that it had. Views are left to the arrays that they show, which must be among those."""
    attributes = [dict(vars(part)) for part in parts]
    arrays = {id(array): array for held in attributes for value in held.values() for array in _owned(value)}
    before = [(array, array.copy()) for array in arrays.values() if array.flags.writeable]
    try:
        yield
    finally:
        for part, held in zip(parts, attributes, strict=True):
            vars(part).update(held)
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

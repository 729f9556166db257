"""How do nested tuples of arrays lie in memory where compiled code reads them?

As structures within structures: a number is a number, a flag one byte, a record the word where it lies, an array what numba keeps
of one: two words for memory that is counted (nobody counts here), how many elements, of how many bytes each, where they lie,
the lengths, and the strides. So an entry kernel need not put an arena's arrays together again in every frame, which was a tenth
of what the compiler had to read.
"""

from math import prod

import numpy as np

WORD = 8
"""Bytes of a word."""


class Image:
    """Bytes of nested tuples, laid down one after another, and where in them words say where something lies."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.places: list[int] = []
        """Where each array or number was laid down, in bytes."""
        self.addresses: list[int] = []
        """Where a word lies that is an address, in bytes."""

    def lay(self, tree: object, starts: dict[int, int]) -> None:
        """Lay down a tree; `starts`: by its id, the byte at which an array or record lies."""
        if isinstance(tree, tuple):
            self.fill(aligned(tree))
            for branch in tree:
                self.lay(branch, starts)
            self.fill(aligned(tree))
            return
        self.fill(aligned(tree))
        self.places.append(len(self.data))
        if isinstance(tree, bool | np.bool_):
            self.data.append(bool(tree))
        elif isinstance(tree, float):
            self.data += np.float64(tree).tobytes()
        elif isinstance(tree, np.ndarray):
            self.words(0, 0, tree.size, tree.itemsize)
            self.address(starts[id(tree)])
            self.words(*tree.shape, *(tree.itemsize * prod(tree.shape[k + 1 :]) for k in range(tree.ndim)))
        elif isinstance(tree, np.void):
            self.address(starts[id(tree)])
        else:
            self.words(int(tree))  # type: ignore[call-overload]  # an int, as all that is left

    def fill(self, alignment: int) -> None:
        """Leave room up to a multiple of so many bytes."""
        self.data += bytes(-len(self.data) % alignment)

    def words(self, *values: int) -> None:
        """Lay down whole numbers."""
        self.data += np.array(values, dtype=np.int64).tobytes()

    def address(self, byte: int) -> None:
        """Lay down a word that says where something lies."""
        self.addresses.append(len(self.data))
        self.words(byte)


def aligned(tree: object) -> int:
    """Of how many bytes the place of a number, an array or a tuple is a multiple: a structure's is that of its strictest part."""
    if isinstance(tree, tuple):
        return max(map(aligned, tree), default=1)
    return 1 if isinstance(tree, bool | np.bool_) else WORD

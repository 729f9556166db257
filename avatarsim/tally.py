"""Counters of a frame by name, unpacked only when they are read."""

from collections.abc import ItemsView, Iterator, Mapping, Sequence

import numpy as np

WORD = np.dtype(np.int64).itemsize
"""Bytes of one number."""


class Tally(Mapping[str, int]):
    """`numbers` in the order of `names`: as integers, or as the bytes of an array of int64.

    They are held as bytes and read when asked for: to fill a dictionary of them takes longer than to certify a pair, in every
    frame, and a list is one more object for Python's cyclic collector."""

    __slots__ = ("_names", "_numbers")

    def __init__(self, names: tuple[str, ...] = (), numbers: Sequence[int] | bytes = b"") -> None:
        self._names = names
        self._numbers = numbers if isinstance(numbers, bytes) else np.array(numbers, dtype=np.int64).tobytes()

    def __getitem__(self, name: str) -> int:
        if name not in self._names:
            raise KeyError(name)
        return self._all()[self._names.index(name)]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        return repr(dict(self.items()))

    def _all(self) -> memoryview:
        return memoryview(self._numbers).cast("q")

    def items(self) -> ItemsView[str, int]:
        """Names and numbers, in their order."""
        return dict(zip(self._names, self._all(), strict=True)).items()

    def beside(self, other: "Tally", names: tuple[str, ...]) -> "Tally":
        """Both; `names` are those of this one, then of the other: a caller in every frame has put them together once."""
        return Tally(names, self._numbers + other._numbers)

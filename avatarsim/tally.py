"""Numbers by name that few ever ask for: what a frame counted."""

from collections.abc import ItemsView, Iterator, Mapping


class Tally(Mapping[str, int]):
    """`numbers` in the order of `names`. To fill a dictionary of them takes longer than to certify a pair, in every frame."""

    __slots__ = ("_names", "_numbers")

    def __init__(self, names: tuple[str, ...] = (), numbers: tuple[int, ...] | list[int] = ()) -> None:
        self._names, self._numbers = names, numbers

    def __getitem__(self, name: str) -> int:
        if name not in self._names:
            raise KeyError(name)
        return self._numbers[self._names.index(name)]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        return repr(dict(self.items()))

    def items(self) -> ItemsView[str, int]:
        """Names and numbers, in their order."""
        return dict(zip(self._names, self._numbers, strict=True)).items()

    def beside(self, other: "Tally") -> "Tally":
        """Both; no name stands in both."""
        return Tally((*self._names, *other._names), (*self._numbers, *other._numbers))

"""Processes that time job after job, so that a hundred short ones need not begin a hundred times."""

from types import TracebackType
from typing import Self

from scenarios.seat import PATIENCE, Seat


class Seats:
    """One process per name, started when it is first needed and again when it has ended; use as a context."""

    def __init__(self, patience: float = PATIENCE) -> None:
        self.patience = patience
        self.taken: dict[str, Seat] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        for seat in self.taken.values():
            seat.leave(at_once=kind is not None)

    def at(self, name: str) -> Seat:
        """The process of that name."""
        if name in self.taken and self.taken[name].gone:
            self.taken.pop(name).leave()
        if name not in self.taken:
            self.taken[name] = Seat(self.patience)
        return self.taken[name]

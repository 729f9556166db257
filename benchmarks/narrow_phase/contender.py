"""Pairs of shapes and their poses, and the protocol of a library that answers their signed distances."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.shape import Shape

Array = NDArray[np.float64]
Mode = Literal["cold", "coherent"]


class Cell(NamedTuple):
    """Two kinds of shape and a regime."""

    shape_a: str
    shape_b: str
    regime: str

    @property
    def name(self) -> str:
        """Name in tables."""
        return f"{self.shape_a}-{self.shape_b} {self.regime}"


@dataclass(frozen=True, eq=False)
class Trial:
    """Pairs of a cell: `shapes` (2 n) of n pairs, two in a row, and their poses in every frame.

    turns (frames, 2 n, 3, 3); at (frames, 2 n, 3) [m]. In mode `cold` the poses of each frame are drawn anew.
    """

    cell: Cell
    mode: Mode
    shapes: tuple[Shape, ...]
    turns: Array
    at: Array

    @property
    def pairs(self) -> int:
        """Number of pairs."""
        return len(self.shapes) // 2


class Contender:
    """One library with one setting. Poses are set before the clock starts, queries are timed, answers are read afterwards.

    name      as tables show it
    library   the distribution it comes from
    per_call  whether every query is a call from Python of its own; otherwise one call answers all pairs of a frame
    """

    def __init__(self, name: str, library: str, per_call: bool) -> None:
        self.name, self.library, self.per_call = name, library, per_call
        self.found: Sequence[Any] = ()

    def load(self, trial: Trial) -> None:
        """Make every object that the trial needs."""
        raise NotImplementedError

    def begin(self) -> None:
        """Forget earlier frames."""

    def pose(self, frame: int) -> None:
        """Put all shapes where they are in the frame; not timed."""
        raise NotImplementedError

    def query(self) -> None:
        """Query all pairs once; timed."""
        raise NotImplementedError

    def answers(self) -> Array:
        """Return signed distances (n,) [m] found by the last `query`; inf where a pair got no answer."""
        return np.array(self.found)

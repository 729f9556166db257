"""What the benchmark knows of a contender: pairs are posed before the clock starts, asked while it runs, read afterwards."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from reference.narrow_phase.cells import Mode, Sequence

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Identity:
    """What identifies a contender.

    name      as tables show it
    library   the distribution it comes from; "avatarsim" is ours
    per_call  whether every query is a call from Python of its own; otherwise all pairs of a frame are one call
    what      the function that is timed, in a sentence
    settings  value and reason of every setting that is not the library's default
    """

    name: str
    library: str
    per_call: bool
    what: str
    settings: Mapping[str, tuple[str, str]] = field(default_factory=dict)


class Contender(Protocol):
    """One way to ask for the signed distance of all pairs of a frame."""

    identity: Identity

    def load(self, sequence: Sequence, mode: Mode) -> None:
        """Make every object that the sequence needs."""

    def load_call(self, spheres: Sequence, mode: Mode) -> None:
        """Make ready for the cheapest call that there is: pairs of spheres that are apart, in closed form."""

    def begin(self) -> None:
        """Forget what was learnt from earlier frames."""

    def pose(self, frame: int) -> None:
        """Put all shapes where they are in the frame; not timed."""

    def ask(self) -> None:
        """Query all pairs once; timed."""

    def answers(self) -> Array:
        """Signed distances (n,) [m] found by the last `ask`; inf where a pair got no answer."""

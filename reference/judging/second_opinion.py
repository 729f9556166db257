"""A second opinion on the judge: python-fcl's distance on the same pairs, and brute force where the two disagree.

The rate of disagreement is itself a result; with the decided depth beside it, it says which of the two was wrong.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.spatial import rotation
from reference.judging.in_fcl import fcl_distance, fcl_geometry
from reference.judging.judge import Judge

Array = NDArray[np.float64]

SAME = 1e-6
"""Metres up to which two answers count as the same: the bound on residual overlap, so that a disagreement is one that
could turn a verdict. fcl leaves up to 0.4 mm between separated rounded shapes; a smaller figure counts more of that."""


@dataclass(frozen=True)
class Disagreement:
    """One pair on which judge and fcl differ: names, both signed distances [m] and the one of brute force."""

    pair: tuple[str, str]
    judged: float
    fcl: float
    decided: float

    @property
    def judge_was_right(self) -> bool:
        """Whether brute force sides with the judge."""
        return abs(self.judged - self.decided) <= abs(self.fcl - self.decided)


@dataclass(frozen=True)
class Opinion:
    """What fcl thought of `asked` pairs of pieces, and where it differed from the judge."""

    asked: int
    disagreements: tuple[Disagreement, ...]

    @property
    def rate(self) -> float:
        """Share of pairs, 0 to 1, on which the two differ; 0 when none were asked."""
        return len(self.disagreements) / self.asked if self.asked else 0.0

    @property
    def judge_wrong(self) -> int:
        """Number of pairs on which brute force sides with fcl."""
        return sum(not found.judge_was_right for found in self.disagreements)

    @property
    def overlapping(self) -> int:
        """Number of the disagreements whose pair really overlaps: the ones that matter for a verdict."""
        return sum(found.decided < 0.0 for found in self.disagreements)

    def __str__(self) -> str:
        """One sentence for a report."""
        return (
            f"python-fcl differs from the judge by more than {SAME:g} m on {len(self.disagreements)} of {self.asked} "
            f"pairs ({100 * self.rate:.3g} %), of which {self.overlapping} overlap; brute force sides with python-fcl on "
            f"{self.judge_wrong} of them"
        )


def second_opinion(judge: Judge, states: Iterable[tuple[Array, Array]], reach: float = 0.0) -> Opinion:
    """fcl's opinion on every near pair of every state (positions (n, 3), orientations (n, 4)) of the judge's scene.

    `reach` [m] as in `Judge.overlaps`. States with poses that are no poses are passed over: they have no distances.
    """
    pieces, names = judge.pieces, judge.scene.names
    geometries = [fcl_geometry(shape) for shape in pieces.shapes]
    asked, found = 0, []
    for positions, orientations in states:
        if judge.faults(positions, orientations):
            continue
        first, second, judged = judge.distances(positions, orientations, reach)
        at, turns = pieces.placed(np.asarray(positions), rotation.to_matrix(rotation.normalised(orientations)))
        for a, b, claim in zip(first.tolist(), second.tolist(), judged.tolist(), strict=True):
            asked += 1
            other = fcl_distance(geometries[a], turns[a], at[a], geometries[b], turns[b], at[b])
            # fcl may answer nan: that is a disagreement too
            if not abs(other - claim) <= SAME:
                decided = judge.between.by_brute_force(a, turns[a], b, turns[b], at[a] - at[b])
                pair = (names[pieces.owner[a]], names[pieces.owner[b]])
                found.append(Disagreement(pair, claim, other, decided))
    return Opinion(asked, tuple(found))


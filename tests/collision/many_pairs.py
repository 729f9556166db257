"""Judge many pairs of a stratum, and what to say about them."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

from avatarsim.collision.status import CONVERGED, NAMES
from tests.collision.judged import Verdict, judge
from tests.collision.strata import BATCH, draw


@dataclass
class Tally:
    """Counts and worst figures (relative to size) of the pairs of one stratum."""

    pairs: int = 0
    error: float = 0.0
    witness: float = 0.0
    swapped: float = 0.0
    wrong_signs: int = 0
    statuses: Counter[str] = field(default_factory=Counter)
    oracles: Counter[str] = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)

    def add(self, verdict: Verdict) -> None:
        """Count one pair."""
        self.pairs += 1
        self.error = max(self.error, verdict.error)
        self.witness = max(self.witness, verdict.witness)
        self.swapped = max(self.swapped, verdict.swapped)
        self.wrong_signs += verdict.wrong_sign
        self.oracles[verdict.oracle] += 1
        if verdict.status != CONVERGED:
            self.statuses[NAMES[verdict.status]] += 1
        if verdict.failures:
            self.failures.append(f"{verdict.label}: {', '.join(verdict.failures)}")

    def join(self, other: "Tally") -> None:
        """Add what another process found."""
        self.pairs += other.pairs
        self.error, self.witness = max(self.error, other.error), max(self.witness, other.witness)
        self.swapped = max(self.swapped, other.swapped)
        self.wrong_signs += other.wrong_signs
        self.statuses += other.statuses
        self.oracles += other.oracles
        self.failures += other.failures


def tally(stratum: str, seed: int, numbers: Iterable[int], pairs: int, every: int = 1) -> Tally:
    """Judge the first `pairs` pairs of some batches; every `every`-th polytope pair that overlaps by qhull as well."""
    found = Tally()
    for number in numbers:
        batch = draw(stratum, seed, number)
        for k in range(min(BATCH, pairs - found.pairs)):
            found.add(judge(batch, k, by_qhull=(number * BATCH + k) % every == 0))
    return found

"""Seeds that change with every commit: settings tuned on the motions of one commit are measured on those of the next."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from scenarios.run.provenance import ROOT, commit_of, hash_of_sources

DIGITS = 7
"""Hexadecimal digits of the hash that make the seed: as many as git shows of a commit, and well within 32 bits."""
OWN = 0
"""The seed of the command line that means the one drawn here."""


@dataclass(frozen=True)
class Drawn:
    """A seed, and its source: "commit" or, where there is no repository, "code", with its hash."""

    seed: int
    kind: str
    digits: str

    @property
    def text(self) -> str:
        """Seed and source as text."""
        return f"seed {self.seed} of the unseen motions: the first {DIGITS} digits of {self.kind} {self.digits}"


def draw_from(root: Path) -> Drawn:
    """Return the seed for the sources at `root`."""
    commit = commit_of(root)
    kind, digits = ("commit", commit) if commit else ("code", hash_of_sources(root))
    # never the seed that means this one
    return Drawn(int(digits[:DIGITS], 16) or 1, kind, digits)


@cache
def draw() -> Drawn:
    """Return the seed for this project as it was at the first call."""
    return draw_from(ROOT)

"""Restitution and friction asked for against obtained, from what `scenarios.law_map` left in the run."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from reports.files import lines, number
from reports.wording import figures, listed

ROWS = "law_map.csv"
OURS = "avatarsim/default"
PROMISED = 1e-6
"""Largest difference between asked and obtained that ours may show."""


@dataclass(frozen=True)
class Cell:
    """What became of a coefficient that was asked of one engine with one shape and step: median, lowest, highest."""

    law: str
    shape: str
    run: str
    rate: int
    asked: float
    got: float
    low: float
    high: float
    note: str

    @property
    def worst(self) -> float:
        """Largest difference of any body; nan where a body gave no figure."""
        # max() would pass over a nan that comes second
        lost = bool(self.note) or math.isnan(self.low + self.high)
        return math.nan if lost else max(abs(self.low - self.asked), abs(self.high - self.asked))


@dataclass(frozen=True)
class LawMap:
    """All cells of a run."""

    cells: tuple[Cell, ...]

    @cached_property
    def laws(self) -> tuple[str, ...]:
        """In the order of the file, as are the other axes."""
        return tuple(dict.fromkeys(cell.law for cell in self.cells))

    @cached_property
    def shapes(self) -> tuple[str, ...]:
        """Shapes."""
        return tuple(dict.fromkeys(cell.shape for cell in self.cells))

    @cached_property
    def runs(self) -> tuple[str, ...]:
        """Engines and presets."""
        return tuple(dict.fromkeys(cell.run for cell in self.cells))

    def asked(self, law: str) -> tuple[float, ...]:
        """The coefficients that were asked, rising."""
        return tuple(sorted({cell.asked for cell in self.cells if cell.law == law}))

    def row(self, law: str, shape: str, run: str, rate: int) -> tuple[Cell, ...]:
        """All coefficients of one engine, shape and step, rising."""
        found = (c for c in self.cells if (c.law, c.shape, c.run, c.rate) == (law, shape, run, rate))
        return tuple(sorted(found, key=lambda cell: cell.asked))

    def rows(self, law: str) -> tuple[tuple[str, str, int, tuple[Cell, ...]], ...]:
        """(shape, run, steps per second, cells) of one law, in the order of the file."""
        keys = dict.fromkeys((c.shape, c.run, c.rate) for c in self.cells if c.law == law)
        return tuple((shape, run, rate, self.row(law, shape, run, rate)) for shape, run, rate in keys)


def load(run_dir: Path) -> LawMap | None:
    """The file of a run; None when there is none. Raises InvalidFile for a file that is damaged."""
    found = lines(run_dir / ROWS, _cell)
    return LawMap(found) if found else None


def _cell(row: Mapping[str, str]) -> Cell:
    got, low, high = (number(row[name]) for name in ("got", "low", "high"))
    run = f"{row['engine']}/{row['preset']}"
    return Cell(row["law"], row["shape"], run, int(row["rate"]), float(row["asked"]), got, low, high, row["note"])


def conclusion(found: LawMap) -> str:
    """Where ours misses its promise, then how far the others are off at their best and worst step."""
    ours = [cell for cell in found.cells if cell.run == OURS]
    missed = [cell for cell in ours if not cell.worst <= PROMISED]
    parts = []
    if missed:
        names = tuple(f"{c.law} {c.asked:g} of {c.shape} at 1/{c.rate} s ({figures(c.got)})" for c in missed)
        parts.append(f"Ours misses what is asked by more than {PROMISED:g} in {listed(names)}.")
    elif ours:
        parts.append(f"Ours gives what is asked to {figures(max(c.worst for c in ours))} at every step and shape.")
    for law in found.laws:
        said = []
        for run in found.runs:
            worst = {rate: _worst(found, law, run, rate) for rate in sorted({c.rate for c in found.cells if c.run == run})}
            usable = {rate: value for rate, value in worst.items() if not math.isnan(value)}
            if run != OURS and usable:
                best = min(usable, key=lambda rate: usable[rate])
                most = figures(max(usable.values()))
                said.append(f"{run} by up to {most}, at its best step 1/{best} s {figures(usable[best])}")
        parts += [f"{law.capitalize()} is missed by {'; '.join(said)}."] if said else []
    lost = tuple(dict.fromkeys(f"{c.run} ({c.shape}, 1/{c.rate} s)" for c in found.cells if c.note))
    parts += [f"Bodies without a figure (never hit, or through the floor): {listed(lost)}."] if lost else []
    return " ".join(parts)


def _worst(found: LawMap, law: str, run: str, rate: int) -> float:
    """Over all shapes; bodies without a figure are told apart."""
    errors = [c.worst for c in found.cells if (c.law, c.run, c.rate) == (law, run, rate) and not c.note]
    return max(errors, default=math.nan)

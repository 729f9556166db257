"""One row per law, shape, engine, step and coefficient, as law_map.csv holds them, and what a terminal shows of it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """What was `asked` and what was obtained: median, lowest and highest over the bodies that were asked the same, phases of a
    step and directions; nan with the reason in `note`."""

    law: str
    shape: str
    engine: str
    preset: str
    rate: int
    asked: float
    got: float
    low: float
    high: float
    note: str

    @property
    def run(self) -> str:
        """Engine and preset as tables name them."""
        return f"{self.engine}/{self.preset}"

    @property
    def worst(self) -> float:
        """Largest difference from what was asked; nan if any body gave no figure."""
        return math.nan if self.note else max(abs(self.low - self.asked), abs(self.high - self.asked))


def summed_up(values: Sequence[float]) -> tuple[float, float, float, str]:
    """Median, lowest, highest of the numbers among `values`, and how many gave none."""
    usable = sorted(value for value in values if not math.isnan(value))
    lost = len(values) - len(usable)
    note = f"{lost} of {len(values)} bodies gave no figure" if lost else ""
    if not usable:
        return math.nan, math.nan, math.nan, note
    half = len(usable) // 2
    middle = usable[half] if len(usable) % 2 else 0.5 * (usable[half - 1] + usable[half])
    return middle, usable[0], usable[-1], note



def table(rows: Sequence[Row]) -> str:
    """A line per law, shape, engine and step, a column per coefficient: the median obtained, and the worst of all bodies."""
    lines = []
    for law in dict.fromkeys(row.law for row in rows):
        here = [row for row in rows if row.law == law]
        asked = sorted({row.asked for row in here})
        lines += ["", f"{law} obtained where ... was asked{''.join(f'{value:>8g}' for value in asked)}   worst"]
        for shape, run, rate in dict.fromkeys((row.shape, row.run, row.rate) for row in here):
            found = {row.asked: row for row in here if (row.shape, row.run, row.rate) == (shape, run, rate)}
            cells = "".join(_cell(found.get(value)) for value in asked)
            errors = [row.worst for row in found.values()]
            worst = math.nan if any(math.isnan(error) for error in errors) else max(errors, default=math.nan)
            lines.append(f"{shape:10} {run:18} 1/{rate:<5}{cells}   {worst:.1e}")
    return "\n".join(lines).lstrip("\n")


def _cell(row: Row | None) -> str:
    return f"{'-':>8}" if row is None or math.isnan(row.got) else f"{row.got:8.3f}"

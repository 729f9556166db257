"""Restitution and friction asked for against obtained, from what `scenarios.law_map` left in the run.

The map of the contact law as pictures: a panel per law and shape, a cell per engine, step and coefficient.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import altair as alt

from reports.drawing.charts import Panel
from reports.drawing.marks import FONT
from reports.drawing.palette import ALARM, MUTED, TEXT
from reports.drawing.picture import picture
from reports.words.wording import MISSING, figures, listed
from runfiles.csv_rows import lines, number

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


ROW, WIDTH = 13, 330
"""Height of a row and width of the plotting area [px]."""
SHADES = ((1e-6, 0.0), (0.01, 0.12), (0.03, 0.25), (0.1, 0.45), (math.inf, 0.7))
"""How strongly a cell is coloured by the largest difference from what was asked, up to the first number."""


def shade(cell: Cell) -> float:
    """Opacity of a cell; the strongest where a body gave no figure."""
    return SHADES[-1][1] if math.isnan(cell.worst) else next(opacity for most, opacity in SHADES if cell.worst <= most)


def panels(found: LawMap) -> list[Panel]:
    """One panel per law and shape."""
    made: list[Panel] = []
    for law in found.laws:
        for shape in found.shapes:
            cells = [cell for cell in found.cells if (cell.law, cell.shape) == (law, shape)]
            if cells:
                said = _said(cells)
                text = f"{law} of {shape}: what was obtained for what was asked, by engine and step. {said}"
                title = f"{law}, {shape.replace('_', ' ')}"
                made.append(Panel(title, picture(_spec(cells), text, f"l{len(made)}"), said))
    return made


def _said(cells: list[Cell]) -> str:
    """Which engine is closest and which is farthest, over all steps."""
    worst: dict[str, float] = {}
    for cell in cells:
        before = worst.get(cell.run, 0.0)
        # a body without a figure spoils its engine
        worst[cell.run] = math.nan if math.isnan(cell.worst) or math.isnan(before) else max(before, cell.worst)
    ranked = sorted(worst, key=lambda run: (math.isnan(worst[run]), worst[run]))
    ends = tuple(dict.fromkeys((ranked[0], ranked[-1])))
    told = [f"{run} {'lost bodies' if math.isnan(worst[run]) else figures(worst[run])}" for run in ends]
    return f"Largest difference: {' to '.join(told)}."


def _spec(cells: list[Cell]) -> dict[str, object]:
    names = list(dict.fromkeys(_name(cell) for cell in cells))
    asked = [f"{value:g}" for value in sorted({cell.asked for cell in cells})]
    data = [
        {"row": _name(c), "asked": f"{c.asked:g}", "shade": shade(c), "got": MISSING if math.isnan(c.got) else _short(c.got)}
        for c in cells
    ]
    x = alt.X("asked:N", title=None, sort=asked, axis=alt.Axis(orient="top", labelAngle=0))
    y = alt.Y("row:N", title=None, sort=names, axis=alt.Axis(labelLimit=150))
    base = alt.Chart({"values": data})
    layers = [
        base.mark_rect(color=ALARM[0]).encode(x=x, y=y, opacity=alt.Opacity("shade:Q", scale=None, legend=None)),
        base.mark_text(color=TEXT[0], fontSize=9).encode(x=x, y=y, text="got:N"),
    ]
    chart = alt.layer(*layers).properties(width=WIDTH - 110, height=ROW * len(names), background="transparent").configure(
        font=FONT, padding={"left": 4, "top": 2, "right": 4, "bottom": 2}, view=alt.ViewConfig(stroke=None),
    ).configure_axis(labelColor=MUTED[0], domain=False, ticks=False, labelFontSize=9, grid=False)
    return dict(chart.to_dict())


def _name(cell: Cell) -> str:
    return f"{cell.run} 1/{cell.rate}"


def _short(value: float) -> str:
    """Two decimals; three where the coefficient is less than a tenth."""
    return f"{abs(value):.2f}" if abs(value) < 0.005 else f"{value:.2f}" if abs(value) >= 0.1 else f"{value:.3f}"


def cell_text(cell: Cell) -> str:
    """Median, and the range over bodies where they differ by more than a thousandth."""
    if math.isnan(cell.got):
        return MISSING
    spread = "" if cell.high - cell.low <= 1e-3 else f" ({cell.low:.3f} to {cell.high:.3f})"
    return f"{cell.got:.4f}{spread}"


def section(found: LawMap) -> dict[str, object]:
    """What the section is made of."""
    return {"law_conclusion": conclusion(found), "law_panels": panels(found), "law_cell": cell_text, "law_shade": shade}

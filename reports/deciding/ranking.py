"""The ranking matrix: scenes by engines, in each cell overlap, error to the ground truth and frame time, and which is best."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from reports.deciding.columns import COLUMNS, Column
from reports.deciding.losses import best_in
from reports.deciding.tables import Block, Cell
from reports.words.wording import families as families_of
from reports.words.wording import limit, listed, ratio
from runfiles.behind import BEST, Compared

SHOWN = ("overlap", "truth", "p95")
"""Keys of the table's columns that the matrix ranks."""
NAMES = {"overlap": "overlap", "truth": "error", "p95": "p95"}
"""What each is called at the side of the matrix."""
COUNTED = {"overlap": "residual_overlap_max", "p95": "frame_time_p95"}
"""Those that are one metric in all scenes."""


@dataclass(frozen=True)
class Row:
    """One measure of one scene: its column, the metric behind it, and a cell per run of the matrix, None where a run has none."""

    column: Column
    name: str
    metric: str
    cells: tuple[Cell | None, ...]


@dataclass(frozen=True)
class Rank:
    """One scene of the matrix with the measures that any engine has there; `trouble` by run, "" where there is none."""

    scene: str
    title: str
    rows: tuple[Row, ...]
    trouble: tuple[str, ...]


def runs_of(shown: Sequence[Block]) -> tuple[str, ...]:
    """All engines and presets in the order of the table, the raw tracker left out: it can win nothing."""
    return tuple(dict.fromkeys(line.run for block in shown for line in block.lines if not line.tracker))


def ranks(shown: Sequence[Block]) -> tuple[Rank, ...]:
    """The matrix, in the table's order of scenes."""
    runs = runs_of(shown)
    return tuple(_rank(block, runs) for block in shown)


def _rank(block: Block, runs: Sequence[str]) -> Rank:
    lines = {line.run: line for line in block.lines}
    rows = []
    for index, column in enumerate(COLUMNS):
        if column.key in SHOWN:
            cells = tuple(lines[run].cells[index] if run in lines else None for run in runs)
            metric = next((cell.row.metric for cell in cells if cell and cell.row), "")
            if any(cell and (cell.value is not None or cell.word) for cell in cells):
                rows.append(Row(column, NAMES[column.key], metric, cells))
    return Rank(block.scene, block.title, tuple(rows), tuple(lines[run].trouble if run in lines else "" for run in runs))


def tolerances() -> str:
    """What best means, and what counts as equal in each measure of the matrix."""
    said = []
    for column in COLUMNS:
        if column.key in SHOWN:
            equal = limit(column.same, column.unit) if column.same else f"{column.share:.0%}" if column.share else "none"
            said.append(f"{column.title}: {equal}")
    return f"{BEST} Equal within: {'; '.join(said)}."


def sentence(found: Sequence[Rank], ours: str, runs: Sequence[str], counted: Compared,
             family_of: Mapping[str, str] = MappingProxyType({})) -> str:
    """What to conclude: in how many families of scenes ours is best in every scene, for each measure, and where it is not, the
    largest factor first; overlap and time as the losses count them (`counted`)."""
    if ours not in runs or len(runs) < 2:
        return "There is nothing to be ranked against in this run."
    place, said = runs.index(ours), []
    for key in SHOWN:
        metric = COUNTED.get(key)
        text = best_in(counted, family_of, metric) if metric else _errors(found, place, family_of)
        said += [f"{NAMES[key]} in {text}"] if text else []
    return f"{ours} is best or level: {'; '.join(said)}." if said else "Nothing here can be ranked."


def _errors(found: Sequence[Rank], place: int, family_of: Mapping[str, str]) -> str:
    """The same of the errors to the closed form, of which each scene has its own; "" without any."""
    rows = [(rank.scene, cell) for rank in found for row in rank.rows
            if row.column.key == "truth" and (cell := row.cells[place]) and cell.ratio is not None]
    behind = sorted(((scene, cell.ratio or 0.0) for scene, cell in rows if not cell.best), key=lambda one: -one[1])
    names = {family_of.get(scene, scene) for scene, _ in rows}
    lost = {family_of.get(scene, scene) for scene, _ in behind}
    where = f", behind in {listed(tuple(f'{scene} ({ratio(times)})' for scene, times in behind))}" if behind else ""
    return f"{len(names - lost)} of {families_of(len(names))}{where}" if rows else ""

"""The committed baseline: accuracy of the gated engine in one small file that later runs are compared with."""

from pathlib import Path

import pandas as pd

from avatarsim.errors import InvalidFile
from reports.tables.changes import figures
from reports.tables.run import Run
from runfiles.metrics import METRICS

COLUMNS = ["scenario", "run", "metric", "unit", "value"]


def text(run: Run) -> str:
    """Return the file of a run: watched metrics of the gated engine to three digits; more are the machine's."""
    table = figures(run)
    watched = table[(table.run == run.gated) & table.metric.map(lambda name: METRICS[name].watched)]
    watched = watched[watched.value < float("inf")].sort_values(["scenario", "metric"])
    rounded = watched.assign(value=[f"{value:.3g}" for value in watched.value])
    return str(rounded[COLUMNS].to_csv(index=False, lineterminator="\n"))


def load(path: Path) -> pd.DataFrame:
    """Read the file. Raises InvalidFile where it is missing, damaged or empty."""
    valid = "a file that `python -m reports baseline` wrote"
    try:
        table = pd.read_csv(path, dtype={"unit": str}, keep_default_na=False)
        table = table[COLUMNS].assign(value=pd.to_numeric(table.value))
    except (OSError, ValueError, KeyError, pd.errors.ParserError) as error:
        raise InvalidFile(str(path), f"{type(error).__name__}: {error}", valid) from error
    if table.empty or not table.value.map(lambda value: value - value == 0.0).all():
        raise InvalidFile(str(path), "no row, or a value that is no number", valid)
    return table

"""Contact law: coefficients of restitution and friction that bodies show, against the stated ones."""

from pathlib import Path

import pandas as pd

from avatarsim.errors import InvalidFile
from runfiles.table import read_study

STUDY = "contact_law"


def contact_law(folder: Path) -> pd.DataFrame | None:
    """Read the coefficients that a run obtained; None where it measured none.

    Returns:
        A row per law, run and stated coefficient: columns law, run, stated, and low, middle and high of all shapes and steps.

    Raises:
        InvalidFile: for a damaged file.
    """
    table = read_study(folder, STUDY)
    if table is None:
        return None
    rows = table[table.metric.str.startswith("obtained_") & table.value.notna()]
    parts = rows.metric.str.extract(r"^obtained_(?P<stated>[0-9.e-]+)_?(?P<end>low|high)?$")
    try:
        rows = rows.assign(stated=parts.stated.astype(float), end=parts.end.fillna("middle"))
    except ValueError as error:
        raise InvalidFile(f"metric in {folder / f'{STUDY}.csv'}", str(error), "obtained_<coefficient>") from error
    rows = rows.assign(law=rows.scenario.str.partition("_")[0])
    spreads = rows.groupby(["law", "run", "stated"], sort=False).apply(_spread, include_groups=False)
    return spreads.reset_index() if len(spreads) else None


def _spread(rows: pd.DataFrame) -> pd.Series:
    middle = rows.value[rows.end == "middle"].median()
    return pd.Series({"low": rows.value.min(), "middle": middle, "high": rows.value.max()})

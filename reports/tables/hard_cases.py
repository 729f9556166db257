"""Hard cases under small changes of their starts, steps, sizes and places: does an engine keep its region?"""

import math
from pathlib import Path

import pandas as pd

from avatarsim.errors import InvalidFile

FILE = "stability.csv"

NUMBERS = ("overlap", "energy", "bad", "moved")
"""Columns of numbers."""


def trials(folder: Path) -> pd.DataFrame | None:
    """Read the trials of a run; None where none were made. Raises InvalidFile for a damaged file."""
    path = folder / FILE
    if not path.exists():
        return None
    try:
        table = pd.read_csv(path)
        table = table.astype(dict.fromkeys(("case", "run", "kind", "state"), str)).astype(dict.fromkeys(NUMBERS, float))
    except (ValueError, KeyError, OverflowError, pd.errors.ParserError) as error:
        raise InvalidFile(str(path), f"{type(error).__name__}: {error}", "the file of one command") from error
    return table if len(table) else None


def by_case(table: pd.DataFrame) -> pd.DataFrame:
    """Summarise trials by case and run.

    Returns:
        Columns case, run, trials, not_finite, left: trials with a value that is no number, and trials that left their region;
        drift [m]: largest distance of the end from that of the unchanged trial, NaN where that one left its region;
        overlap [m] and energy [J]: largest; unsupported: trials that the engine cannot express.
    """
    found = []
    for (case, run), part in table.groupby(["case", "run"], sort=False):
        tried = part[part.state.isin(("survived", "lost"))]
        plain, lost = tried[tried.kind == "plain"], tried[tried.state == "lost"]
        broken = lost[lost.bad > 0]
        inside = tried[tried.state == "survived"]
        anchored = len(plain) > 0 and bool((plain.state == "survived").all())
        found.append(
            {
                "case": case,
                "run": run,
                "trials": len(tried),
                "not_finite": len(broken),
                "left": len(lost) - len(broken),
                "drift": float(inside.moved.max()) if anchored and len(inside) else math.nan,
                "overlap": float(inside.overlap.max()) if len(inside) else math.nan,
                "energy": float(inside.energy.max()) if len(inside) else math.nan,
                "unsupported": len(part) - len(tried),
            }
        )
    return pd.DataFrame(found)

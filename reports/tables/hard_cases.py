"""Hard cases under small changes of their starts, steps, sizes and places: does an engine keep its region?"""

import math
from pathlib import Path

import pandas as pd

from runfiles.table import read_study, wide

STUDY = "hard_cases"
METRICS = ("residual_overlap_max", "energy_added_max", "not_finite_frames", "wrong_side_frames", "end_distance")


def by_case(folder: Path) -> pd.DataFrame | None:
    """Read the trials of a run by case and run; None where none were made.

    Returns:
        Columns case, run, trials, not_finite, left: trials with a value that is no number, and trials that left their region;
        drift [m]: largest distance of the end from that of the unchanged trial, NaN where that one left its region;
        overlap [m] and energy [J]: largest.

    Raises:
        InvalidFile: for a damaged file.
    """
    table = read_study(folder, STUDY)
    if table is None:
        return None
    records = []
    for (case, run), part in wide(table).groupby(["scenario", "run"], sort=False):
        part = part.reindex(columns=[*part.columns, *(name for name in METRICS if name not in part)])
        broken = part.not_finite_frames > 0.0
        inside = part[(part.wrong_side_frames == 0.0) & (part.not_finite_frames == 0.0)]
        records.append({
            "case": case, "run": run, "trials": int(part.not_finite_frames.notna().sum()), "not_finite": int(broken.sum()),
            "left": int((part.wrong_side_frames > 0.0).sum()),
            "drift": _largest(inside.end_distance) if (inside.change == "").any() else math.nan,
            "overlap": _largest(inside.residual_overlap_max), "energy": _largest(inside.energy_added_max),
        })
    return pd.DataFrame(records)


def _largest(values: pd.Series) -> float:
    return float(values.max()) if len(values) else math.nan

"""Effects of scenes: which are simulated, what they cost, and what breaks without them."""

from pathlib import Path

import pandas as pd

from runfiles.table import read_study

STUDY = "effects"
WITHOUT = "without "


def effects(folder: Path) -> pd.DataFrame | None:
    """Read what each effect of a scene costs; None where nothing was tried.

    Returns:
        Columns scenario, effect, share (of the frame time, negative where the effect saves time), with_us, without_us [us],
        broken: metrics whose bound holds with the effect only. Effects that a scene does not call for have no row.

    Raises:
        InvalidFile: for a damaged file.
    """
    table = read_study(folder, STUDY)
    if table is None:
        return None
    records = []
    for scenario, part in table.groupby("scenario", sort=False):
        plain = part[part.change == ""].drop_duplicates("metric").set_index("metric")
        for change, other in part[part.change.str.startswith(WITHOUT)].groupby("change", sort=False):
            without = other.drop_duplicates("metric").set_index("metric")
            times = [float(one.value.get("frame_time_p50", float("nan"))) for one in (plain, without)]
            if not times[0] > 0.0 or not times[1] >= 0.0:
                continue
            held = plain[plain.value <= plain.bound]
            broken = [name for name in held.index if not without.value.get(name, float("nan")) <= held.bound[name]]
            records.append({
                "scenario": scenario, "effect": str(change).removeprefix(WITHOUT), "share": (times[0] - times[1]) / times[0],
                "with_us": times[0], "without_us": times[1], "broken": broken,
            })
    return pd.DataFrame(records) if records else None

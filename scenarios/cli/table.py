"""Table on the terminal: a line per run, a column per figure, and the checks that do not pass."""

from collections.abc import Sequence

import pandas as pd

from runfiles.table import Row, Status

COLUMNS = {
    "residual_overlap_max": "overlap mm", "overlap_frames": "frames %", "tracker_offset_rms_free": "offset mm",
    "still_frames": "still %", "chatter_frames": "chatter %", "joint_limit_excess_max": "limits deg",
    "restitution_error_max": "restitution", "frame_time_p50": "p50 us", "frame_time_p95": "p95 us",
}
"""Metric -> heading; lengths are shown in mm."""
WORST: tuple[Status, ...] = ("fail", "crashed", "not-measured", "cannot-say", "refused", "waived", "pass", "info")
"""All statuses; a run has the first that one of its rows has."""
NAMED = ("fail", "crashed", "not-measured", "cannot-say", "waived")
"""Statuses of rows that have a line of their own."""


def table(rows: Sequence[Row]) -> str:
    """Return a line per run, with its worst status and its number of broken bounds, and a line per check that does not pass."""
    if not rows:
        return "nothing was run"
    data = pd.DataFrame([{**vars(row), "run": row.run} for row in rows])
    data["broken"] = data.bound.notna() & ~(data.value.astype(float) <= data.bound.astype(float))
    data["shown"] = data.value.astype(float) * [1e3 if COLUMNS.get(name, "").endswith("mm") else 1.0 for name in data.metric]
    runs = data.groupby(["scenario", "seed", "run"], sort=False)
    lines = runs.status.agg(lambda states: min(states, key=WORST.index)).to_frame().assign(broken=runs.broken.sum())
    figures = data[data.metric.isin(COLUMNS)].set_index([*lines.index.names, "metric"]).shown.unstack("metric")
    figures = figures.reindex(index=lines.index, columns=list(COLUMNS)).rename(columns=COLUMNS)
    parts = [figures.join(lines).to_string(float_format="{:.3g}".format, na_rep="-")]
    for row in rows:
        if row.status in NAMED:
            value = "" if row.value is None else f" {row.value:.4g}"
            limit = "" if row.limit is None else f" (limit {row.limit:g})"
            metric = "" if row.metric == "run" else f" {row.metric}"
            note = f": {row.note}" if row.note else ""
            parts.append(f"{row.status}: {row.scenario} {row.run}{metric}{value}{limit}{note}")
    return "\n".join(parts)

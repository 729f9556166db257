"""Rows of one setting in one scene: its errors, its times, and their basis."""

from collections.abc import Sequence

from runfiles.comparable import silenced_metrics
from runfiles.table import Row
from scenarios.studies.checkpoint import Entry
from scenarios.studies.settings.cell import Cell
from scenarios.studies.settings.copyable import copyable
from scenarios.studies.study import Head

NAME = "settings"
SPOILS = ("wrong_side_frames", "not_finite_frames")
"""Metrics that must be 0, or a small error means nothing: something went through a wall, or became no number."""
ALSO = (*SPOILS, "contact_gap_p50")
"""Metrics in addition to the errors of a scene."""
TIMES = {
    "p50": "frame_time_p50", "p95": "frame_time_p95", "p99": "frame_time_p99", "slowest": "frame_time_max",
    "moving": "frame_time_moving_p50", "at_rest": "frame_time_resting_p50", "rests": "resting_frames",
}
"""Entry of a timed cell -> metric."""


def rows_of(cell: Cell, errors: Sequence[str], entry: Entry, clocked: Entry | None) -> list[Row]:
    """Return a row per error that applies, and per time; or one with the reason where nothing was measured."""
    setting, values = cell.setting, entry["values"]
    change = "" if setting.is_preset else setting.name
    head = Head(NAME, cell.scenario, setting.engine, setting.base, change, copyable(setting), cell.seed, entry.get("frames", 0))
    if entry["state"] != "measured":
        return [head.without(entry["state"], entry["note"])]
    silent, rows = silenced_metrics(f"{setting.engine}/{setting.base}", entry.get("unsupported", {})), list[Row]()
    for metric in dict.fromkeys((*errors, *ALSO)):
        if metric in silent:
            rows.append(head.row(metric, None, silent[metric], status="cannot-say"))
        elif metric in values:
            rows.append(head.row(metric, float(values[metric])))
        elif metric in entry["missing"]:
            rows.append(head.row(metric, None, entry["missing"][metric]))
    if entry.get("step") is not None:
        rows.append(head.row("time_step", entry["step"]))
    if clocked is None or clocked["p50"] is None:
        return [*rows, head.row("frame_time_p50", None, "not timed" if clocked is None else clocked["note"])]
    return rows + [
        head.row(metric, float(clocked[name]), clocked["note"]) for name, metric in TIMES.items() if clocked.get(name) is not None
    ]

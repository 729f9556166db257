"""Where another engine is better than the gated one, by metric."""

from collections.abc import Mapping
from typing import NamedTuple

import pandas as pd

from reports.tables.run import Run
from runfiles.metrics import RANKED, Metric

POWERS: Mapping[str, int] = {"m": 1, "m/s": 1, "J": 2}
"""Powers of the size of a scene's world that figures in a unit grow with; they are compared as in a world of size 1."""

COLUMNS = ("metric", "label", "unit", "scenes", "lost", "share", "each")


class Loss(NamedTuple):
    """A scene in which `run` of another engine is best, and figures of the gated engine and of that run."""

    scene: str
    own: float
    best: float
    run: str


def losses(run: Run) -> pd.DataFrame:
    """Compare the gated engine with the best of the others in every scene and ranked metric.

    Returns:
        Columns metric, label, unit, scenes (compared), lost, share, each: a `Loss` per lost scene, the widest first. Sorted by
        lost.
    """
    rows = run.rows[run.rows.metric.isin(RANKED) & (run.rows.why == "")]
    sizes = rows.scenario.map(run.results.scales).fillna(1.0) ** rows.unit.map(POWERS).fillna(0)
    rows = rows.assign(value=rows.value / sizes, size=sizes)
    wrong = run.rows[(run.rows.metric == "wrong_side_frames") & ~(run.rows.value <= 0.0)]
    left = set(zip(wrong.scenario, wrong.run, strict=True))
    parts = [_of_metric(part, RANKED[name], run, left) for name, part in rows.groupby("metric", sort=False)]
    table = pd.DataFrame([one for one in parts if one is not None], columns=COLUMNS)
    return table.sort_values(["lost", "share"], ascending=False, kind="stable").reset_index(drop=True)


def _of_metric(part: pd.DataFrame, metric: Metric, run: Run, left: set[tuple[str, str]]) -> dict[str, object] | None:
    """Losses in one metric; None where no scene compares two engines."""
    own = part[part.run == run.gated]
    if metric.optional:
        own = own[own.measured]
    others = part[part.run.isin(run.rivals) & part.value.notna()]
    if metric.inside:
        outside = [key in left for key in zip(others.scenario, others.run, strict=True)]
        others = others[~pd.Series(outside, index=others.index, dtype=bool)]
    # of several seeds the worst counts, of both
    ours = own.groupby("scenario").value.agg(lambda values: values.max(skipna=False))
    theirs = others.groupby(["scenario", "run"]).value.max().reset_index().sort_values("value").drop_duplicates("scenario")
    both = theirs.set_index("scenario").join(ours.rename("own"), how="inner")
    if both.empty:
        return None
    both["size"] = part.groupby("scenario")["size"].first()
    lost = both[[metric.better(best, mine) for best, mine in zip(both.value, both.own, strict=True)]]
    widest = lost.loc[(lost.own - lost.value).fillna(float("inf")).sort_values(ascending=False, kind="stable").index]
    each = [Loss(str(row.Index), row.own * row.size, row.value * row.size, row.run) for row in widest.itertuples()]
    return {
        "metric": metric.name, "label": metric.label, "unit": metric.unit, "scenes": len(both), "lost": len(lost),
        "share": len(lost) / len(both), "each": each,
    }
